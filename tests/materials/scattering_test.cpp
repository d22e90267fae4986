// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "media/distance.h"
#include "media/phase.h"
#include "support/chi_square.h"
#include "support/lane_helpers.h"

// Tests of distance and direction sampling in participating media.
namespace fathom {
namespace {

using test::first;

TEST(Phase, SamplesHenyeyAndGreenstein)
{
    for (float g : {-0.99f, -0.6f, -0.01f, 0.0f, 1e-4f, 0.3f, 0.9f, 0.99f}) {
        const auto density = [&](test::Direction d) {
            const double x = double(g), root = 1 + x * x - 2 * x * d.z;
            return (1 - x * x) / (4 * std::numbers::pi * root * std::sqrt(root));
        };
        test::Random random;
        std::vector<test::Direction> directions;
        double sum = 0, squares = 0;
        while (directions.size() < 200000) {
            const Vec3 w = sample_phase(Float(g), random.next2());
            float x[3][lanes];
            store(x[0], w.x), store(x[1], w.y), store(x[2], w.z);
            for (int i = 0; i < lanes; ++i) {
                directions.push_back({x[0][i], x[1][i], x[2][i]});
                EXPECT_NEAR(std::hypot(x[0][i], x[1][i], x[2][i]), 1, 1e-5);
                sum += double(x[2][i]), squares += double(x[2][i]) * double(x[2][i]);
            }
        }
        const double n = double(directions.size()), mean = sum / n;
        EXPECT_NEAR(mean, double(g), 4 * std::sqrt((squares / n - mean * mean) / n) + 1e-6) << g;
        EXPECT_EQ(test::chi_square_directions(directions, density), "") << g;
    }
}

/// Each channel gets its Beer-Lambert transmittance and its scattered remainder, whichever channel is sampled.
TEST(DistanceSample, EveryChannelFollowsItsOwnLaw)
{
    const float sigma_t[] = {0.02f, 1, 40}, sigma_s[] = {0.01f, 0.9f, 39};
    for (const Rgb& throughput : {Rgb{1, 1, 1}, Rgb{0.01f, 0.5f, 3}, Rgb{0, 2, 1}, Rgb{1, 0, 0}})
        for (float way : {0.05f, 1.0f, 5.0f}) {
            test::Random random;
            double sum[2][3] = {}, squares[2][3] = {};
            const int n = 400000;
            int count = 0;
            for (; count < n; count += lanes) {
                const Sample2 u = random.next2();
                const DistanceSample sample(Spectrum(sigma_t), Spectrum(throughput), u.x, u.y);
                const Mask turns = sample.distance() < Float(way);
                const Spectrum weights[] = {select(turns, Spectrum(Float(0)), sample.passed(Float(way))),
                                            select(turns, sample.scattered(Spectrum(sigma_s)), Spectrum(Float(0)))};
                for (int k = 0; k < 2; ++k)
                    for (int c = 0; c < channels; ++c) {
                        float w[lanes];
                        store(w, weights[k].c[c]);
                        for (float x : w) sum[k][c] += double(x), squares[k][c] += double(x) * double(x);
                    }
            }
            for (int c = 0; c < channels; ++c) {
                if (throughput[std::size_t(c)] == 0) continue;
                const double left = std::exp(-double(sigma_t[c]) * double(way));
                const double expected[] = {left, double(sigma_s[c]) / double(sigma_t[c]) * (1 - left)};
                for (int k = 0; k < 2; ++k) {
                    const double mean = sum[k][c] / count;
                    const double error = std::sqrt((squares[k][c] / count - mean * mean) / count);
                    EXPECT_NEAR(mean, expected[k], 4.5 * error + 1e-6) << k << " " << c << " " << way;
                }
            }
        }
}

/// In a channel without extinction all light passes unscattered, and scattering has none of it.
TEST(DistanceSample, ClearChannels)
{
    const float sigma_t[] = {0, 1, 0};
    const DistanceSample clear(Spectrum(sigma_t), Spectrum(Float(1)), Float(0), Float(0.1f));
    EXPECT_TRUE(std::isinf(first(clear.distance())));
    EXPECT_NEAR(first(clear.passed(Float(std::numeric_limits<float>::infinity())).c[0]), 1.5, 1e-6);
    EXPECT_EQ(first(clear.passed(Float(std::numeric_limits<float>::infinity())).c[1]), 0);
    // The last channel with a nonzero throughput is picked even if rounding exceeds the sum.
    const DistanceSample last(Spectrum(sigma_t), Spectrum(Rgb{1, 1, 0}), Float(0.5f), Float(1));
    EXPECT_NEAR(first(last.distance()), std::log(2.0), 1e-6);
}

}  // namespace
}  // namespace fathom
