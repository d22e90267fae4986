// SPDX-License-Identifier: Apache-2.0
#include "fathom/error.h"
#include "picture_helpers.h"
#include "support/film_contents.h"

namespace fathom {
namespace {

using namespace test;

SceneDescription ball()
{
    SceneBuilder b;
    b.add(Sphere{{0, 0, 0}, 1, {}}, b.diffuse(0.5f));
    b.scene.environment.kind = EnvironmentKind::gradient;
    b.camera({0, 1, 4}, {0, 0, 0});
    return b.scene;
}

Film part(const Scene& scene, const RenderSettings& settings, SampleRange range)
{
    const RenderJob job(scene, settings);
    Film film(job);
    EXPECT_TRUE(render(job, range, film));
    return film;
}

bool same(const Film& a, const Film& b)
{
    return test::words_of(a) == test::words_of(b) && a.samples() == b.samples() && a.key().text() == b.key().text();
}

TEST(Film, PartsInAnyOrderMakeTheWhole)
{
    Warnings warnings;
    const Scene scene = Scene::compile(ball(), "", warnings);
    RenderSettings settings = small_image_settings();
    settings.aovs = {Aov::albedo, Aov::depth, Aov::material_id};
    const Film whole = part(scene, settings, {0, 13});
    Film merged = part(scene, settings, {5, 13});
    merged.merge(part(scene, settings, {0, 2}));
    EXPECT_EQ(merged.samples().size(), 2u);
    EXPECT_EQ(merged.samples_per_pixel(), 10u);
    merged.merge(part(scene, settings, {2, 5}));
    EXPECT_TRUE(same(merged, whole));
    EXPECT_EQ(merged.image(false, true).layers.back().pixels, whole.image(false, true).layers.back().pixels);
}

TEST(Film, RefusesWhatDoesNotBelongTogether)
{
    Warnings warnings;
    const Scene scene = Scene::compile(ball(), "", warnings);
    const RenderSettings settings = small_image_settings();
    Film film = part(scene, settings, {0, 4});
    EXPECT_THROW(film.merge(part(scene, settings, {3, 5})), Error);
    RenderSettings other = settings;
    other.seed = 1;
    EXPECT_THROW(film.merge(part(scene, other, {4, 5})), Error);
    EXPECT_THROW(film.merge(part(scene, small_image_settings(8, 8), {4, 5})), Error);
    SceneDescription moved = ball();
    moved.cameras[0].position.x = 1;
    EXPECT_THROW(film.merge(part(Scene::compile(moved, "", warnings), settings, {4, 5})), Error);
    // The film is unchanged.
    EXPECT_TRUE(same(film, part(scene, settings, {0, 4})));
}

TEST(Film, ThreadsChangeNoBit)
{
    Warnings warnings;
    const Scene scene = Scene::compile(ball(), "", warnings);
    RenderSettings one = small_image_settings(), three = small_image_settings();
    one.threads = 1;
    three.threads = 3;
    EXPECT_TRUE(same(part(scene, one, {0, 9}), part(scene, three, {0, 9})));
}

TEST(Film, OneSampleReplayedIsTheOneInThePicture)
{
    Warnings warnings;
    const Scene scene = Scene::compile(ball(), "", warnings);
    const RenderSettings settings = small_image_settings();
    const Image image = part(scene, settings, {7, 8}).image(false, false);
    for (int x : {3, 16, 20}) {
        const Color c = render_sample(RenderJob(scene, settings), x, 11, 7);
        EXPECT_NEAR(c.r, image.layers[0].pixels[std::size_t(11 * 32 + x) * 3], 1e-10 + 1e-6 * c.r);
    }
}

TEST(Film, CropOnlyRendersItsPixels)
{
    Warnings warnings;
    const Scene scene = Scene::compile(ball(), "", warnings);
    RenderSettings settings = small_image_settings();
    const Image whole = part(scene, settings, {0, 4}).image(false, false);
    settings.crop = Crop{5, 6, 9, 20};
    const Image crop = part(scene, settings, {0, 4}).image(false, false);
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 32; ++x) {
            const bool inside = x >= 5 && x < 9 && y >= 6 && y < 20;
            const std::size_t i = std::size_t(y * 32 + x) * 3;
            EXPECT_EQ(crop.layers[0].pixels[i], inside ? whole.layers[0].pixels[i] : 0);
        }
}

TEST(Film, AlphaAndBackground)
{
    Warnings warnings;
    const Scene scene = Scene::compile(ball(), "", warnings);
    RenderSettings settings = small_image_settings();
    settings.alpha = true;
    settings.background = Color{0, 0, 0};
    const Image image = part(scene, settings, {0, 16}).image(true, false);
    ASSERT_EQ(image.layers[0].channels.size(), 4u);
    EXPECT_EQ(image.layers[0].pixels[3], 0);  // a corner pixel, transparent
    EXPECT_EQ(image.layers[0].pixels[0], 0);
    EXPECT_EQ(image.layers[0].pixels[std::size_t(12 * 32 + 16) * 4 + 3], 1);  // the sphere, illuminated by the sky
    EXPECT_GT(image.layers[0].pixels[std::size_t(12 * 32 + 16) * 4], 0.1);
}

}  // namespace
}  // namespace fathom
