// SPDX-License-Identifier: Apache-2.0
/// Tests of the pixels that are known to see only the background.
#include <gtest/gtest.h>

#include <bit>
#include <random>

#include "compile/scene_data.h"
#include "film/film_data.h"
#include "integrate/picture_helpers.h"
#include "session/job.h"
#include "session/kernel_settings.h"

namespace fathom {
namespace {

using namespace test;

constexpr int width = 61, height = 47;

/// Small spheres and triangles around the origin: more than scenes without a BVH have.
SceneBuilder grains(unsigned seed, double spread)
{
    SceneBuilder b;
    std::mt19937 engine(seed);
    const auto chance = [&](double size) { return size * (double(engine() >> 8) * 0x1p-23 - 1); };
    const int gray = b.diffuse(0.5f, {0.1f, 0.2f, 0.3f});
    for (int i = 0; i < 200; ++i) {
        const Vec3d at{chance(spread), chance(spread), chance(spread)};
        if (i % 2)
            b.add(Sphere{at, 0.02 + std::abs(chance(0.1)), {}}, gray);
        else
            b.add(Rectangle{at, {chance(0.2), 0.01, 0}, {0, chance(0.2), 0.01}}, gray);
    }
    return b;
}

/// A job, and the settings of its kernel.
struct Prepared {
    RenderJob job;
    KernelSettings settings;

    Prepared(const SceneBuilder& b, const RenderSettings& s)
        : job(compile(b), s), settings(kernel_settings(s, FilmLayout(s)))
    {
        settings.film_words = std::size_t(FilmLayout(s).words);
    }
    static Scene compile(const SceneBuilder& b)
    {
        Warnings warnings;
        return Scene::compile(b.scene, "", warnings);
    }
    std::vector<std::uint32_t> seen() const
    {
        return pixels_with_surfaces(*job.scene().data().kernel, job.data().camera_record, settings);
    }
    /// Sums of all pixels, and the number of camera rays.
    std::pair<std::vector<std::uint32_t>, std::uint64_t> render(const std::uint32_t* seen_pixels) const
    {
        KernelSettings with = settings;
        with.seen_pixels = seen_pixels;
        std::vector<std::uint32_t> pixels;
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) pixels.push_back(y << 16 | x);
        TileSums sums;
        sums.reset(pixels.size(), with.film_words);
        KernelCounters counters;
        render_job(*job.scene().data().kernel, job.data().camera_record, with,
                   {pixels.data(), std::uint32_t(pixels.size()), 3, 16}, sums, counters);
        std::vector<std::uint32_t> words(pixels.size() * with.film_words);
        const FilmLayout layout(job.settings());
        for (std::uint32_t i = 0; i < pixels.size(); ++i)
            sums.add_to(i, &words[i * with.film_words], layout.sums, layout.ids);
        return {words, counters.costs.rays[std::size_t(RayKind::camera)]};
    }
};

RenderSettings settings_of(Filter filter, double radius, Color background)
{
    RenderSettings s = small_image_settings(width, height);
    s.filter = filter;
    s.filter_radius = radius;
    s.background = background;
    s.alpha = true;
    s.aovs = {Aov::depth, Aov::material_id};
    return s;
}

/// Sums have the same bits whether or not the rays of pixels without surfaces are traced: for cameras from afar, close
/// up, among the grains, with a shifted image and without perspective, and for narrow and wide filters.
TEST(SeenPixels, DoNotChangeTheImage)
{
    int saved = 0;
    for (unsigned round = 0; round < 24; ++round) {
        SceneBuilder b = grains(round, round % 3 == 0 ? 1 : 0.3);
        const double distance = std::array{4., 1.5, 0.05, 300.}[round % 4];
        b.camera({distance, 0.1 * distance, 0.3 * distance}, {0, 0, 0}, std::array{40., 70., 90., 0.3}[round % 4]);
        Camera& camera = b.scene.cameras[0];
        if (round % 5 == 1) camera.kind = CameraKind::orthographic, camera.height = 3;
        if (round % 5 == 2) camera.shift_x = 0.3, camera.shift_y = -0.2;
        const RenderSettings s =
            settings_of(Filter(round % 4), round % 2 ? 0 : 2.5, round % 2 ? Color{0, 0, 0} : Color{0.5f, 2, 0});
        const Prepared with(b, s);
        const std::vector<std::uint32_t> seen = with.seen();
        if (seen.empty()) continue;
        ++saved;
        const auto [all, all_rays] = with.render(nullptr);
        const auto [some, some_rays] = with.render(seen.data());
        EXPECT_EQ(all, some) << round;
        EXPECT_LT(some_rays, all_rays) << round;
    }
    EXPECT_GE(saved, 12);
}

/// Only pixels near a small object are traced.
TEST(SeenPixels, AreFew)
{
    SceneBuilder b = grains(1, 0.05);
    b.camera({0, 0, 10}, {0, 0, 0});
    const std::vector<std::uint32_t> seen = Prepared(b, settings_of(Filter::box, 0, {0, 0, 0})).seen();
    int count = 0;
    for (std::uint32_t word : seen) count += std::popcount(word);
    EXPECT_GT(count, 1);
    EXPECT_LT(count, 80);
}

/// All pixels are traced where rays that meet nothing may bring something, or the pixel of a ray isn't known.
TEST(SeenPixels, AreUnknownWhereRaysAreNotSimple)
{
    const auto is_known = [](const SceneBuilder& b, const RenderSettings& s) { return !Prepared(b, s).seen().empty(); };
    const RenderSettings plain = settings_of(Filter::box, 0, {0, 0, 0});
    SceneBuilder b = grains(1, 0.1);
    b.camera({0, 0, 10}, {0, 0, 0});
    EXPECT_TRUE(is_known(b, plain));
    RenderSettings open = plain;
    open.background.reset();
    EXPECT_TRUE(is_known(b, open));
    b.scene.environment = uniform_sky();
    EXPECT_TRUE(is_known(b, plain));
    EXPECT_FALSE(is_known(b, open));
    SceneBuilder blurred = b;
    blurred.scene.cameras[0].aperture = 0.1;
    EXPECT_FALSE(is_known(blurred, plain));
    SceneBuilder round = b;
    round.scene.cameras[0].kind = CameraKind::spherical;
    EXPECT_FALSE(is_known(round, plain));
    SceneBuilder moving = b;
    moving.add(Sphere{{0, 0, 0}, 0.1, Vec3d{0.1, 0, 0}}, 0);
    moving.scene.cameras[0].shutter_close = 1;
    EXPECT_FALSE(is_known(moving, plain));
    // A camera inside glass, whose only surface is above and behind it.
    SceneBuilder inside = b;
    Material glass;
    glass.kind = MaterialKind::glass;
    glass.interior.attenuation_color = {0.5f, 0.5f, 0.5f};
    glass.interior.attenuation_distance = 2;
    inside.add(Rectangle{{-2, 2, 12}, {4, 0, 0}, {0, 0, -1.5}}, inside.material(glass));
    EXPECT_FALSE(is_known(inside, plain));
    // A floor that reaches beside the camera fills the image.
    SceneBuilder floor = b;
    floor.add(Rectangle{{-50, -1, 50}, {100, 0, 0}, {0, 0, -100}}, 0);
    EXPECT_FALSE(is_known(floor, plain));
}

}  // namespace
}  // namespace fathom
