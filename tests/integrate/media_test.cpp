// SPDX-License-Identifier: Apache-2.0
/// Tests of nested solids and their absorption against closed forms.
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

Material glass(double ior, double transmittance_of_a_metre = 1, int priority = 0)
{
    Material m;
    m.kind = MaterialKind::glass;
    m.ior = float(ior);
    const float a = float(transmittance_of_a_metre);
    m.interior.attenuation_color = {a, a, a};
    m.interior.attenuation_distance = transmittance_of_a_metre < 1 ? 1 : 0;
    m.interior.priority = priority;
    return m;
}

/// Transmittance and reflectance of a stack of layers at normal incidence.
struct Layers {
    double through = 1, back = 0;

    /// Adds a boundary in front of the stack.
    Layers& boundary(double ior_a, double ior_b)
    {
        const double root = (ior_a - ior_b) / (ior_a + ior_b), r = root * root;
        const double all = 1 / (1 - r * back);
        through *= (1 - r) * all;
        back = r + (1 - r) * (1 - r) * back * all;
        return *this;
    }
    /// Adds an absorbing medium in front of the stack.
    Layers& way(double transmittance)
    {
        through *= transmittance, back *= transmittance * transmittance;
        return *this;
    }
};

/// Radiance of white light from behind that passes boxes at normal incidence.
double classify_interface(const std::vector<std::pair<Box, Material>>& boxes, bool in_tree)
{
    SceneBuilder b;
    for (const auto& [box, material] : boxes) b.add(box, b.material(material));
    b.add(Rectangle{{-50, -50, -10}, {100, 0, 0}, {0, 100, 0}}, b.diffuse(0, {1, 1, 1}));
    if (in_tree)
        for (int i = 0; i < 100; ++i) b.add(Sphere{{100.0 + i, 0, 5}, 0.1, {}}, b.diffuse(0));
    b.camera({0, 0, 1}, {0, 0, 0}, 0.1);
    const Mean mean = mean_of(render_film(b.scene, small_image_settings(16, 16), 1024));
    EXPECT_LT(mean.error[0], 0.002);
    return mean.value[0];
}

Box layer(double front, double back)
{
    return {{-50, -50, back}, {50, 50, front}};
}

TEST(Media, WaterInAGlass)
{
    for (const bool in_tree : {false, true}) {
        // The water box overlaps the glass, whose higher priority displaces the water.
        const Layers overlapping = Layers().boundary(1.33, 1).way(0.8).boundary(1.6, 1.33).way(0.5).boundary(1, 1.6);
        const std::pair<Box, Material> pane{layer(0, -1), glass(1.6, 0.5, 1)}, water{layer(-0.9, -2), glass(1.33, 0.8)};
        EXPECT_NEAR(classify_interface({pane, water}, in_tree), overlapping.through, 0.006);
        EXPECT_NEAR(classify_interface({water, pane}, in_tree), overlapping.through, 0.006);
        // With opposite priorities the glass ends where the water begins.
        const double by_water = 0.8 * std::pow(0.8, 0.1), by_glass = std::pow(0.5, 0.9);
        const Layers shorter =
            Layers().boundary(1.33, 1).way(by_water).boundary(1.6, 1.33).way(by_glass).boundary(1, 1.6);
        EXPECT_NEAR(
            classify_interface({{layer(0, -1), glass(1.6, 0.5)}, {layer(-0.9, -2), glass(1.33, 0.8, 1)}}, in_tree),
            shorter.through, 0.006);
        // If boxes are nested without priorities, the inner medium applies.
        const Layers inside =
            Layers().boundary(1.6, 1).way(0.5).boundary(1, 1.6).way(1).boundary(1.6, 1).way(0.5).boundary(1, 1.6);
        EXPECT_NEAR(classify_interface({{layer(0, -3), glass(1.6, 0.5)}, {layer(-1, -2), glass(1)}}, in_tree),
                    inside.through, 0.006);
        // Overlapping boxes of the same glass act as one box.
        const Layers one = Layers().boundary(1.6, 1).way(std::pow(0.5, 2.5)).boundary(1, 1.6);
        EXPECT_NEAR(
            classify_interface({{layer(0, -1.5), glass(1.6, 0.5)}, {layer(-1, -2.5), glass(1.6, 0.5)}}, in_tree),
            one.through, 0.006);
    }
}

/// A light, a mirror and a dark wall inside colored glass are seen through its surface.
TEST(Media, ObjectsInsideColoredGlass)
{
    for (const bool mirrored : {false, true}) {
        SceneBuilder b;
        b.add(layer(0, -3), b.material(glass(1.5, 0.5)));
        Material thing;
        thing.kind = mirrored ? MaterialKind::metal : MaterialKind::none;
        thing.base_color.value = {1, 1, 1};
        if (!mirrored) thing.emission.radiance.value = {1, 1, 1};
        b.add(Rectangle{{-40, -40, -1}, {80, 0, 0}, {0, 80, 0}}, b.material(thing));
        if (mirrored) {
            Environment sky;
            sky.kind = EnvironmentKind::constant;
            b.scene.environment = sky;
        }
        b.camera({0, 0, 1}, {0, 0, 0}, 0.1);
        // The light is black and its radiance is divided by eta^2 on leaving the denser medium; light bounces between
        // mirror and boundary.
        const double r = 0.04, a = 0.5, there_and_back = 0.25;
        const double expected =
            mirrored ? r + (1 - r) * (1 - r) * there_and_back / (1 - r * there_and_back) : (1 - r) * a / (1.5 * 1.5);
        expect_mean(render_film(b.scene, small_image_settings(16, 16), 1024), expected, 0.003);
    }
}

/// A slab with isotropic scattering, no absorption and almost no boundary in a white environment, with limited depth:
/// entering and leaving are two bounces; each scattering event counts as one if the material says so, otherwise none.
TEST(Media, ScatteringCountsAsBounces)
{
    constexpr double thickness = 1.5;
    // Transmittance of isotropic light from a plane is the exponential integral E2.
    const auto passes = [](double depth) {
        double sum = 0;
        constexpr int n = 400;
        for (int i = 0; i < n; ++i) sum += std::exp(-depth * n / (i + 0.5)) / n;
        return sum;
    };
    double once = 0;
    constexpr int parts = 400;
    for (int i = 0; i < parts; ++i) {
        const double at = thickness * (i + 0.5) / parts;
        once += std::exp(-at) * (passes(at) + passes(thickness - at)) / 2 * thickness / parts;
    }
    const double straight = std::exp(-thickness);
    for (const bool counts : {false, true}) {
        SceneBuilder b;
        Material m;
        m.kind = MaterialKind::glass;
        m.ior = 1.0002f;
        m.interior.attenuation_distance = 1;
        m.interior.attenuation_color = {float(std::exp(-1)), float(std::exp(-1)), float(std::exp(-1))};
        m.interior.scatter = {1, 1, 1};
        m.interior.scatter_bounces = counts;
        b.add(layer(0, -thickness), b.material(m));
        b.scene.environment.kind = EnvironmentKind::constant;
        b.camera({0, 0, 1}, {0, 0, 0}, 0.1);
        const auto mean = [&](int max_depth) {
            RenderSettings settings = small_image_settings(16, 16);
            settings.max_depth = max_depth;
            return render_film(b.scene, settings, 1024);
        };
        expect_mean(mean(2), counts ? straight : 1, 0.005);
        expect_mean(mean(3), counts ? straight + once : 1, 0.005);
        expect_mean(mean(-1), 1, 0.005);
    }
}

/// Light is absorbed along its path through the medium, and so is the view of a camera inside it.
TEST(Media, ShadowRaysAndCamerasInsideColoredGlass)
{
    for (const bool in_tree : {false, true}) {
        SceneBuilder b;
        b.add(Box{{-100, -100, -100}, {100, 100, 100}}, b.material(glass(1.5, 0.8)));
        b.add(Rectangle{{-50, 0, 50}, {100, 0, 0}, {0, 0, -100}}, b.diffuse(0.5f));
        if (in_tree)
            for (int i = 0; i < 100; ++i) b.add(Sphere{{-60.0 + i, -10, 5}, 0.1, {}}, b.diffuse(0));
        b.point_light({7, 7, 7}, {0, 3, 0});
        b.camera({0, 1, 0}, {0, 0, 0}, 0.1);
        RenderSettings settings = small_image_settings(16, 16);
        settings.max_depth = 1;
        expect_mean(render_film(b.scene, settings, 16), 0.5 / std::numbers::pi * 7 / 9 * std::pow(0.8, 4), 0.001);
    }
}

/// Hollow glass spheres, and water spheres inside glass, lose no energy.
TEST(Media, NestedSpheresConserveEnergy)
{
    for (const int priority : {-1, 0, 1}) {
        SceneBuilder b;
        b.add(Sphere{{0, 0, 0}, 1, {}}, b.material(glass(1.5)));
        b.add(Sphere{{0, 0, 0}, -0.95, {}}, b.material(glass(1.5)));
        b.add(Sphere{{0, 0, 0}, 0.97, {}}, b.material(glass(1.33, 1, priority)));
        Environment sky;
        sky.kind = EnvironmentKind::constant;
        b.scene.environment = sky;
        b.camera({0, 0, 4}, {0, 0, 0}, 25);
        expect_mean(render_film(b.scene, small_image_settings(), 64), 1, 0.003);
    }
}

}  // namespace
}  // namespace fathom
