// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include <algorithm>

#include "fathom/error.h"
#include "fathom/image_error.h"
#include "fathom/render.h"
#include "support/film_contents.h"

namespace fathom {
namespace {

/// A scene of emissive surfaces in front of nothing or a sky. kind: only quads, with spheres, or with many surfaces.
SceneDescription scene_of(int kind, float radiance)
{
    SceneDescription d;
    Material m;
    m.kind = MaterialKind::none;
    m.emission.radiance.value = {radiance, 2 * radiance, 3 * radiance};
    m.emission.two_sided = true;
    d.materials = {m, {}};
    Node node;
    node.shapes.push_back({Rectangle{{-100, -100, -5}, {200, 0, 0}, {0, 200, 0}}, 0, ""});
    for (int i = 0; i < (kind == 0 ? 0 : kind == 1 ? 1 : 100); ++i)
        node.shapes.push_back({Sphere{{0.1 * i, 0, 40}, 0.02, {}}, 1, ""});
    node.camera = 0;
    d.nodes.push_back(node);
    d.roots = {0};
    d.cameras.emplace_back();
    return d;
}

Image rendered(const SceneDescription& d, const RenderSettings& settings, SampleRange range)
{
    Warnings warnings;
    const RenderJob job(Scene::compile(d, "", warnings), settings);
    Film film(job);
    EXPECT_TRUE(render(job, range, film));
    return film.image(settings.alpha, true);
}

/// Every pixel gets the requested number of samples for any size, range and number of threads: a uniform emitter is
/// uniform to the last bit, also if it is too bright for the fast sums.
TEST(Render, EveryPixelGetsEverySampleOnce)
{
    for (int kind = 0; kind < 3; ++kind)
        for (const float radiance : {0.375f, 100.f, 3000.f})
            for (const auto& [width, height] : {std::pair{1, 1}, {7, 5}, {33, 17}, {130, 3}})
                for (const SampleRange& range : {SampleRange{0, 1}, {3, 8}, {1000, 1013}}) {
                    RenderSettings settings;
                    settings.width = width, settings.height = height;
                    settings.filter = Filter::box;
                    settings.threads = 3;
                    settings.alpha = true;
                    const Image image = rendered(scene_of(kind, radiance), settings, range);
                    for (std::size_t i = 0; i < std::size_t(width * height); ++i) {
                        for (std::size_t c = 0; c < 3; ++c) {
                            ASSERT_EQ(image.layers[0].pixels[4 * i + c], radiance * float(c + 1)) << kind << " " << i;
                            // Only rounding of a difference of doubles remains in the variance.
                            ASSERT_LE(image.find("variance")->pixels[3 * i + c], 1e-14f * radiance * radiance * 9);
                        }
                        ASSERT_EQ(image.layers[0].pixels[4 * i + 3], 1);
                    }
                }
}

/// A floor under a sky of two colors, whose noise distinguishes samples.
SceneDescription noisy(int kind)
{
    SceneDescription d = scene_of(kind, 0);
    d.nodes[0].shapes[0].material = 1;
    d.environment.kind = EnvironmentKind::gradient;
    return d;
}

TEST(Render, RefusesSamplesThatTheFilmHas)
{
    RenderSettings settings;
    settings.width = 7, settings.height = 5;
    Warnings warnings;
    const RenderJob job(Scene::compile(scene_of(1, 1), "", warnings), settings);
    Film film(job);
    EXPECT_TRUE(render(job, {4, 8}, film));
    const Film before = test::copy_of(film);
    EXPECT_THROW(render(job, {0, 5}, film), Error);
    EXPECT_THROW(render(job, {7, 20}, film), Error);
    EXPECT_THROW(render(job, {3, 2}, film), Error);
    EXPECT_EQ(test::words_of(film), test::words_of(before));
    EXPECT_EQ(film.samples(), before.samples());
    EXPECT_TRUE(render(job, {0, 4}, film));
}

/// Probes add sums of their own and change nothing else, and don't depend on threads, passes and the crop.
TEST(Render, ErrorProbesChangeNoPixel)
{
    for (int kind = 0; kind < 3; ++kind) {
        RenderSettings settings;
        settings.width = 70, settings.height = 40;
        settings.alpha = true;
        const Image without = rendered(noisy(kind), settings, {0, 8});
        settings.error_probes = true;
        const Image with = rendered(noisy(kind), settings, {0, 8});
        EXPECT_EQ(with.layers[0].pixels, without.layers[0].pixels);
        EXPECT_EQ(with.find("variance")->pixels, without.find("variance")->pixels);

        settings.crop = Crop{3, 5, 65, 38};
        Warnings warnings;
        const Scene scene = Scene::compile(noisy(kind), "", warnings);
        settings.threads = 1;
        Film whole(RenderJob(scene, settings));
        render(RenderJob(scene, settings), {0, 8}, whole);
        settings.threads = 3;
        Film parts(RenderJob(scene, settings));
        render(RenderJob(scene, settings), {5, 8}, parts);
        const std::atomic<bool> cancel = false;
        render_pass(RenderJob(scene, settings), {0, 5}, parts, cancel);
        EXPECT_EQ(test::words_of(whole), test::words_of(parts));
    }
}

/// The interval of the estimated error contains the difference from a reference about as often as it should.
TEST(Render, ErrorOfTheImageIsInItsInterval)
{
    for (int kind = 1; kind < 3; ++kind) {
        RenderSettings settings;
        settings.width = 128, settings.height = 96;
        settings.error_probes = true;
        const std::vector<float> reference = rendered(noisy(kind), settings, {100000, 100600}).layers[0].pixels;
        Warnings warnings;
        const Scene scene = Scene::compile(noisy(kind), "", warnings);
        int inside = 0;
        constexpr int images = 20;
        for (int i = 0; i < images; ++i) {
            settings.seed = std::uint32_t(1 + i);
            const RenderJob job(scene, settings);
            Film film(job);
            render(job, {0, 4}, film);
            const std::vector<float> pixels = film.beauty(false).layers[0].pixels;
            double squares = 0;
            for (std::size_t k = 0; k < pixels.size(); ++k) {
                const double r = double(reference[k]), d = double(pixels[k]) - r;
                squares += d * d / (r * r + 0.01);
            }
            const double error = std::sqrt(squares / double(pixels.size()));
            const ImageError estimate = estimate_error(film).value();
            inside += estimate.low <= error && error <= estimate.high;
            EXPECT_NEAR(estimate.error, error, 0.25 * error);
        }
        EXPECT_GE(inside, 16) << kind;
    }
}

TEST(Render, AnotherSeedIsOtherNoise)
{
    for (int kind = 0; kind < 3; ++kind) {
        RenderSettings settings;
        settings.width = 16, settings.height = 16;
        const Image a = rendered(noisy(kind), settings, {0, 4});
        EXPECT_EQ(a.layers[0].pixels, rendered(noisy(kind), settings, {0, 4}).layers[0].pixels);
        settings.seed = 1;
        const Image b = rendered(noisy(kind), settings, {0, 4});
        int same = 0;
        for (std::size_t i = 0; i < 256; ++i) same += a.layers[0].pixels[3 * i] == b.layers[0].pixels[3 * i];
        EXPECT_LT(same, 5) << kind;
    }
}

/// Each sample depends on its own index and pixel; no two are equal.
TEST(Render, SamplesAndPixelsDiffer)
{
    for (int kind = 0; kind < 3; ++kind) {
        RenderSettings settings;
        settings.width = 8, settings.height = 8;
        std::vector<float> seen;
        for (std::uint64_t sample = 0; sample < 8; ++sample) {
            const Image image = rendered(noisy(kind), settings, {sample, sample + 1});
            for (std::size_t i = 0; i < 64; ++i) seen.push_back(image.layers[0].pixels[3 * i]);
        }
        std::sort(seen.begin(), seen.end());
        // A few pairs may be equal by chance.
        EXPECT_GE(std::unique(seen.begin(), seen.end()) - seen.begin(), 508) << kind;
    }
}

/// Mean and variance agree with single samples rendered one at a time.
TEST(Render, MeanAndVarianceOfItsSamples)
{
    Warnings warnings;
    const Scene scene = Scene::compile(noisy(1), "", warnings);
    RenderSettings settings;
    settings.width = 9, settings.height = 7;
    const RenderJob job(scene, settings);
    Film film(job);
    render(job, {5, 25}, film);
    const Image image = film.image(false, true);
    for (const auto& [x, y] : {std::pair{0, 0}, {8, 6}, {3, 2}}) {
        double sum = 0, squares = 0;
        for (std::uint64_t s = 5; s < 25; ++s) {
            const double v = double(render_sample(job, x, y, s).g);
            sum += v, squares += v * v;
        }
        const std::size_t i = std::size_t(3 * (y * 9 + x) + 1);
        const double mean = sum / 20;
        EXPECT_NEAR(image.layers[0].pixels[i], mean, 1e-6);
        // The variance of the mean is that of the samples over n - 1.
        EXPECT_NEAR(image.find("variance")->pixels[i] / ((squares / 20 - mean * mean) / 19), 1, 1e-4);
    }
}

/// Progress reports the total and the finished work, up to the end.
TEST(Render, TellsItsProgress)
{
    Warnings warnings;
    const Scene scene = Scene::compile(noisy(0), "", warnings);
    RenderSettings settings;
    settings.width = 20, settings.height = 10;
    settings.crop = Crop{2, 3, 7, 9};
    const RenderJob job(scene, settings);
    Film film(job);
    Progress last;
    render(job, {0, 3000}, film, nullptr, [&](const Progress& p, const Film& f) {
        EXPECT_GT(p.samples_done, last.samples_done);
        EXPECT_EQ(p.samples_done, f.samples_per_pixel() * 5 * 6);
        EXPECT_EQ(p.samples_total, 3000u * 5 * 6);
        last = p;
    });
    EXPECT_EQ(last.samples_done, last.samples_total);
    EXPECT_GE(last.costs.all_rays(), last.samples_total);
    std::atomic<bool> cancel = true;
    Film other(job);
    EXPECT_FALSE(render(job, {0, 10}, other, &cancel));
    EXPECT_EQ(other.samples_per_pixel(), 0u);
}

/// A floor fills the image and a light is behind the camera: each sample has one camera ray, a vertex, an unoccluded
/// shadow ray and a bounce.
TEST(Render, CountsRaysAndVertices)
{
    for (int kind = 0; kind < 3; ++kind) {
        SceneDescription d = scene_of(kind, 1);
        d.nodes[0].shapes[0].material = 1;
        d.nodes[0].shapes.push_back({Rectangle{{-1, -1, 30}, {2, 0, 0}, {0, 2, 0}}, 0, ""});
        Warnings warnings;
        RenderSettings settings;
        settings.width = 33, settings.height = 21;
        settings.max_depth = 1;
        settings.measure_stages = true;
        const RenderJob job(Scene::compile(d, "", warnings), settings);
        Film film(job);
        RenderCosts costs;
        render(job, {0, 50}, film, nullptr, [&](const Progress& p, const Film&) { costs = p.costs; });
        constexpr std::uint64_t samples = 33 * 21 * 50;
        for (std::size_t i = 0; i < ray_kind_count; ++i) EXPECT_EQ(costs.rays[i], samples) << kind << " " << i;
        EXPECT_EQ(costs.vertices, samples) << kind;
        EXPECT_EQ(costs.light_samples, samples) << kind;
        EXPECT_EQ(costs.clear_shadow_rays, samples) << kind;
        EXPECT_GE(costs.shaded_lanes, samples);
        EXPECT_EQ(costs.shaded_lanes % std::uint64_t(simd_width()), 0u);
    }
}

/// Time is attributed to the stages that a scene has, and measured only on request.
TEST(Render, TimesItsStages)
{
    for (const bool measure : {false, true}) {
        Warnings warnings;
        RenderSettings settings;
        settings.width = 64, settings.height = 48;
        settings.measure_stages = measure;
        const RenderJob job(Scene::compile(noisy(2), "", warnings), settings);
        Film film(job);
        RenderCosts costs;
        render(job, {0, 20}, film, nullptr, [&](const Progress& p, const Film&) { costs = p.costs; });
        using S = RenderStage;
        for (const S stage :
             {S::camera, S::trace, S::arrival, S::sort, S::surface, S::material, S::light, S::scatter, S::film})
            EXPECT_EQ(costs.seconds[std::size_t(stage)] > 0, measure) << int(stage);
    }
}

/// max_depth 0 shows emission only, 1 adds direct illumination, in each kind of scene.
TEST(Render, DepthIsCountedFromTheCamera)
{
    for (int kind = 0; kind < 3; ++kind) {
        SceneDescription d = scene_of(kind, 1);
        d.materials[0].kind = MaterialKind::diffuse;
        d.materials[0].base_color.value = {0.5f, 0.5f, 0.5f};
        d.environment.kind = EnvironmentKind::constant;
        d.environment.color = {2, 2, 2};
        RenderSettings settings;
        settings.width = settings.height = 8;
        for (const auto& [depth, expected] : {std::pair{0, 1.0f}, {1, 2.0f}, {2, 2.0f}, {-1, 2.0f}}) {
            settings.max_depth = depth;
            const Image image = rendered(d, settings, {0, 16});
            EXPECT_NEAR(image.layers[0].pixels[3 * 27], expected, 2e-2) << kind << " " << depth;
        }
    }
}

}  // namespace
}  // namespace fathom
