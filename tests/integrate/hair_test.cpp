// SPDX-License-Identifier: Apache-2.0
#include "curve_scenes.h"

// Tests of hair: one scattering event covers reflection and transmission, whichever side the light leaves.
namespace fathom {
namespace {

using namespace test;

Material hair(Color absorption)
{
    Material m;
    m.kind = MaterialKind::hair;
    m.base_color = {{1, 1, 1}, -1};
    m.hair.absorption = {absorption, -1};
    return m;
}

Curves straight(bool ribbons)
{
    Curves rod;
    rod.basis = CurveBasis::linear;
    rod.ribbons = ribbons;
    for (float x : {-20.f, -3.f, -1.f, -0.3f, 0.2f, 1.f, 2.f, 20.f}) rod.points.push_back({x, 0, 0});
    rod.radii.assign(8, 1.f);
    rod.counts = {8};
    return rod;
}

/// White hair in a white environment is invisible, under any transform of the curves.
TEST(Hair, WhiteInAWhiteSky)
{
    for (const CurveBasis basis : curve_bases)
        for (int form = 0; form < 8; ++form) {
            const bool placed = form & 1, moving = form & 2, ribbons = form & 4;
            Curves curves = helix(basis, ribbons, 13, 0.06f);
            if (moving) shear_in_time(curves);
            expect_invisible(curves, hair({0, 0, 0}), placed, 200);
        }
}

/// Directional albedo of a fiber hit at offset h from straight ahead, in double precision.
double directional_albedo(double h, double sigma)
{
    const double eta = 1.55, c = std::sqrt(1 - h * h), t = std::sqrt(1 - (1 - c * c) / (eta * eta));
    const double p = (eta * c - t) / (eta * c + t), q = (c - eta * t) / (c + eta * t), f = (p * p + q * q) / 2;
    const double left = std::exp(-sigma * 2 * std::sqrt(1 - h * h / (eta * eta)));
    return f + (1 - f) * (1 - f) * left / (1 - f * left);
}

/// The rod lies across the view, with nearly parallel rays (0.01 rad): each pixel row has its offset across the width.
/// Scattering twice in one fiber would lose more light.
TEST(Hair, AbsorbsByWhereAcrossTheWidthItIsMet)
{
    const double sigma[3] = {0.1, 0.5, 2};
    for (const bool ribbons : {false, true})
        for (const bool placed : {false, true}) {
            SceneBuilder s;
            s.scene.environment.kind = EnvironmentKind::constant;
            s.scene.curves.push_back(straight(ribbons));
            s.add(CurvesInstance{0}, s.material(hair({0.1f, 0.5f, 2})));
            if (placed) s.scene.nodes[0].parent_from_node = Transform::scale({3, 3, 3});
            // The camera moves with the rod.
            const double height = 16;
            s.camera({0, 0, 100}, {0, 0, 0}, 2 * std::atan(0.01) * 180 / std::numbers::pi);
            const Film film = render_film(s.scene, small_image_settings(16, int(height)), 256);
            const Image image = film.image(false, true);
            const auto& pixels = image.layers[0].pixels;
            for (std::size_t row = 0; row < 16; ++row)
                for (std::size_t c = 0; c < 3; ++c) {
                    double mean = 0, expected = 0;
                    for (std::size_t x = 0; x < 16; ++x) mean += pixels[(row * 16 + x) * 3 + c] / 16;
                    constexpr int steps = 64;
                    for (int k = 0; k < steps; ++k)
                        expected +=
                            directional_albedo(2 * (double(row) + (k + 0.5) / steps) / height - 1, sigma[c]) / steps;
                    EXPECT_NEAR(mean, expected, 0.01 * expected + 0.002) << ribbons << placed << " " << row << " " << c;
                }
        }
}

/// Light from behind is transmitted with NEE and with BSDF sampling: MIS uses the original shading point, though rays
/// start beyond the rod.
TEST(Hair, IsLitFromBehind)
{
    for (const bool ribbons : {false, true}) {
        Mean mean[2];
        for (const bool sampled : {false, true}) {
            SceneBuilder s;
            s.scene.curves.push_back(straight(ribbons));
            s.add(CurvesInstance{0}, s.material(hair({0.2f, 0.2f, 0.2f})));
            s.camera({0, 0.3, 8}, {0, 0, 0}, 20);
            // A square light is close behind the rod.
            s.add(Rectangle{{-4, -4, -3}, {8, 0, 0}, {0, 8, 0}}, s.diffuse(0, {1, 1, 1}));
            RenderSettings settings = small_image_settings(16, 16);
            settings.light_sampling = sampled;
            mean[sampled] = mean_of(render_film(s.scene, settings, 2048));
        }
        EXPECT_GT(mean[1].value[0], 0.2);
        EXPECT_NEAR(mean[0].value[0], mean[1].value[0],
                    4 * std::hypot(mean[0].error[0], mean[1].error[0]) + 1e-3 * mean[1].value[0]);
    }
}

/// The first of melanin, absorption and color that is not zero determines the absorption.
TEST(Hair, ColorByMelaninAbsorptionOrColor)
{
    const auto albedo = [](const Material& m) {
        SceneBuilder s;
        s.scene.environment.kind = EnvironmentKind::constant;
        s.scene.curves.push_back(straight(false));
        s.add(CurvesInstance{0}, s.material(m));
        s.camera({0, 0, 100}, {0, 0, 0}, 1);
        return mean_of(render_film(s.scene, small_image_settings(16, 16), 64));
    };
    Material by_melanin = hair({0, 0, 0}), both = hair({0.3f, 0.3f, 0.3f});
    by_melanin.hair.eumelanin = 0.8f, by_melanin.hair.pheomelanin = 0.5f;
    both.hair.eumelanin = 3;
    Material by_absorption =
        hair({0.8f * 0.419f + 0.5f * 0.187f, 0.8f * 0.697f + 0.5f * 0.4f, 0.8f * 1.37f + 0.5f * 1.05f});
    Material by_color = hair({0, 0, 0});
    // The fit is that of Chiang et al. 2016 for azimuthal roughness 0.3.
    const double fit = 5.969 - 0.215 * 0.3 + 2.532 * 0.09 - 10.73 * 0.027 + 5.574 * 0.0081 + 0.245 * 0.00243;
    const auto look = [&](double sigma) { return float(std::exp(-std::sqrt(sigma) * fit)); };
    const Color a = by_absorption.hair.absorption.value;
    by_color.base_color.value = {look(a.r), look(a.g), look(a.b)};
    const Mean one = albedo(by_melanin), two = albedo(by_absorption), three = albedo(by_color);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(one.value[c], two.value[c], 1e-4);
        EXPECT_NEAR(three.value[c], two.value[c], 1e-4);
    }
    EXPECT_EQ(albedo(both).value[0], albedo(hair({0.3f, 0.3f, 0.3f})).value[0]);
}

/// Hair fibers run along increasing u on other shapes: a sphere, a disk, a parallelogram and triangles with white hair.
TEST(Hair, OnOtherShapes)
{
    Mesh two;
    two.positions = {{-1, -1, 0}, {1, -1, 0.2f}, {1, 1, 0}};
    two.uvs[0] = {{0, 1}, {1, 1}, {1, 0}};
    two.indices = {0, 1, 2};
    for (int shape = 0; shape < 4; ++shape) {
        SceneBuilder s;
        s.scene.environment.kind = EnvironmentKind::constant;
        s.scene.meshes.push_back(two);
        const int m = s.material(hair({0, 0, 0}));
        if (shape == 0) s.add(Sphere{{0, 0, 0}, 1, {}}, m);
        if (shape == 1) s.add(Disk{{0, 0, 0}, {0, 0, 1}, 1}, m);
        if (shape == 2) s.add(Rectangle{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}, m);
        if (shape == 3) s.add(MeshInstance{0}, m);
        s.camera({0, 0.5, 5}, {0, 0, 0});
        RenderSettings settings = small_image_settings();
        settings.max_depth = settings.roulette_depth = 1000;
        SCOPED_TRACE(shape);
        expect_mean(render_film(s.scene, settings, 64), 1, 1e-3);
    }
}

/// A band of triangles that faces the camera has the offsets of a ribbon, so it looks alike.
TEST(Hair, OnABandOfTrianglesAsOnARibbon)
{
    Mean mean[2][2];
    for (const bool mesh : {false, true})
        for (const bool above : {false, true}) {
            SceneBuilder s;
            Mesh band;
            band.positions = {{-20, -1, 0}, {20, -1, 0}, {20, 1, 0}, {-20, 1, 0}};
            // v grows downwards in images.
            band.uvs[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
            band.indices = {0, 1, 2, 0, 2, 3};
            s.scene.meshes.push_back(band);
            s.scene.curves.push_back(straight(true));
            const int m = s.material(hair({0.2f, 0.2f, 0.2f}));
            if (mesh)
                s.add(MeshInstance{0}, m);
            else
                s.add(CurvesInstance{0}, m);
            // The upper and the lower half, illuminated from above, differ.
            Light sun;
            sun.kind = LightKind::directional;
            s.light(sun, rotate_to({0.1, -1, -0.4}));
            const double y = above ? 0.5 : -0.5;
            s.camera({0, y, 100}, {0, y, 0}, 0.5);
            mean[mesh][above] = mean_of(render_film(s.scene, small_image_settings(16, 16), 64));
        }
    for (const bool above : {false, true})
        EXPECT_NEAR(mean[0][above].value[0], mean[1][above].value[0], 0.01 * mean[0][above].value[0]);
    EXPECT_GT(std::abs(mean[0][0].value[0] / mean[0][1].value[0] - 1), 0.2);
}

}  // namespace
}  // namespace fathom
