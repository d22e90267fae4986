// SPDX-License-Identifier: Apache-2.0
// Tests of light tracing in closed form: light that mirrors and glass send onto a floor.
#include <functional>

#include "light_tracing_scenes.h"

namespace fathom {
namespace {

using namespace test;

using std::numbers::pi;

/// Fresnel reflectance of glass of index 1.5 from outside.
double glass_reflectance(double cosine)
{
    const double inside = std::sqrt(1 - (1 - cosine * cosine) / 2.25);
    const double s = (cosine - 1.5 * inside) / (cosine + 1.5 * inside),
                 p = (inside - 1.5 * cosine) / (inside + 1.5 * cosine);
    return (s * s + p * p) / 2;
}

/// Mean irradiance of the square, from its value at points.
double mean_irradiance(const std::function<double(double, double)>& at)
{
    constexpr int n = 100;
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) sum += at((i + 0.5) / n - 0.5, (j + 0.5) / n - 0.5);
    return sum / (n * n);
}

/// Lamps without extent and a mirror at x = 1, which shows each of them again: the floor gets the light of both.
class MirroredLamps : public testing::TestWithParam<int> {
protected:
    /// Irradiance by a lamp of intensity 1 at p, times a factor by direction.
    static double by_point(Vec3d p, double x, double z, const std::function<double(Vec3d)>& factor)
    {
        const Vec3d to = Vec3d{x, 0, z} - p;
        return -to.y / std::pow(length(to), 3) * factor(normalize(to));
    }
    void expect(const Light& light, const Transform& place, double expected, std::uint64_t samples = 256)
    {
        SeenFloor b(GetParam());
        b.add(Rectangle{{1, 0, -4}, {0, 0, 8}, {0, 8, 0}}, b.material(conductor(0)));
        b.light(light, place);
        expect_mean(render_film(b.scene, traced(), samples), expected * 0.5 / pi, 0.003);
    }
};
INSTANTIATE_TEST_SUITE_P(Scenes, MirroredLamps, testing::Values(0, 1, 100), [](const auto& info) {
    return info.param == 0 ? "quads" : info.param == 1 ? "list" : "tree";
});

TEST_P(MirroredLamps, Point)
{
    const auto one = [](Vec3d) { return 1.0; };
    const double expected = mean_irradiance(
        [&](double x, double z) { return by_point({0.2, 1, 0.1}, x, z, one) + by_point({1.8, 1, 0.1}, x, z, one); });
    expect(Light{}, Transform::translate({0.2, 1, 0.1}), expected, 1024);
}

TEST_P(MirroredLamps, Spot)
{
    Light light;
    light.kind = LightKind::spot;
    light.inner_angle = 0.2, light.outer_angle = 0.9;
    const Vec3d axis = normalize(Vec3d{0.7, -1, 0});
    const double inner = std::cos(0.2), outer = std::cos(0.9);
    const auto cone = [&](Vec3d d) {
        const double f = std::clamp((dot(d, axis) - outer) / (inner - outer), 0.0, 1.0);
        return f * f;
    };
    const double expected = mean_irradiance([&](double x, double z) {
        return by_point({0.2, 1, 0.1}, x, z, cone) +
               by_point({1.8, 1, 0.1}, x, z, [&](Vec3d d) { return cone({-d.x, d.y, d.z}); });
    });
    expect(light, Transform::translate({0.2, 1, 0.1}) * rotate_to(axis), expected, 512);
}

TEST_P(MirroredLamps, DirectionalFromBothSides)
{
    Light light;
    light.kind = LightKind::directional;
    for (const double angle : {0.0, 0.02}) {
        light.angle = angle;
        // Light that falls toward the mirror arrives at the whole square twice.
        const Vec3d d = normalize(Vec3d{1, -1, 0.2});
        expect(light, rotate_to(d), -2 * d.y, 1024);
    }
}

TEST_P(MirroredLamps, Beam)
{
    Light light;
    light.kind = LightKind::beam;
    light.width = 0.3, light.height = 0.2;
    // All of the beam arrives at the square, by way of the mirror.
    const Vec3d d = normalize(Vec3d{1, -1, 0});
    expect(light, Transform::translate(Vec3d{1, 1, 0} - d * 0.5) * rotate_to(d), 0.06);
}

/// The sun through a thick pane, without the light that comes back from the floor or is reflected within the pane.
TEST(LightTracing, SunThroughAPane)
{
    for (const int spheres : {1, 100})
        for (const double angle : {0.0, 0.6}) {
            SeenFloor b(spheres, 0.6);
            b.add(Box{{-1.2, 0.5, -1.2}, {1.2, 0.6, 1.2}}, b.material(dielectric()));
            Light sun;
            sun.kind = LightKind::directional;
            b.light(sun, rotate_to({std::sin(angle), -std::cos(angle), 0}));
            RenderSettings settings = traced();
            settings.max_depth = 3;
            const double passed = std::pow(1 - glass_reflectance(std::cos(angle)), 2);
            expect_mean(render_film(b.scene, settings, 1024), std::cos(angle) * passed * 0.5 / pi, 0.01);
        }
}

}  // namespace
}  // namespace fathom
