// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "compile/compiled_scenes.h"
#include "fathom/error.h"
#include "lights/kinds/records.h"
#include "lights/sky/sky.h"

// Tests of compiled light tables. Most errors in them would show in an image only as noise, or not at all where two
// errors cancel.
namespace fathom {
namespace {

/// Selection probabilities sum to 1, match the cumulative table and are proportional to power, which is area * radiance
/// * pi, doubled for two sides, and 4 pi * intensity; they are at least a hundredth of the mean.
TEST(LightTable, ProbabilitiesGoWithPower)
{
    SceneDescription d = empty_scene();
    const auto shape = [&](auto geometry, int material) { d.nodes[0].shapes.push_back({geometry, material, ""}); };
    const int one = add_lamp(d, 3), two = add_lamp(d, 3, true);
    shape(Rectangle{{0, 0, -9}, {2, 0, 0}, {0, 3, 0}}, one);
    shape(Rectangle{{9, 0, -9}, {2, 0, 0}, {0, 3, 0}}, two);
    shape(Sphere{{0, 9, -9}, 0.5, {}}, one);
    shape(Disk{{9, 9, -9}, {0, 0, 1}, 0.75}, one);
    shape(Rectangle{{0, -9, -9}, {1e-3, 0, 0}, {0, 1e-3, 0}}, one);
    Light point;
    point.intensity = {2, 2, 2};
    add_light(d, point, Transform::translate({1, 2, 3}));
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    ASSERT_EQ(t.lights.size(), 6u);
    ASSERT_EQ(t.light_cdf.size(), 7u);
    const double pi = std::numbers::pi;
    // Powers are in table order: quads, spheres, disks, lights. The small one is raised to a hundredth of the mean.
    std::vector<double> power = {3 * 6 * pi,           2 * 3 * 6 * pi, 0, 3 * 4 * pi * 0.25 * pi,
                                 3 * pi * 0.5625 * pi, 2 * 4 * pi};
    double total = 0;
    for (double p : power) total += p;
    power[2] = 0.01 * total / 6;
    total += power[2];
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_NEAR(t.lights[i].pmf, power[i] / total, 2e-5) << i;
        EXPECT_FLOAT_EQ(t.lights[i].pmf, t.light_cdf[i + 1] - t.light_cdf[i]);
    }
    EXPECT_EQ(t.light_cdf.front(), 0);
    EXPECT_NEAR(t.light_cdf.back(), 1, 1e-6);
    EXPECT_EQ(t.lights[1].flags, LightRecord::two_sided);
    EXPECT_EQ(t.lights[0].flags, 0u);
}

/// Shapes refer to their lights and lights to their primitives, in render space.
TEST(LightTable, EmissiveShapesFollowTheirTransforms)
{
    SceneDescription d = empty_scene();
    d.cameras[0].position = {1, 0, 0}, d.cameras[0].look_at = {1, 0, -1};
    const int lamp = add_lamp(d, 5);
    d.nodes[0].parent_from_node = Transform::translate({0, 0, -3}) * Transform::scale({2, 2, 2});
    d.nodes[0].camera = -1;
    d.nodes.emplace_back().camera = 0;
    d.roots.push_back(1);
    d.nodes[0].shapes = {{Rectangle{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}}, lamp, ""}, {Sphere{{4, 0, 0}, -1, {}}, lamp, ""}};
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    const double s = t.render_scale;
    ASSERT_EQ(t.lights.size(), 2u);
    ASSERT_TRUE(t.lights[0].is<RectangleLightRecord>());
    const auto r = t.lights[0].get<RectangleLightRecord>();
    EXPECT_FLOAT_EQ(r.corner[0], float(-1 * s));
    EXPECT_FLOAT_EQ(r.corner[2], float(-3 * s));
    EXPECT_FLOAT_EQ(r.length_u, float(2 * s));
    EXPECT_FLOAT_EQ(r.flat.area, float(4 * s * s));
    EXPECT_FLOAT_EQ(r.flat.normal[2], -1);  // the normal is y cross x
    EXPECT_FLOAT_EQ(r.center[0], 0);
    EXPECT_FLOAT_EQ(r.center[1], float(s));
    EXPECT_FLOAT_EQ(r.diagonal, float(std::sqrt(8.0) * s));
    EXPECT_EQ(t.lights[0].radiance[0], 5);
    EXPECT_EQ(t.lights[0].primitive, t.first_quad());
    ASSERT_TRUE(t.lights[1].is<SphereLightRecord>());
    const auto ball = t.lights[1].get<SphereLightRecord>();
    EXPECT_FLOAT_EQ(ball.center[0], float(7 * s));
    EXPECT_FLOAT_EQ(ball.radius, float(-2 * s));
    for (std::uint32_t i = 0; i < 2; ++i) {
        const ShapeRecord& shape = t.shapes[t.shape_of_primitive[t.lights[i].primitive]];
        EXPECT_EQ(shape.light_base + (t.lights[i].primitive - shape.first_primitive), i);
    }
}

/// The sun of a sky becomes a directional light with the sun's size and irradiance at the sky's position; it rotates
/// with the sky and vanishes at night.
TEST(LightTable, TheSunOfASky)
{
    SceneDescription d = empty_scene();
    d.nodes[0].shapes.push_back({Sphere{{0, 0, -4}, 1, {}}, -1, ""});
    d.environment.kind = EnvironmentKind::sky;
    d.environment.to_sun = {2, 1, 0};
    d.environment.color = {2, 3, 5};
    for (const double turn_deg : {0., 90.}) {
        d.environment.world_from_environment = Transform::rotate({0, 1, 0}, turn_deg * std::numbers::pi / 180);
        const Scene scene = compiled(d);
        const SceneTables& t = *scene.data().tables;
        ASSERT_EQ(t.lights.size(), 2u);
        const LightRecord& sun = t.lights[1];
        ASSERT_TRUE(sun.is<DirectionalLightRecord>());
        const auto from = sun.get<DirectionalLightRecord>();
        const double side = 2 / std::sqrt(5), up = 1 / std::sqrt(5);
        EXPECT_NEAR(from.axis[0], turn_deg == 0 ? -side : 0, 1e-6);
        EXPECT_NEAR(from.axis[1], -up, 1e-6);
        EXPECT_NEAR(from.axis[2], turn_deg == 0 ? 0 : side, 1e-6);
        // A disk of 0.00935 radians has the irradiance of its radiance times pi sin^2 of half of that angle.
        const double s = std::sin(0.00935 / 2), solid_angle = std::numbers::pi * s * s;
        const Color arrives = Sky::sun_irradiance({2, 1, 0});
        EXPECT_NEAR(double(sun.radiance[0]) * solid_angle / (2 * double(arrives.r)), 1, 1e-5);
        EXPECT_NEAR(double(sun.radiance[1]) * solid_angle / (3 * double(arrives.g)), 1, 1e-5);
        EXPECT_NEAR(double(sun.radiance[2]) * solid_angle / (5 * double(arrives.b)), 1, 1e-5);
        // The visible sun agrees with it: the sky image's center column looks along +x, towards the sun.
        const EnvironmentRecord& e = t.environment;
        const auto at = [&](int x, int y) { return double(e.texels[std::size_t(4 * (y * e.width + x) + 1)]); };
        EXPECT_GT(at(e.width / 2, e.height / 3), 1.5 * at(0, e.height / 3));
        const double theta = (10 + 0.5) / e.height * std::numbers::pi,
                     phi = (30.5 / e.width - 0.5) * 2 * std::numbers::pi;
        const Color seen = Sky({2, 1, 0}).radiance(
            {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)});
        EXPECT_NEAR(at(30, 10) / double(seen.g), 1, 1e-5);
    }
    for (const auto& [to_sun, disk] : {std::pair{Vec3d{2, -0.01, 0}, true}, {Vec3d{2, 1, 0}, false}}) {
        d.environment.to_sun = to_sun;
        d.environment.sun_disk = disk;
        EXPECT_EQ(compiled(d).data().tables->lights.size(), 1u);
    }
    d.environment.to_sun = {0, 0, 0};
    EXPECT_THROW(compiled(d), Error);
}

TEST(LightTable, PointSpotAndSun)
{
    SceneDescription d = empty_scene();
    d.nodes[0].shapes.push_back({Sphere{{0, 0, -40}, 10, {}}, -1, ""});
    Light light;
    light.intensity = {1, 2, 3};
    add_light(d, light, Transform::translate({0, 5, 0}));
    light.kind = LightKind::spot;
    light.inner_angle = 0.2, light.outer_angle = 0.5;
    add_light(d, light, Transform::rotate({1, 0, 0}, -std::numbers::pi / 2) * Transform::scale({3, 3, 3}));
    light.kind = LightKind::directional;
    add_light(d, light, Transform::translate({7, 7, 7}));
    light.angle = 0.5;
    add_light(d, light, {});
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    ASSERT_EQ(t.lights.size(), 4u);
    const double s = t.render_scale;
    EXPECT_NE(s, 1);
    for (std::size_t i : {0, 1})
        for (std::size_t c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(t.lights[i].radiance[c], float(double(c + 1) * s * s));
    EXPECT_FLOAT_EQ(t.lights[0].get<PointLightRecord>().position[1], float(5 * s));
    const auto spot = t.lights[1].get<SpotLightRecord>();
    EXPECT_NEAR(spot.axis[1], -1, 1e-6);  // the node rotates -z to -y
    EXPECT_FLOAT_EQ(spot.outer, float(1 - std::cos(0.5)));
    EXPECT_FLOAT_EQ(spot.falloff, float(std::cos(0.2) - std::cos(0.5)));
    EXPECT_FLOAT_EQ(t.lights[2].radiance[2], 3);  // irradiance does not depend on the scale of render space
    const auto sun = t.lights[2].get<DirectionalLightRecord>(), wide = t.lights[3].get<DirectionalLightRecord>();
    EXPECT_EQ(sun.one_minus_cos, 0);
    EXPECT_NEAR(sun.axis[2], -1, 1e-6);
    const double half = 0.25;
    EXPECT_NEAR(wide.one_minus_cos, 1 - std::cos(half), 1e-7);
    EXPECT_NEAR(t.lights[3].radiance[1] * std::numbers::pi * std::sin(half) * std::sin(half), 2, 1e-5);
}

/// The light tree's bounding sphere of a moving curve contains it at every time, including its radius.
TEST(LightTable, BallsHoldCurvesThatMove)
{
    SceneDescription d = empty_scene();
    Curves curves;
    curves.basis = CurveBasis::linear;
    curves.points = {{9, 9, 9}, {9, 9, 8}};
    curves.radii = {1, 1};
    curves.counts = {2};
    curves.motion = {{0, {{0, 0, -9}, {1, 0, -9}}, {0.1f, 0.2f}},
                     {0.5, {{2, 0, -9}, {2, 3, -9}}, {0.1f, 0.5f}},
                     {1, {{-1, 0, -9}, {-3, 0, -9}}, {0.3f, 0}}};
    d.curves = {curves};
    d.nodes[0].shapes.push_back({CurvesInstance{0}, add_lamp(d, 3), ""});
    d.cameras[0].shutter_close = 1;
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    ASSERT_EQ(t.lights.size(), 1u);
    const LightNode& n = t.light_tree[t.lights[0].tree_place / LightNode::width];
    const std::size_t slot = t.lights[0].tree_place % LightNode::width;
    for (int i = 0; i <= 20; ++i)
        for (std::size_t end = 0; end < 2; ++end) {
            const CurvesKey &a = curves.motion[i < 10 ? 0 : 1], &b = curves.motion[i < 10 ? 1 : 2];
            const double f = i / 10.0 - (i < 10 ? 0 : 1);
            const auto mean = [&](float x, float y) {
                return t.render_scale * (double(x) + f * (double(y) - double(x)));
            };
            const Vec3f p = a.points[end], q = b.points[end];
            const double away = std::hypot(mean(p.x, q.x) - double(n.x[slot]), mean(p.y, q.y) - double(n.y[slot]),
                                           mean(p.z, q.z) - double(n.z[slot]));
            EXPECT_LE(away + mean(a.radii[end], b.radii[end]), double(n.radius[slot]) * (1 + 1e-6)) << i;
        }
    // The bounding sphere is not much larger than the curve's motion.
    EXPECT_LT(double(n.radius[slot]), 6 * t.render_scale);
}

/// Marginal and conditional distributions of an environment follow its luminance; dark parts get almost no samples.
TEST(EnvironmentTable, DistributionFollowsTheImage)
{
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "fathom-compile-sky.exr";
    Image image;
    image.width = 16, image.height = 8;
    image.layers.push_back({"", {"R", "G", "B"}, std::vector<float>(16 * 8 * 3, 0)});
    image.layers[0].pixels[3 * (2 * 16 + 0) + 1] = 9;  // one channel of the texel at column 0, row 2
    write_image(file, image, {});
    SceneDescription d = empty_scene();
    d.images.push_back({"sky", file, {}});
    d.environment.kind = EnvironmentKind::image;
    d.environment.image = 0;
    d.nodes[0].shapes.push_back({Sphere{{0, 0, -40}, 10, {}}, -1, ""});
    const Scene scene = compiled(d);
    std::filesystem::remove(file);
    const EnvironmentRecord& e = scene.data().tables->environment;
    ASSERT_EQ(e.marginal.size(), 9u);
    ASSERT_EQ(e.conditional.size(), 8u * 17);
    // Luminance of a row is the mean over 3 x 3 texels times the sine: rows 1, 2, 3, columns 15, 0, 1.
    double rows[8] = {}, total = 0;
    for (int y : {1, 2, 3}) rows[y] = std::sin((y + 0.5) * std::numbers::pi / 8), total += rows[y];
    for (std::size_t y = 0; y < 8; ++y) EXPECT_NEAR(e.marginal[y + 1] - e.marginal[y], rows[y] / total, 1e-6) << y;
    for (std::size_t y : {1u, 2u, 3u})
        for (std::size_t x = 0; x < 16; ++x)
            EXPECT_NEAR(e.conditional[y * 17 + x + 1] - e.conditional[y * 17 + x], x < 2 || x == 15 ? 1.0 / 3 : 0, 1e-6)
                << x;
    ASSERT_NE(e.light, no_index);
    EXPECT_EQ(scene.data().tables->lights[e.light].kind, std::uint32_t(LightRecordKind::environment));
    // Constants that give a cell's luminance from its pdf: the mean over the sphere, and the rest. Green of 9 over 9
    // texels is 0.7152; all sampled cells are equal, with pdf 1 / (their total solid angle).
    double sphere = 0, sampled = 0;
    for (int y = 0; y < 8; ++y) {
        const double sine = std::sin((y + 0.5) * std::numbers::pi / 8);
        sphere += 16 * sine, sampled += rows[y] > 0 ? 3 * sine : 0;
    }
    const double mean = 0.7152 * sampled / sphere;
    EXPECT_NEAR(e.base_luminance, mean, 1e-4);
    EXPECT_NEAR(e.luminance_per_pdf / (4 * std::numbers::pi * sampled / sphere), 0.7152 - mean, 1e-4);
}

}  // namespace
}  // namespace fathom
