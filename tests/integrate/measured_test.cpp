// SPDX-License-Identifier: Apache-2.0
#include "picture_helpers.h"

// Tests of scenes with measured materials: orientation, and agreement of NEE and BSDF sampling.
namespace fathom {
namespace {

using namespace test;

using std::numbers::pi;

/// A diffuse measured BRDF whose value per channel depends only on the azimuth of the view. Its integral over
/// directions is 2 pi times the value.
MeasuredBrdf even(const std::vector<float>& phis, const std::vector<Color>& colors)
{
    MeasuredBrdf brdf;
    brdf.name = "even";
    brdf.phi = phis;
    brdf.color_is_per_facet = false;
    brdf.ndf = brdf.sigma = {2, 2, {1, 1, 1, 1}};
    constexpr int width = 24;
    brdf.vndf.width = width, brdf.vndf.height = 2;
    for (std::size_t i = 0; i < phis.size() * 2 * width; ++i) {
        const double u = double(i % width) / (width - 1);
        brdf.vndf.values.push_back(float(u * std::sin(u * u * pi / 2)));
    }
    brdf.luminance = {2, 2, std::vector<float>(4 * phis.size(), 1)};
    brdf.color.width = brdf.color.height = 2;
    for (const Color& c : colors)
        for (const float x : {c.r, c.g, c.b}) brdf.color.values.insert(brdf.color.values.end(), 4, x);
    return brdf;
}

Material measured(int index)
{
    Material m;
    m.kind = MaterialKind::measured;
    m.measured = index;
    return m;
}

const std::vector<float> quarters = {float(-pi), float(-pi / 2), 0, float(pi / 2), float(pi)};
const std::vector<Color> by_quarter = {
    {0.05f, 0.1f, 0.15f}, {0.1f, 0.02f, 0.06f}, {0.12f, 0.14f, 0.03f}, {0.03f, 0.05f, 0.1f}, {0.05f, 0.1f, 0.15f}};

void expect_color(const Film& film, const Color& c)
{
    const Mean m = mean_of(film);
    const float expected[] = {c.r, c.g, c.b};
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(m.value[k], 2 * pi * double(expected[k]), 4 * m.error[k] + 0.003) << "channel " << k;
}

/// Azimuth is measured from the tangent, which is edge_u of a rectangle, towards cross(normal, tangent), also behind
/// the surface.
TEST(MeasuredScenes, LieAlongTheTangent)
{
    for (const double turned : {0.0, 0.8})
        for (const double elevation : {50.0, -50.0})
            for (const double azimuth : {20.0, 100.0, 200.0, 320.0}) {
                SceneBuilder s;
                s.scene.environment.kind = EnvironmentKind::constant;
                s.scene.measured = {even({0}, {{0.2f, 0.2f, 0.2f}}), even(quarters, by_quarter)};
                // The front faces up, along cross(edge_u, edge_v).
                s.add(Rectangle{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}}, s.material(measured(1)));
                s.scene.nodes[0].parent_from_node = Transform::rotate({0, 1, 0}, turned);
                const double a = azimuth * pi / 180, e = elevation * pi / 180;
                const Vec3d from{30 * std::cos(e) * std::cos(a), 30 * std::sin(e), -30 * std::cos(e) * std::sin(a)};
                s.camera(from, {0, 0, 0}, 1);
                // The camera rotates with its node.
                const double phi = std::remainder(a, 2 * pi), step = (phi + pi) / (pi / 2);
                const auto below = std::size_t(step);
                const auto t = float(step - double(below));
                const Color &p = by_quarter[below], &q = by_quarter[below + 1];
                SCOPED_TRACE(testing::Message() << turned << ", from " << elevation << ", " << azimuth);
                expect_color(render_film(s.scene, small_image_settings(16, 12), 256),
                             {p.r + t * (q.r - p.r), p.g + t * (q.g - p.g), p.b + t * (q.b - p.b)});
            }
}

/// NEE and BSDF sampling agree with the closed form of a polygonal light.
TEST(MeasuredScenes, LampsAreFoundBothWays)
{
    Mean means[2];
    for (const bool sampled : {false, true}) {
        SceneBuilder s;
        s.scene.measured = {even({0}, {{0.2f, 0.1f, 0.05f}})};
        s.add(Rectangle{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}}, s.material(measured(0)));
        Material lamp;
        lamp.kind = MaterialKind::none;
        lamp.emission.radiance.value = {3, 4, 5};
        s.add(Rectangle{{-0.7, 1, -0.5}, {1.5, 0, 0}, {0, 0, 1}}, s.material(lamp));
        s.camera({0.3, 8, 9}, {0, 0, 0}, 6);
        RenderSettings settings = small_image_settings(16, 12);
        settings.light_sampling = sampled;
        means[sampled] = mean_of(render_film(s.scene, settings, sampled ? 256 : 2048));
    }
    for (int c = 0; c < 3; ++c) {
        EXPECT_GT(means[1].value[c], 0.1);
        EXPECT_NEAR(means[0].value[c], means[1].value[c], 4 * std::hypot(means[0].error[c], means[1].error[c]));
    }
}

/// The albedo layer shows approximately the reflected fraction.
TEST(MeasuredScenes, HaveAnAlbedo)
{
    SceneBuilder s;
    s.scene.measured = {even({0}, {{0.2f, 0.1f, 0.05f}})};
    s.add(Rectangle{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}}, s.material(measured(0)));
    s.camera({0, 9, 1}, {0, 0, 0}, 4);
    RenderSettings settings = small_image_settings(4, 4);
    settings.aovs.push_back(Aov::albedo);
    const Image image = render_film(s.scene, settings, 1).image(false, false);
    const auto& pixels = image.find("albedo")->pixels;
    EXPECT_FLOAT_EQ(pixels[0], 0.2f);
    EXPECT_FLOAT_EQ(pixels[1], 0.1f);
    EXPECT_FLOAT_EQ(pixels[2], 0.05f);
}

}  // namespace
}  // namespace fathom
