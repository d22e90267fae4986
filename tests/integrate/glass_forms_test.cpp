// SPDX-License-Identifier: Apache-2.0
#include "picture_helpers.h"

// Tests of glass and mirrors against the laws of reflection and refraction.
namespace fathom {
namespace {

using namespace test;

/// Glass of index 1 neither reflects nor refracts: transmission follows the Beer-Lambert law by the distance in the
/// slab, per channel.
TEST(GlassForms, AbsorptionByPathLength)
{
    for (const bool tree : {false, true})
        for (double degrees : {0.0, 40.0, 65.0})
            for (double size : {1.0, 50.0}) {
                SceneBuilder b;
                Material glass;
                glass.kind = MaterialKind::glass;
                glass.ior = 1;
                glass.interior.attenuation_color = {0.25f, 0.5f, 0.9f};
                glass.interior.attenuation_distance = 2 * size;
                b.add(Box{{-50 * size, -50 * size, -1.5 * size}, {50 * size, 50 * size, 0}}, b.material(glass));
                for (int i = 0; i < (tree ? 100 : 0); ++i) b.add(Sphere{{0, 1e3 * size + i, 1e3 * size}, 0.1, {}}, 0);
                b.scene.environment = uniform_sky({1, 2, 4});
                const double a = degrees * std::numbers::pi / 180;
                const Vec3d d{std::sin(a), 0, -std::cos(a)};
                b.camera(d * -size, {0, 0, 0}, 0.01);
                const Mean m = mean_of(render_film(b.scene, small_image_settings(4, 4), 64));
                const double color[] = {0.25, 0.5, 0.9}, light[] = {1, 2, 4};
                for (int c = 0; c < 3; ++c) {
                    const double expected = light[c] * std::pow(color[c], 0.75 / std::cos(a));
                    EXPECT_NEAR(m.value[c], expected, 4 * m.error[c] + 2e-3 * expected)
                        << degrees << " " << size << " " << c;
                }
            }
}

/// A slab displaces the view behind it by d sin(a) (1 - cos(a) / (n cos(b))) perpendicular to the ray; thin glass does
/// not.
TEST(GlassForms, ASlabShiftsWhatIsBehindIt)
{
    for (const bool thin : {false, true})
        for (float ior : {1.2f, 1.5f, 2.2f}) {
            const double degrees = 40, thickness = 2, a = degrees * std::numbers::pi / 180;
            const double b_angle = std::asin(std::sin(a) / double(ior));
            SceneBuilder b;
            Material glass, light;
            glass.kind = MaterialKind::glass;
            glass.ior = ior;
            glass.interior.thin = thin;
            light.kind = MaterialKind::none;
            light.emission.radiance.value = {1, 1, 1};
            light.emission.two_sided = true;
            if (thin)
                b.add(Rectangle{{-50, -50, 0}, {100, 0, 0}, {0, 100, 0}}, b.material(glass));
            else
                b.add(Box{{-50, -50, -thickness}, {50, 50, 0}}, b.material(glass));
            // The half plane behind the slab is perpendicular to the ray, with its edge on the straight continuation of
            // the ray.
            const Vec3d d{std::sin(a), 0, -std::cos(a)}, across{std::cos(a), 0, std::sin(a)};
            b.add(Rectangle{d * 20 + Vec3d{0, -9, 0}, across * 9, {0, 18, 0}}, b.material(light));
            // The camera is so far away that the whole image starts in front of the slab.
            b.camera(d * -15, {0, 0, 0});
            b.scene.cameras[0].kind = CameraKind::orthographic;
            b.scene.cameras[0].height = 4;
            RenderSettings settings = small_image_settings(64, 16);
            // Straight transmission takes two refractions, or one scattering event of thin glass.
            settings.max_depth = thin ? 1 : 2;
            const Image image = render_film(b.scene, settings, 256).image(false, false);
            // The image is 16 units wide; the edge is where brightness reaches half of its step.
            double full = 0, sum = 0;
            for (int x = 0; x < 64; ++x)
                for (int y = 0; y < 16; ++y) {
                    const double v = image.layers[0].pixels[std::size_t(3 * (y * 64 + x))];
                    sum += v / 16;
                    if (x >= 56) full += v / (16 * 8);
                }
            const double edge = 64 - sum / full;  // in pixels from the left
            // Refracted rays run closer to the normal and leave shifted against `across`.
            const double shift =
                thin ? 0 : thickness * std::sin(a) * (1 - std::cos(a) / (double(ior) * std::cos(b_angle)));
            EXPECT_NEAR((edge - 32) / 4, shift, 0.06) << thin << " " << ior;
            const double r0 = [&] {
                const double s = std::sin(a - b_angle) / std::sin(a + b_angle),
                             p = std::tan(a - b_angle) / std::tan(a + b_angle);
                return (s * s + p * p) / 2;
            }();
            EXPECT_NEAR(full, thin ? (1 - r0) / (1 + r0) : (1 - r0) * (1 - r0), 0.01) << thin << " " << ior;
        }
}

/// A mirror shows the mirrored direction times its color.
TEST(MirrorForms, ShowsTheMirroredDirection)
{
    SceneBuilder b;
    Material mirror;
    mirror.kind = MaterialKind::metal;
    mirror.base_color.value = {0.9f, 0.6f, 0.3f};
    b.add(Rectangle{{-5, 0, 5}, {10, 0, 0}, {0, 0, -10}}, b.material(mirror));
    Material light;
    light.kind = MaterialKind::unlit;
    light.base_color.value = {2, 2, 2};
    b.add(Sphere{{3, 3, 0}, 0.5, {}}, b.material(light));
    b.camera({-3, 3, 0}, {0, 0, 0}, 1);
    const Mean m = mean_of(render_film(b.scene, small_image_settings(4, 4), 16));
    // Reflectance is Schlick's at 45 degrees.
    const double w = std::pow(1 - std::sqrt(0.5), 5), color[] = {0.9, 0.6, 0.3};
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(m.value[c], 2 * (color[c] + (1 - color[c]) * w), 2e-3);
    b.scene.nodes[0].shapes.pop_back();
    EXPECT_EQ(mean_of(render_film(b.scene, small_image_settings(4, 4), 16)).value[0], 0);
}

/// A clear glass sphere loses nothing at any roulette depth and is invisible in a white sky. For colored glass early
/// roulette only adds noise.
TEST(GlassForms, RouletteIsUnbiased)
{
    Mean means[2][2];
    for (const bool coloured : {false, true})
        for (const bool early : {false, true}) {
            SceneBuilder b;
            Material glass;
            glass.kind = MaterialKind::glass;
            if (coloured) glass.transmission.color.value = {0.5f, 0.7f, 0.9f};
            b.add(Sphere{{0, 0, 0}, 1, {}}, b.material(glass));
            b.add(Sphere{{0, 0, 0}, -0.6, {}}, b.material(glass));
            b.scene.environment = uniform_sky({1, 1, 1});
            b.camera({0, 0, 3}, {0, 0, 0}, 30);
            RenderSettings settings = small_image_settings(16, 16);
            settings.roulette_depth = early ? 0 : 100;
            means[coloured][early] = mean_of(render_film(b.scene, settings, 256));
        }
    for (int c = 0; c < 3; ++c) {
        for (const bool early : {false, true})
            EXPECT_NEAR(means[0][early].value[c], 1, 4 * means[0][early].error[c] + 1e-3);
        EXPECT_NEAR(means[1][0].value[c], means[1][1].value[c],
                    4 * std::hypot(means[1][0].error[c], means[1][1].error[c]));
        EXPECT_LT(means[1][0].value[c], 0.99);
    }
}

}  // namespace
}  // namespace fathom
