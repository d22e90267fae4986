// SPDX-License-Identifier: Apache-2.0
#include "lights/tree/selector.h"

#include <gtest/gtest.h>

#include "support/lane_helpers.h"

namespace fathom {
namespace {

LightTables lights(const std::vector<double>& powers)
{
    LightTables tables;
    double sum = 0, running = 0;
    for (double p : powers) sum += p;
    tables.light_cdf.push_back(0);
    for (double p : powers) {
        running += p;
        tables.light_cdf.push_back(float(running / sum));
        LightRecord& light = tables.lights.emplace_back();
        light.pmf = tables.light_cdf.end()[-1] - tables.light_cdf.end()[-2];
    }
    return tables;
}

const Vec3 origin(Vec3f{0, 0, 0});

/// Selection frequencies equal the probabilities, tested with stratified numbers that leave no randomness.
TEST(LightSelector, FrequencyMatchesProbability)
{
    for (const std::vector<double>& powers : {std::vector<double>{1},
                                              {1, 3},
                                              {5, 0.01, 2, 7, 7},
                                              std::vector<double>(37, 1.0),
                                              {1e-3, 1, 1e-3, 1e-3, 40}}) {
        const LightTables tables = lights(powers);
        for (const LightSelection how : {LightSelection::power, LightSelection::uniform}) {
            const LightSelector selector(tables, how);
            constexpr int n = 1 << 16;
            std::vector<double> count(powers.size());
            for (int i = 0; i < n; ++i) {
                const std::uint32_t light =
                    test::first(selector.select(origin, Float((float(i) + 0.5f) / n), Float(0), Mask(true)).light);
                ASSERT_LT(light, powers.size());
                count[light] += 1.0 / n;
            }
            double sum = 0;
            for (std::uint32_t i = 0; i < powers.size(); ++i) {
                const double expected =
                    how == LightSelection::uniform ? 1.0 / double(powers.size()) : double(tables.lights[i].pmf);
                EXPECT_NEAR(count[i], expected, 1.5 / n);
                EXPECT_FLOAT_EQ(selector.pmf(i), float(expected));
                const LightReader<false> record(tables.lights.data(), UInt(i));
                EXPECT_EQ(test::first(selector.pmf(record, origin, Mask(true))), selector.pmf(i));
                sum += double(selector.pmf(i));
            }
            EXPECT_NEAR(sum, 1, 1e-6);
        }
    }
}

TEST(LightSelector, TheLargestNumberSelectsALight)
{
    const LightTables tables = lights({2, 1, 1});
    for (const LightSelection how : {LightSelection::power, LightSelection::uniform})
        EXPECT_EQ(
            test::first(LightSelector(tables, how).select(origin, Float(1 - 0x1p-24f), Float(0), Mask(true)).light),
            2u);
}

}  // namespace
}  // namespace fathom
