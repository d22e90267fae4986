// SPDX-License-Identifier: Apache-2.0
#include "picture_helpers.h"

// Tests of solids with subsurface scattering: Chandrasekhar's half-space, the Beer-Lambert law, and energy
// conservation.
namespace fathom {
namespace {

using namespace test;

/// All light enters the solid: its boundary reflects nothing.
Material subsurface(Color color, double radius, float anisotropy = 0)
{
    Material m;
    m.kind = MaterialKind::principled;
    m.specular.weight.value = 0;
    m.subsurface.weight.value = 1;
    m.subsurface.color.value = color;
    m.subsurface.radius.value = float(radius);
    m.subsurface.scatter_anisotropy = anisotropy;
    return m;
}

/// An index-matched medium with an extinction of 1 per meter.
Material cloud(Color albedo, float anisotropy = 0)
{
    const float left = std::exp(-1.0f);
    Material m;
    m.kind = MaterialKind::glass;
    m.ior = 1;
    m.interior.attenuation_color = {left, left, left};
    m.interior.attenuation_distance = 1;
    m.interior.scatter = albedo;
    m.interior.scatter_anisotropy = anisotropy;
    return m;
}

/// Chandrasekhar's H function of isotropic scattering, by iterating 1 / H(mu) = sqrt(1 - a) + a / 2 int H(x) x / (mu +
/// x) dx.
class HFunction {
public:
    explicit HFunction(double albedo) : albedo_(albedo), h_(steps, 1.0)
    {
        for (int round = 0; round < 500; ++round) {
            std::vector<double> next;
            for (int i = 0; i < steps; ++i) next.push_back((h_[std::size_t(i)] + at(middle(i))) / 2);
            h_ = next;
        }
    }
    double at(double mu) const
    {
        double integral = 0;
        for (int i = 0; i < steps; ++i) integral += h_[std::size_t(i)] * middle(i) / (mu + middle(i)) / steps;
        return 1 / (std::sqrt(1 - albedo_) + albedo_ / 2 * integral);
    }
    /// Fraction of light from one direction that a half-space reflects.
    double plane_albedo(double mu) const { return 1 - at(mu) * std::sqrt(1 - albedo_); }
    /// Fraction of light from all directions (uniform radiance) that a half-space reflects.
    double spherical_albedo() const
    {
        double sum = 0;
        for (int i = 0; i < steps; ++i) sum += 2 * middle(i) * plane_albedo(middle(i)) / steps;
        return sum;
    }

private:
    static constexpr int steps = 200;
    static double middle(int i) { return (i + 0.5) / steps; }

    double albedo_;
    std::vector<double> h_;
};

/// Radiance under a white sky at the center of a face of a solid, far from all its other faces.
Mean face_of(const Material& m, double degrees, std::uint64_t samples = 1024)
{
    SceneBuilder b;
    b.add(Box{{-200, -200, -200}, {200, 200, 0}}, b.material(m));
    b.scene.environment = uniform_sky();
    const double a = degrees * std::numbers::pi / 180;
    b.camera(Vec3d{std::sin(a), 0, std::cos(a)} * 20, {0, 0, 0}, 0.01);
    return mean_of(render_film(b.scene, small_image_settings(16, 16), samples));
}

TEST(Subsurface, HalfSpaceHasChandrasekharsAlbedo)
{
    const Color albedo{0.3f, 0.8f, 0.97f};
    const double channel[] = {0.3, 0.8, 0.97};
    for (double degrees : {0.0, 60.0, 80.0}) {
        const Mean m = face_of(cloud(albedo), degrees);
        for (int c = 0; c < 3; ++c) {
            const double expected = HFunction(channel[c]).plane_albedo(std::cos(degrees * std::numbers::pi / 180));
            EXPECT_NEAR(m.value[c], expected, 4 * m.error[c] + 1e-3) << degrees << " degrees, channel " << c;
        }
    }
}

/// With a Lambertian boundary, the spherical albedo of the half-space is the material's color.
TEST(Subsurface, ColorIsTheAlbedoOfAHalfSpace)
{
    const double color[] = {0.15, 0.5, 0.85};
    const Mean m = face_of(subsurface({0.15f, 0.5f, 0.85f}, 0.5), 40);
    for (int c = 0; c < 3; ++c) {
        // Van de Hulst's approximation is solved by bisection.
        double s = 0, above = 1;
        for (int i = 0; i < 60; ++i) {
            const double middle = (s + above) / 2;
            const bool is_brighter = (1 - middle) * (1 - 0.139 * middle) / (1 + 1.17 * middle) > color[c];
            (is_brighter ? s : above) = middle;
        }
        EXPECT_NEAR(m.value[c], HFunction(1 - s * s).spherical_albedo(), 4 * m.error[c] + 1e-3) << c;
        EXPECT_NEAR(m.value[c], color[c], 4 * m.error[c] + 0.02 * color[c]) << c;
    }
    for (float g : {-0.5f, 0.7f}) {
        const Mean turned = face_of(subsurface({0.15f, 0.5f, 0.85f}, 0.5, g), 0);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(turned.value[c], color[c], 4 * turned.error[c] + 0.06 * color[c]) << g << " " << c;
    }
}

/// Lossless solids are invisible under a white sky, with any content and any boundary reflection.
TEST(Subsurface, WhiteSolidsAreInvisible)
{
    const auto expect_invisible = [](const Material& m, bool with_glass, double tolerance) {
        SceneBuilder b;
        b.add(Sphere{{0, 0, 0}, 1, {}}, b.material(m));
        Material glass;
        glass.kind = MaterialKind::glass;
        if (with_glass) b.add(Sphere{{0.2, 0.1, 0.5}, 0.3, {}}, b.material(glass));
        b.scene.environment = uniform_sky();
        b.camera({0, 0, 2.2}, {0, 0, 0}, 30);
        expect_mean(render_film(b.scene, small_image_settings(), 64), 1, tolerance);
    };
    for (float g : {-0.8f, 0.0f, 0.9f}) {
        Material m = subsurface({1, 1, 1}, 0.1, g);
        expect_invisible(m, false, 1e-3);
        expect_invisible(m, true, 1e-3);
        m.specular.weight.value = 1, m.roughness.value = 0.3f;
        expect_invisible(m, false, 5e-3);
        m.subsurface.weight.value = 0.5f, m.base_color.value = {1, 1, 1};
        expect_invisible(m, false, 5e-3);
        expect_invisible(cloud({1, 1, 1}, g), false, 1e-3);
        m = cloud({1, 1, 1}, g);
        m.ior = 1.4f;
        expect_invisible(m, true, 1e-3);
    }
    // One part is refracted into one medium; subsurface scattering leads into another.
    Material both = subsurface({1, 1, 1}, 0.05);
    both.transmission.weight.value = 0.5f;
    both.specular.weight.value = 1;
    expect_invisible(both, false, 5e-3);
}

/// A light so small that scattered light is negligible is attenuated by the Beer-Lambert law, per channel, however much
/// the channels differ.
TEST(Subsurface, UnscatteredLightFollowsTheLawOfBeer)
{
    const double left[] = {0.9, 0.2, 0.003};
    SceneBuilder b;
    Material m = cloud({0.1f, 1.0f, 3.0f});
    m.interior.attenuation_color = {0.9f, 0.2f, 0.003f};
    m.interior.attenuation_distance = 2;
    b.add(Box{{-50, -50, -2}, {50, 50, 0}}, b.material(m));
    Material lamp;
    lamp.kind = MaterialKind::none;
    lamp.emission.radiance.value = {1, 1, 1};
    b.add(Sphere{{0, 0, -40}, 0.02, {}}, b.material(lamp));
    b.camera({0, 0, 10}, {0, 0, 0}, 0.02);
    const Mean mean = mean_of(render_film(b.scene, small_image_settings(16, 16), 2048));
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(mean.value[c], left[c], 4 * mean.error[c] + 1e-5) << c;
        EXPECT_LT(mean.error[c], 0.02 * left[c]) << c;
    }
}

/// NEE where light leaves the solid and BSDF sampling give the same mean.
TEST(Subsurface, LightSamplingFindsTheSame)
{
    Mean mean[2];
    for (const bool sampled : {false, true}) {
        SceneBuilder b;
        b.add(Sphere{{0, 0, 0}, 1, {}}, b.material(subsurface({0.9f, 0.7f, 0.5f}, 0.3)));
        b.add(Sphere{{2.5, 1, 0}, 1, {}}, b.diffuse(0, {3, 3, 3}));
        b.camera({0, 0, 4}, {0, 0, 0}, 20);
        RenderSettings settings = small_image_settings();
        settings.light_sampling = sampled;
        mean[sampled] = mean_of(render_film(b.scene, settings, sampled ? 128 : 512));
    }
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(mean[1].value[c], mean[0].value[c], 4 * std::hypot(mean[0].error[c], mean[1].error[c])) << c;
}

/// A light inside a solid can't be sampled at scattering events of the walk, so a walk that hits it gets the full
/// emission.
TEST(Subsurface, LampsWithinAreFoundByScattering)
{
    Mean mean[2];
    for (const bool sampled : {false, true}) {
        SceneBuilder b;
        b.add(Sphere{{0, 0, 0}, 1, {}}, b.material(cloud({0.9f, 0.7f, 0.3f})));
        b.add(Sphere{{0, 0, -0.3}, 0.4, {}}, b.diffuse(0, {3, 3, 3}));
        b.camera({0, 4, 0}, {0, 0.7, 0}, 10);
        RenderSettings settings = small_image_settings();
        settings.light_sampling = sampled;
        mean[sampled] = mean_of(render_film(b.scene, settings, 256));
    }
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(mean[1].value[c], mean[0].value[c], 4 * std::hypot(mean[0].error[c], mean[1].error[c])) << c;
        EXPECT_GT(mean[1].value[c], 50 * mean[1].error[c]) << c;
    }
}

/// Half of the light is refracted and half is scattered, each into its own medium: the refracted part is transmitted,
/// the other absorbed.
TEST(Subsurface, RefractedLightIsInAnotherMedium)
{
    Material m = subsurface({0, 0, 0}, 0.01);
    m.transmission.weight.value = 0.5f;
    m.ior = 1;
    SceneBuilder b;
    b.add(Sphere{{0, 0, 0}, 1, {}}, b.material(m));
    b.scene.environment = uniform_sky();
    b.camera({0, 0, 5}, {0, 0, 0}, 10);
    expect_mean(render_film(b.scene, small_image_settings(), 64), 0.5, 0.005);
}

/// The texture where light enters times the material's color is the albedo of the walk, and of the albedo layer. Both
/// boxes have the same medium.
TEST(Subsurface, ColorHasATexture)
{
    const Color colors[] = {{0.85f, 0.5f, 0.15f}, {0.2f, 0.8f, 0.5f}};
    SceneBuilder boxes;
    for (int i = 0; i < 2; ++i) {
        Texture texture;
        texture.kind = TextureKind::checker_uv;
        texture.color_a.value = texture.color_b.value = {colors[i].r / 0.9f, colors[i].g / 0.9f, colors[i].b / 0.9f};
        Material m = subsurface({0.9f, 0.9f, 0.9f}, 0.01, 0.4f);
        m.subsurface.color.texture = int(boxes.scene.textures.size());
        boxes.scene.textures.push_back(texture);
        const double x = i == 0 ? -11 : 1;
        boxes.add(Box{{x, -10, -10}, {x + 10, 10, 0}}, boxes.material(m));
    }
    boxes.scene.environment = uniform_sky();
    for (int i = 0; i < 2; ++i) {
        SceneBuilder b = boxes;
        const double x = i == 0 ? -6 : 6;
        b.camera(Vec3d{x, 0, 5}, {x, 0, 0}, 1);
        RenderSettings settings = small_image_settings(16, 16);
        settings.aovs = {Aov::albedo};
        const Film film = render_film(b.scene, settings, 1024);
        const Mean m = mean_of(film);
        const Image image = film.image(false, false);
        const float* albedo = image.find("albedo")->pixels.data();
        for (int c = 0; c < 3; ++c) {
            const float color = c == 0 ? colors[i].r : c == 1 ? colors[i].g : colors[i].b;
            EXPECT_NEAR(m.value[c], color, 4 * m.error[c] + 0.04 * color) << i << " " << c;
            EXPECT_NEAR(albedo[c], color, 1e-3) << i << " " << c;
        }
    }
}

/// After crossing one solid, light is scattered with the color of the next: in a corner of two solids, constant
/// textures look like plain colors.
TEST(Subsurface, EachSolidHasItsOwnTexture)
{
    Mean mean[2];
    for (const bool textured : {false, true}) {
        SceneBuilder b;
        const auto add = [&](const Box& box, Color color) {
            Material m = subsurface(color, 0.01);
            if (textured) {
                Texture texture;
                texture.kind = TextureKind::checker_uv;
                texture.color_a.value = texture.color_b.value = color;
                m.subsurface.color.value = {1, 1, 1};
                m.subsurface.color.texture = int(b.scene.textures.size());
                b.scene.textures.push_back(texture);
            }
            b.add(box, b.material(m));
        };
        add(Box{{-5, -5, -1}, {5, 0, 5}}, {0.9f, 0.5f, 0.1f});
        add(Box{{-5, 0.01, -5}, {5, 5, -1}}, {0.1f, 0.6f, 0.9f});
        b.scene.environment = uniform_sky();
        b.camera({0, 3, 4}, {0, 0, -0.5}, 2);
        mean[textured] = mean_of(render_film(b.scene, small_image_settings(16, 16), 1024));
    }
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(mean[1].value[c], mean[0].value[c],
                    4 * std::hypot(mean[0].error[c], mean[1].error[c]) + 0.003 * mean[0].value[c])
            << c;
}

/// A material with a textured radius: the product is 0.4, 0.2 and 0.1 meters by channel.
Material radius_by_textures(SceneBuilder& b, Color color, float size)
{
    const auto constant = [&](Color value) {
        Texture texture;
        texture.kind = TextureKind::checker_uv;
        texture.color_a.value = texture.color_b.value = value;
        b.scene.textures.push_back(texture);
        return int(b.scene.textures.size()) - 1;
    };
    Material m = subsurface(color, 10);
    m.subsurface.radius.texture = constant({1, size / 10, 1});
    m.subsurface.radius.channel = 1;
    m.subsurface.radius_scale.value = {1, 1, 1};
    m.subsurface.radius_scale.texture = constant({1, 0.5f, 0.25f});
    return m;
}

/// Diffuse light crosses an absorbing slab with the transmittance 2 E3(t) = 2 int_0^1 mu exp(-t / mu) dmu of its
/// optical thickness t. Both slabs have the same medium.
TEST(Subsurface, RadiusHasATexture)
{
    SceneBuilder slabs;
    for (const double x : {-101.0, 1.0}) {
        const Material m = radius_by_textures(slabs, {0, 0, 0}, x < 0 ? 0.8f : 0.3f);
        slabs.add(Box{{x, -50, -0.2}, {x + 100, 50, 0}}, slabs.material(m));
    }
    slabs.scene.environment = uniform_sky();
    for (const double x : {-51.0, 51.0}) {
        SceneBuilder b = slabs;
        b.camera(Vec3d{x, 0, 5}, {x, 0, 0}, 1);
        const Mean m = mean_of(render_film(b.scene, small_image_settings(16, 16), 1024));
        for (int c = 0; c < 3; ++c) {
            const double thickness = 0.2 / ((x < 0 ? 0.8 : 0.3) * std::exp2(-c));
            double expected = 0;
            constexpr int steps = 10000;
            for (int i = 0; i < steps; ++i) {
                const double mu = (i + 0.5) / steps;
                expected += 2 * mu * std::exp(-thickness / mu) / steps;
            }
            EXPECT_NEAR(m.value[c], expected, 4 * m.error[c] + 1e-4) << x << " " << c;
        }
    }
}

/// Textured radii with scattering, and with NEE inside the solid: chalk under a light whose back is visible, in wax and
/// in black ice.
TEST(Subsurface, TexturedRadiusAppliesToTheWholeWalk)
{
    enum { plain, textured, by_chance };
    const auto show = [](Color color, int way) {
        SceneBuilder b;
        b.add(Sphere{{0, 0, 0}, 1, {}},
              b.material(way == plain ? subsurface(color, 0.4) : radius_by_textures(b, color, 0.4f)));
        b.add(Disk{{0, 0, -0.2}, {0, 0, 1}, 0.7}, b.diffuse(0.8f));
        b.add(Disk{{0, 0, 0.3}, {0, 0, -1}, 0.2}, b.diffuse(0, {9, 9, 9}));
        b.camera({0, 0, 4}, {0, 0, 0}, 5);
        RenderSettings settings = small_image_settings();
        settings.light_sampling = way != by_chance;
        return mean_of(render_film(b.scene, settings, way == by_chance ? 2048 : 1024));
    };
    for (const Color color : {Color{0.6f, 0.7f, 0.8f}, Color{0, 0, 0}}) {
        const Mean mean = show(color, textured);
        for (const int way : {plain, by_chance}) {
            const Mean other = show(color, way);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(mean.value[c], other.value[c], 4 * std::hypot(mean.error[c], other.error[c]))
                    << color.r << " " << way << " " << c;
        }
        for (int c = 0; c < 3; ++c) EXPECT_GT(mean.value[c], 40 * mean.error[c]) << color.r << " " << c;
    }
}

/// Steps of the walk are not bounces: entering and leaving are two, and a lower limit gives black.
TEST(Subsurface, OnlySurfacesCountForTheDepth)
{
    const auto radiance = [](int depth) {
        SceneBuilder b;
        b.add(Sphere{{0, 0, 0}, 1, {}}, b.material(subsurface({1, 1, 1}, 0.1)));
        b.scene.environment = uniform_sky();
        b.camera({0, 0, 5}, {0, 0, 0}, 5);
        RenderSettings settings = small_image_settings();
        settings.max_depth = depth;
        return mean_of(render_film(b.scene, settings, 32));
    };
    EXPECT_EQ(radiance(1).value[0], 0);
    const Mean all = radiance(2);
    EXPECT_NEAR(all.value[0], 1, 4 * all.error[0] + 1e-3);
}

}  // namespace
}  // namespace fathom
