// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lights/light.h"
#include "support/lane_helpers.h"

namespace fathom {
namespace {

constexpr double pi = std::numbers::pi;

/// A tube of radiance 1 along z around the origin.
struct Tube {
    double half_length, radius;

    LightRecord record() const
    {
        TubeLightRecord tube;
        tube.half_axis[2] = float(half_length);
        tube.radius = float(radius);
        LightRecord light;
        light.set(tube);
        light.flags = LightRecord::two_sided;
        for (float& r : light.radiance) r = 1;
        return light;
    }
    Vec3d point(double turn, double z) const
    {
        return {radius * std::cos(2 * pi * turn), radius * std::sin(2 * pi * turn), z};
    }
    /// Calls f(turn, z, direction from p, solid angle) for n x n parts of the side that p sees.
    template <class F>
    void for_parts(Vec3d p, int n, F&& f) const
    {
        const double area = 2 * pi * radius / n * (2 * half_length / n);
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const double turn = (i + 0.5) / n, z = ((j + 0.5) / n * 2 - 1) * half_length;
                const Vec3d q = point(turn, z), to = q - p, normal{q.x / radius, q.y / radius, 0};
                const double d = length(to), cosine = -dot(normal, to) / d;
                if (cosine > 0) f(turn, z, to * (1 / d), cosine * area / (d * d));
            }
    }
};

/// Calls f(point on the tube, direction, inverse density) for n samples.
template <class F>
void for_samples(const Tube& tube, Vec3d p, int n, F&& f)
{
    const LightRecord record = tube.record();
    const LightReader<false> light(&record, UInt(0u));
    const Vec3 from(Vec3f{float(p.x), float(p.y), float(p.z)});
    test::Random random;
    for (int done = 0; done < n; done += lanes) {
        const LightSample s = sample_light(light, from, Float(0), random.next2(), Mask(true));
        float w[3][lanes], distance[lanes], inverse[lanes];
        store(w[0], s.wi.x), store(w[1], s.wi.y), store(w[2], s.wi.z);
        store(distance, s.distance), store(inverse, s.inverse_pdf);
        for (int i = 0; i < lanes; ++i) {
            const Vec3d wi{double(w[0][i]), double(w[1][i]), double(w[2][i])};
            f(p + wi * double(distance[i]), wi, double(inverse[i]));
        }
    }
}

struct Case {
    Tube tube;
    Vec3d p;
};
const Case cases[] = {
    {{1, 0.1}, {0.5, 0.7, 0.2}},      // a point beside the tube
    {{1, 0.1}, {0.3, -0.4, 3}},       // a point beyond an end
    {{1, 0.1}, {0.06, 0.085, -0.9}},  // a point close to the tube
    {{2, 1.5}, {-1.6, 0.3, -1}},      // a point close to a thick tube
    {{0.5, 0.01}, {40, -20, 10}},     // a point far away
    {{0.5, 0.01}, {0.4, 0.3, -50}},   // a point far away along the axis
};

TEST(TubeLight, SamplesLieOnTheSideThatFacesThePoint)
{
    for (const auto& [tube, p] : cases)
        for_samples(tube, p, 4000, [&](Vec3d q, Vec3d wi, double inverse) {
            const double slack = 2e-6 * length(p) + 1e-5 * tube.radius;
            ASSERT_NEAR(length(wi), 1, 1e-5);
            ASSERT_NEAR(std::hypot(q.x, q.y), tube.radius, slack);
            ASSERT_LE(std::abs(q.z), tube.half_length + slack);
            // Grazing points are on the silhouette to within rounding.
            ASSERT_LE(dot(wi, {q.x, q.y, 0}), 2e-3 * tube.radius);
            ASSERT_GT(inverse, 0);
        });
}

/// In each part of the surface, inverse densities average to its solid angle: samples have the density that they
/// report, which integrates to 1.
TEST(TubeLight, SamplesHaveTheirDensity)
{
    constexpr int turns = 8, heights = 6, n = 400000;
    for (const auto& [tube, p] : cases) {
        std::vector<double> expected(turns * heights), found(turns * heights), squares(turns * heights);
        const auto part = [&](double turn, double z) {
            const int i = std::clamp(int((turn - std::floor(turn)) * turns), 0, turns - 1),
                      j = std::clamp(int((z / tube.half_length + 1) / 2 * heights), 0, heights - 1);
            return std::size_t(i * heights + j);
        };
        double all = 0;
        tube.for_parts(p, 240 * 8, [&](double turn, double z, Vec3d, double solid) {
            expected[part(turn, z)] += solid, all += solid;
        });
        double sum = 0;
        int samples = 0;
        for_samples(tube, p, n, [&](Vec3d q, Vec3d, double inverse) {
            const std::size_t i = part(std::atan2(q.y, q.x) / (2 * pi), q.z);
            found[i] += inverse, squares[i] += inverse * inverse, sum += inverse, ++samples;
        });
        EXPECT_NEAR(sum / samples / all, 1, 2e-3) << length(p);
        for (std::size_t i = 0; i < found.size(); ++i)
            EXPECT_NEAR(found[i] / samples, expected[i], 5 * std::sqrt(squares[i]) / samples + 2e-3 * all)
                << length(p) << ", part " << i;
    }
}

/// Irradiance of a point that faces the tube, which is E = pi L r / d for infinite length.
TEST(TubeLight, IrradianceIsThatOfACylinder)
{
    const auto irradiance = [](const Tube& tube, double d) {
        double sum = 0;
        int n = 0;
        for_samples(tube, {d, 0, 0}, 100000,
                    [&](Vec3d, Vec3d wi, double inverse) { sum += inverse * std::max(-wi.x, 0.0), ++n; });
        return sum / n;
    };
    for (const double d : {0.1001, 0.15, 1.0, 7.0})
        EXPECT_NEAR(irradiance({1e4, 0.1}, d) / (pi * 0.1 / d), 1, 5e-3) << d;
    for (const double d : {0.15, 1.0, 30.0}) {
        const Tube tube{0.6, 0.1};
        double expected = 0;
        tube.for_parts({d, 0, 0}, 1000, [&](double, double, Vec3d to, double solid) { expected -= to.x * solid; });
        EXPECT_NEAR(irradiance(tube, d) / expected, 1, 5e-3) << d;
    }
}

TEST(TubeLight, IsDarkInside)
{
    for (const Vec3d& p : {Vec3d{0, 0, 0}, {0.02, 0.09, 0.3}, {0.05, 0, 4}, {0, 0, -7}})
        for_samples({1, 0.1}, p, 100, [&](Vec3d, Vec3d wi, double inverse) {
            EXPECT_EQ(inverse, 0);
            EXPECT_TRUE(std::isfinite(wi.x + wi.y + wi.z));
        });
}

}  // namespace
}  // namespace fathom
