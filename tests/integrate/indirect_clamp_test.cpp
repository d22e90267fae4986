// SPDX-License-Identifier: Apache-2.0
/// Tests of RenderSettings::clamp_indirect, sample by sample, against unclamped samples.
#include "general_loop.h"
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

/// A gray room, open in front, with a small strong light. All light is gray, so clamping channels and clamping sums
/// agree.
SceneBuilder room()
{
    SceneBuilder b;
    const int wall = b.diffuse(0.75f), lamp = b.diffuse(0, {60, 60, 60});
    b.add(Rectangle{{-1, -1, 1}, {2, 0, 0}, {0, 0, -2}}, wall);
    b.add(Rectangle{{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}}, wall);
    b.add(Rectangle{{-1, -1, -1}, {2, 0, 0}, {0, 2, 0}}, wall);
    b.add(Rectangle{{-1, -1, 1}, {0, 0, -2}, {0, 2, 0}}, wall);
    b.add(Rectangle{{1, -1, -1}, {0, 0, 2}, {0, 2, 0}}, wall);
    b.add(Rectangle{{-0.2, 0.9, -0.2}, {0.3, 0, 0}, {0, 0, 0.3}}, lamp);
    b.camera({0.2, 0.1, 3.4}, {0, 0, 0});
    return b;
}

/// The room with a glass sphere, whose caustic makes fireflies.
SceneBuilder room_with_glass()
{
    SceneBuilder b = room();
    Material glass;
    glass.kind = MaterialKind::glass;
    b.add(Sphere{{0, -0.4, 0}, 0.4, {}}, b.material(glass));
    return b;
}

/// The room with enough spheres to need a BVH.
SceneBuilder room_with_a_tree()
{
    SceneBuilder b = room_with_glass();
    const int gray = b.diffuse(0.5f);
    for (int i = 0; i < 100; ++i) b.add(Sphere{{-0.9 + 0.018 * i, -0.95, 0.5}, 0.03, {}}, gray);
    return b;
}

/// Radiance of a sample: the total, and the part with at most one surface between camera and light.
struct Parts {
    double all, direct;
};

class SamplesOf {
public:
    SamplesOf(const SceneDescription& description, RenderSettings settings)
        : scene_([&] {
              Warnings warnings;
              Scene scene = Scene::compile(description, "", warnings);
              // The quad loop does not clamp and uses other random numbers.
              force_general_loop(scene);
              return scene;
          }()),
          all_(scene_, settings),
          direct_(scene_, [&] {
              settings.max_depth = 1;
              return settings;
          }())
    {
    }
    Parts at(int x, int y, std::uint64_t sample) const
    {
        return {render_sample(all_, x, y, sample).g, render_sample(direct_, x, y, sample).g};
    }

private:
    Scene scene_;
    RenderJob all_, direct_;
};

/// Expects that each clamped sample is its direct light plus the limited indirect part.
void expect_limited(const SceneDescription& description, RenderSettings settings, float limit, std::uint64_t samples)
{
    const SamplesOf free(description, settings);
    settings.clamp_indirect = limit;
    const SamplesOf clamped(description, settings);
    int cut = 0, kept = 0, direct = 0;
    for (int y = 0; y < settings.height; y += 2)
        for (int x = 0; x < settings.width; x += 2)
            for (std::uint64_t sample = 0; sample < samples; ++sample) {
                const Parts a = free.at(x, y, sample), b = clamped.at(x, y, sample);
                ASSERT_EQ(a.direct, b.direct) << x << "," << y << " sample " << sample;
                const double indirect = a.all - a.direct, expected = a.direct + std::min(indirect, double(limit));
                // The sums of floats have different orders.
                ASSERT_NEAR(b.all, expected, 1e-5 * (a.all + limit)) << x << "," << y << " sample " << sample;
                ++(indirect > limit ? cut : kept);
                direct += a.direct > limit;
            }
    // Enough samples were clamped for the test to be meaningful.
    EXPECT_GT(cut, 20);
    EXPECT_GT(kept, 20);
    EXPECT_GT(direct, 20);
}

TEST(IndirectClamp, LimitsIndirectLightInEachLoop)
{
    for (const bool light_sampling : {true, false}) {
        SCOPED_TRACE(light_sampling);
        RenderSettings settings = small_image_settings();
        settings.light_sampling = light_sampling;
        // Few paths hit the light by BSDF sampling.
        const std::uint64_t samples = light_sampling ? 8 : 160;
        expect_limited(room().scene, settings, 0.25f, samples);
        expect_limited(room_with_glass().scene, settings, 0.25f, samples);
        expect_limited(room_with_a_tree().scene, settings, 0.25f, samples);
    }
}

TEST(IndirectClamp, RoomsOfQuadsAreLimitedToo)
{
    const double unlimited = mean_of(render_film(room().scene, small_image_settings(), 64)).value[1];
    RenderSettings settings = small_image_settings();
    settings.clamp_indirect = 0.1f;
    const Film film = render_film(room().scene, settings, 64);
    settings.max_depth = 1;
    const Mean direct = mean_of(render_film(room().scene, settings, 64)), all = mean_of(film);
    EXPECT_LT(all.value[1], direct.value[1] + 0.1);
    EXPECT_LT(all.value[1], 0.95 * unlimited);
    EXPECT_GT(all.value[1], direct.value[1]);
}

TEST(IndirectClamp, FarAboveAllLightChangesNoBit)
{
    RenderSettings settings = small_image_settings(), limited = settings;
    limited.clamp_indirect = 1e20f;
    const SceneDescription scene = room_with_a_tree().scene;
    EXPECT_EQ(render_film(scene, settings, 16).image(false, true).layers[0].pixels,
              render_film(scene, limited, 16).image(false, true).layers[0].pixels);
}

/// Caustic noise of few samples, which gives a warning, disappears with clamping.
TEST(IndirectClamp, RemovesReportedFireflies)
{
    RenderSettings settings = small_image_settings(64, 48);
    const SceneDescription scene = room_with_glass().scene;
    const Film::Fireflies before = render_film(scene, settings, 64).fireflies();
    settings.clamp_indirect = 1;
    const Film::Fireflies after = render_film(scene, settings, 64).fireflies();
    EXPECT_GT(before.noise, 0.2);
    EXPECT_LT(before.samples, 0.01);
    EXPECT_LT(after.noise, 0.25 * before.noise);
}

}  // namespace
}  // namespace fathom
