// SPDX-License-Identifier: Apache-2.0
/// Tests of lights, lenses and textures against closed forms, one at a time, so that any factor of two shows.
#include "image/pictures.h"
#include "picture_helpers.h"
#include "scene/parameters.h"

namespace fathom {
namespace {

using namespace test;

using std::numbers::pi;

TEST(ClosedForm, PointLightsAtDistancesAndAngles)
{
    for (double height : {0.3, 2.0, 40.0, 3000.0})
        for (double angle : {0.0, 0.7, 1.4}) {
            SceneBuilder b = floor_scene(0.5f, 0.1);
            b.scene.cameras[0].position.y = 0.1;
            Light light;
            const float intensity = float(7 * height * height);
            light.intensity = {intensity, intensity, intensity};
            b.light(light, Transform::translate({height * std::tan(angle), height, 0}));
            SCOPED_TRACE(std::to_string(height) + " " + std::to_string(angle));
            expect_mean(render_film(b.scene, small_image_settings(4, 4), 4),
                        0.5 / pi * 7 * std::pow(std::cos(angle), 3), 0.002);
        }
}

TEST(ClosedForm, DirectionalLightsAtAngles)
{
    for (double disk : {0.0, 1e-3, 0.3})
        for (double angle : {0.0, 0.7, 1.4}) {
            SceneBuilder b = floor_scene(0.5f, 0.1);
            Light light;
            light.kind = LightKind::directional;
            light.intensity = {7, 7, 7};
            light.angle = disk;
            b.light(light, Transform::rotate({0, 0, 1}, angle) * Transform::rotate({1, 0, 0}, -pi / 2));
            SCOPED_TRACE(std::to_string(disk) + " " + std::to_string(angle));
            // Irradiance is that at normal incidence times the cosine, which is exact while the disk is above the
            // horizon.
            expect_mean(render_film(b.scene, small_image_settings(8, 8), 256), 0.5 / pi * 7 * std::cos(angle), 0.004);
        }
}

/// E = pi L sin^2(a) cos for a sphere of half angle a, and E = pi L r^2 / (r^2 + h^2) for a disk directly above.
TEST(ClosedForm, BallsAndDisksAtDistances)
{
    for (bool light_sampling : {true, false})
        for (double distance : {1.5, 4.0, 10.0}) {
            RenderSettings settings = small_image_settings(8, 8);
            settings.light_sampling = light_sampling;
            const std::uint64_t samples = light_sampling ? 256 : 8192;
            SceneBuilder ball = floor_scene(0.5f, 0.1);
            ball.scene.cameras[0].position = {0.2, 0.1, 0.1};
            const double angle = 0.5;
            ball.add(Sphere{{distance * std::sin(angle), distance * std::cos(angle), 0}, 1, {}},
                     ball.diffuse(0, {3, 3, 3}));
            SCOPED_TRACE(std::to_string(light_sampling) + " " + std::to_string(distance));
            expect_mean(render_film(ball.scene, settings, samples), 0.5 * 3 / (distance * distance) * std::cos(angle),
                        0.004);
            SceneBuilder disk = floor_scene(0.5f, 0.1);
            disk.scene.cameras[0].position = {0.2, 0.1, 0.1};
            disk.add(Disk{{0, distance, 0}, {0, -1, 0}, 1}, disk.diffuse(0, {3, 3, 3}));
            expect_mean(render_film(disk.scene, settings, samples), 0.5 * 3 / (1 + distance * distance), 0.004);
        }
}

/// An environment of w x h pixels is interpolated bilinearly; its irradiance is integrated numerically.
void expect_irradiance(int w, int h)
{
    SCOPED_TRACE(std::to_string(w) + "x" + std::to_string(h));
    const TemporaryFolder folder;
    Image image = make_test_image(w, h);
    for (int c = 0; c < 3; ++c) image.layers[0].pixels[std::size_t((1 * w + 5) * 3 + c)] = 20;  // a bright sun pixel
    write_image(folder.path() / "sky.exr", image, {});
    const auto texel = [&](int x, int y, int c) {
        return double(image.layers[0].pixels[std::size_t((std::clamp(y, 0, h - 1) * w + (x % w + w) % w) * 3 + c)]);
    };
    const auto radiance = [&](Vec3d d, int c) {
        const double x = (std::atan2(d.z, d.x) / (2 * pi) + 0.5) * w - 0.5, y = std::acos(d.y) / pi * h - 0.5;
        const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
        const double fx = x - x0, fy = y - y0;
        return (texel(x0, y0, c) * (1 - fx) + texel(x0 + 1, y0, c) * fx) * (1 - fy) +
               (texel(x0, y0 + 1, c) * (1 - fx) + texel(x0 + 1, y0 + 1, c) * fx) * fy;
    };
    // The rotation distinguishes the image's axes.
    const Transform turn = Transform::rotate({1, 2, 0.5}, 0.6);
    double expected[3] = {};
    constexpr int n = 1000;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            // Directions are cosine-weighted, from points of the unit disk.
            const double r = std::sqrt((i + 0.5) / n), phi = 2 * pi * (j + 0.5) / n;
            const Vec3d d = turn.inverse().vector({r * std::cos(phi), std::sqrt(1 - r * r), r * std::sin(phi)});
            for (int c = 0; c < 3; ++c) expected[c] += radiance(d, c) / (n * n);
        }
    for (bool light_sampling : {true, false}) {
        SceneBuilder b = floor_scene(0.5f, 0.1);
        b.scene.images.push_back({"sky", folder.path() / "sky.exr", {}});
        b.scene.environment.kind = EnvironmentKind::image;
        b.scene.environment.image = 0;
        b.scene.environment.world_from_environment = turn;
        RenderSettings settings = small_image_settings(8, 8);
        settings.light_sampling = light_sampling;
        const Mean mean = mean_of(render_film(b.scene, settings, 4096));
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(mean.value[c], 0.5 * expected[c], 4 * mean.error[c] + 1e-4 * expected[c])
                << light_sampling << " channel " << c;
    }
}

TEST(ClosedForm, EnvironmentImages)
{
    expect_irradiance(8, 4);
    expect_irradiance(400, 200);  // larger than the inner caches, so texels are prefetched
}

/// An environment with a given illuminance in lux has it for any image: on a surface that faces the image's top, or its
/// center in mappings with equal solid angles. The color scales it.
TEST(ClosedForm, IlluminanceOfPictures)
{
    for (const bool equal_area : {false, true}) {
        const int w = 64, h = equal_area ? 64 : 32;
        const TemporaryFolder folder;
        Image image = make_test_image(w, h);
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                float* const pixel = &image.layers[0].pixels[std::size_t(y * w + x) * 3];
                pixel[0] = float(0.3 + 0.2 * std::sin(0.2 * x)), pixel[1] = float(1 + 0.5 * std::cos(0.2 * y)),
                pixel[2] = 0.1f;
            }
        write_image(folder.path() / "sky.exr", image, {});
        SceneBuilder b = floor_scene(0.5f, 0.1);
        b.scene.images.push_back({"sky", folder.path() / "sky.exr", {}});
        b.scene.environment.kind = equal_area ? EnvironmentKind::equal_area : EnvironmentKind::image;
        b.scene.environment.image = 0;
        b.scene.environment.illuminance = 700;
        b.scene.environment.color = {2, 2, 2};
        if (equal_area) b.scene.environment.world_from_environment = Transform::rotate({1, 0, 0}, -pi / 2);
        const Mean mean = mean_of(render_film(b.scene, small_image_settings(8, 8), 1024));
        const double luminance = 0.2126 * mean.value[0] + 0.7152 * mean.value[1] + 0.0722 * mean.value[2];
        EXPECT_NEAR(luminance, 0.5 / pi * 1400, 0.005 * 0.5 / pi * 1400) << equal_area;
    }
}

/// The blurred edge between black and white gives the fraction of each pixel's circle of confusion that lies beyond the
/// edge. In focus the circle is a point.
TEST(ClosedForm, LensAndFocus)
{
    constexpr double aperture = 0.2, distance = 3;
    constexpr int width = 40;
    for (const auto kind : {CameraKind::perspective, CameraKind::orthographic})
        for (const double focus : {0.0, 3.0, 2.0, 6.0}) {
            SceneBuilder b;
            b.add(Rectangle{{0, -50, -distance}, {50, 0, 0}, {0, 100, 0}}, b.diffuse(0, {1, 1, 1}));
            b.camera({0, 0, 0}, {0, 0, -4});
            Camera& camera = b.scene.cameras[0];
            camera.kind = kind;
            camera.height = 0.4;
            camera.fov_y = 2 * std::atan(0.2 / distance);
            camera.aperture = aperture;
            camera.focus_distance = focus;
            const double in_focus = focus > 0 ? focus : 4;  // by default the point that the camera looks at is in focus
            const double radius = aperture / 2 * std::abs(distance - in_focus) / in_focus;
            const Image image = render_film(b.scene, small_image_settings(width, width), 256).image(false, false);
            for (int x = 0; x < width; ++x) {
                double expected = 0;
                constexpr int parts = 50;
                for (int k = 0; k < parts; ++k) {
                    const double at = ((x + (k + 0.5) / parts) / width - 0.5) * 0.4;
                    const double s = radius > 0 ? std::clamp(at / radius, -1.0, 1.0) : at > 0 ? 1 : -1;
                    expected += (0.5 + (s * std::sqrt(1 - s * s) + std::asin(s)) / pi) / parts;
                }
                double mean = 0;
                for (int y = 0; y < width; ++y)
                    mean += image.layers[0].pixels[std::size_t(3 * (y * width + x))] / width;
                EXPECT_NEAR(mean, expected, 0.01) << int(kind) << " " << focus << " " << x;
            }
        }
}

/// A parameter from one texture channel equals that channel's value.
TEST(ClosedForm, ChannelsOfTextures)
{
    const float in_texture[3] = {0.25f, 0.5f, 0.875f};
    Texture constant;
    constant.kind = TextureKind::checker_uv;
    constant.color_a.value = constant.color_b.value = {in_texture[0], in_texture[1], in_texture[2]};
    const auto mean = [&](const Field<Material, FloatInput>& input, bool textured, int channel) {
        SceneBuilder b;
        b.scene.textures.push_back(constant);
        Material m;
        m.kind = MaterialKind::principled;
        m.base_color.value = {0.9f, 0.5f, 0.1f};
        m.roughness.value = 0.5f, m.metallic.value = 0.5f;
        m.opacity.mode = AlphaMode::blend;
        input(m) = textured ? FloatInput{0.8f, 0, channel} : FloatInput{0.8f * in_texture[channel], -1, 0};
        b.add(Rectangle{{-2, -2, 0}, {4, 0, 0}, {0, 4, 0}}, b.material(m));
        b.point_light({50, 50, 50}, {2, 1, 2});
        b.camera({-2, -1, 2.2}, {0, 0, 0}, 20);
        return mean_of(render_film(b.scene, small_image_settings(16, 16), 16)).value[0];
    };
    for (const Field<Material, FloatInput>& input : {field<&Material::roughness>, field<&Material::metallic>,
                                                     field<&Material::opacity, &Material::Opacity::alpha>}) {
        double last = 0;
        for (int channel = 0; channel < 3; ++channel) {
            const double textured = mean(input, true, channel);
            EXPECT_NEAR(textured / mean(input, false, channel), 1, 1e-4) << channel;
            EXPECT_GT(std::abs(textured / last - 1), 0.05) << "channels show no difference";
            last = textured;
        }
    }
}

}  // namespace
}  // namespace fathom
