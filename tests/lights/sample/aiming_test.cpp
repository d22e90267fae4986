// SPDX-License-Identifier: Apache-2.0
#include "lights/sample/aiming.h"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "support/chi_square.h"
#include "support/lane_helpers.h"

namespace fathom::test {
namespace {

/// Two lights of which the second is weaker but preferred for the second target.
LightTables two_lights()
{
    LightTables tables;
    tables.lights.resize(2);
    tables.lights[0].pmf = 0.75f, tables.lights[1].pmf = 0.25f;
    tables.light_cdf = {0, 0.75f, 1};
    return tables;
}
LightTargets two_targets()
{
    LightTargets targets;
    targets.targets = {{{2, 0, 1}, 0.9f, 0.35f}, {{-0.5f, 1.5f, 0.5f}, 1.2f, 0.25f}};
    targets.own_share = 0.4f;
    targets.light_cdf = {0, 0.75f, 1, 0, 0.5f, 1, 0, 0.125f, 1};
    targets.light_ratios = {0.5f / 0.75f, 0.5f / 0.25f, 0.125f / 0.75f, 0.875f / 0.25f};
    return targets;
}

/// Calls f(light, target, random numbers) for each lane of many choices.
template <class F>
void draw_choices(const LightAiming& aiming, int n, const F& f)
{
    Random random(3);
    for (int k = 0; k < n; k += lanes) {
        const LightAiming::Choice choice = aiming.choose(random.next());
        f(choice, random.next2());
    }
}

/// Directions from a point, of each light, follow the density relative to uniform directions: from outside of the
/// targets, from within one, and close to its surface.
TEST(LightAiming, DirectionsFollowTheDensity)
{
    const LightTables tables = two_lights();
    const LightTargets targets = two_targets();
    const LightAiming aiming(tables, &targets);
    constexpr double own_pdf = 0.25 / std::numbers::pi;
    for (const Vec3f& from : {Vec3f{0, 0, -1}, Vec3f{-0.3f, 1.2f, 0.4f}, Vec3f{1.05f, 0, 1}}) {
        const Vec3 p(from);
        std::vector<Direction> drawn[2];
        constexpr int n = 200'000;
        draw_choices(aiming, n, [&](const LightAiming::Choice& choice, Sample2 random) {
            const LightAiming::Sphere target = aiming.target(choice.target, Mask(true));
            const Vec3 d = select(target.valid, LightAiming::direction_to(target, p, random), sample_sphere(random));
            float x[3][lanes];
            std::uint32_t light[lanes];
            store(x[0], d.x), store(x[1], d.y), store(x[2], d.z), store(light, choice.light);
            for (int i = 0; i < lanes; ++i) drawn[light[i]].push_back({x[0][i], x[1][i], x[2][i]});
        });
        for (std::uint32_t light = 0; light < 2; ++light) {
            const double pmf = double(tables.lights[light].pmf);
            const std::vector<double> cells = integrate_cells([&](Direction d) {
                const Vec3 wi(Vec3f{float(d.x), float(d.y), float(d.z)});
                return pmf * own_pdf * double(first(aiming.ratio_from(UInt(light), p, wi, Float(float(own_pdf)))));
            });
            EXPECT_NEAR(std::accumulate(cells.begin(), cells.end(), 0.0), double(drawn[light].size()) / n, 5e-3);
            EXPECT_EQ(chi_square_of_cells(drawn[light], cells), "") << light << " " << from.x;
        }
    }
}

/// Lines from infinity follow the density relative to a disk that covers the scene.
TEST(LightAiming, LinesFollowTheDensity)
{
    const LightTables tables = two_lights();
    const LightTargets targets = two_targets();
    const LightAiming aiming(tables, &targets);
    constexpr float disk = 4;
    constexpr int cells = 40, fine = 20, n = 400'000;
    const Vec3 d(Vec3f{0, 0, -1});
    std::vector<double> observed[2] = {std::vector<double>(cells * cells), std::vector<double>(cells * cells)};
    draw_choices(aiming, n, [&](const LightAiming::Choice& choice, Sample2 random) {
        const LightAiming::Sphere target = aiming.target(choice.target, Mask(true));
        const DiskPoint at = sample_disk(random);
        const Float radius = select(target.valid, target.radius, Float(disk));
        const Vec3 center = select(target.valid, target.center, Vec3(Vec3f{0, 0, 0}));
        float x[lanes], y[lanes];
        std::uint32_t light[lanes];
        store(x, fma(at.x, radius, center.x)), store(y, fma(at.y, radius, center.y)), store(light, choice.light);
        const auto cell = [&](float v) { return std::size_t((v / disk + 1) / 2 * cells); };
        for (int i = 0; i < lanes; ++i) ++observed[light[i]][cell(y[i]) * cells + cell(x[i])];
    });
    for (std::uint32_t light = 0; light < 2; ++light) {
        std::vector<double> expected(cells * cells);
        constexpr double step = 2.0 * disk / (cells * fine);
        for (int j = 0; j < cells * fine; ++j)
            for (int i = 0; i < cells * fine; ++i) {
                const float x = float(-disk + (i + 0.5) * step), y = float(-disk + (j + 0.5) * step);
                const Vec3 p(Vec3f{x, y, 5});
                const Mask covered(x * x + y * y < disk * disk);
                const double ratio = double(first(aiming.ratio_of_line(UInt(light), p, d, disk, covered)));
                expected[std::size_t(j / fine * cells + i / fine)] +=
                    double(tables.lights[light].pmf) * ratio * n * step * step / (std::numbers::pi * disk * disk);
            }
        EXPECT_NEAR(std::accumulate(expected.begin(), expected.end(), 0.0),
                    std::accumulate(observed[light].begin(), observed[light].end(), 0.0), 0.005 * n);
        EXPECT_EQ(chi_square(observed[light], expected), "") << light;
    }
}

/// Without targets, lights are selected by their power and densities are those of the lights.
TEST(LightAiming, DoesNothingWithoutTargets)
{
    const LightTables tables = two_lights();
    const LightAiming aiming(tables, nullptr);
    EXPECT_EQ(first(aiming.choose(Float(0.7f)).light), 0u);
    EXPECT_EQ(first(aiming.choose(Float(0.8f)).light), 1u);
    EXPECT_FALSE(first(aiming.target(aiming.choose(Float(0.7f)).target, Mask(true)).valid));
    const Vec3 p(Vec3f{0, 0, 0}), d(Vec3f{0, 0, 1});
    EXPECT_EQ(first(aiming.ratio_from(UInt(0u), p, d, Float(1))), 1);
    EXPECT_EQ(first(aiming.ratio_of_line(UInt(0u), p, d, 2, Mask(true))), 1);
}

}  // namespace
}  // namespace fathom::test
