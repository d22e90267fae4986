// SPDX-License-Identifier: Apache-2.0
#include <atomic>

#include "integrate/light_tracing_scenes.h"

namespace fathom {
namespace {

using namespace test;

LightTracingTrial trial_of(const SceneDescription& description, RenderSettings settings,
                           TrialEffort effort = TrialEffort::full)
{
    Warnings warnings;
    return try_light_tracing(RenderJob(Scene::compile(description, "", warnings), settings), nullptr, effort).value();
}

/// A floor below a ball of glass and a small lamp; the camera sees the caustic only.
SceneDescription caustic_of_lamp(double radius)
{
    SeenFloor b(100, 1);
    b.add(Sphere{{0, 0.9, 0}, 0.4, {}}, b.material(dielectric()));
    b.add(Sphere{{0.1, 2, 0.1}, radius, {}}, b.material(lamp_of(float(1 / (radius * radius)))));
    return b.scene;
}

TEST(LightTrial, UsesItForCaustics)
{
    const RenderSettings settings = small_image_settings(60, 60);
    // A lamp without size lights the whole picture through the ball.
    const LightTracingTrial spot = trial_of(Room().with_smooth_objects().with(lamps()[1].second).scene, settings);
    EXPECT_GT(spot.light_paths, 0);
    EXPECT_GT(spot.missing_light, 0.01);
    const LightTracingTrial small = trial_of(caustic_of_lamp(0.03), settings);
    EXPECT_GT(small.light_paths, 0);
    EXPECT_GT(small.gain, 10);
    EXPECT_EQ(small.missing_light, 0);
    // Nothing is gained where light samples find everything.
    const LightTracingTrial room = trial_of(Room().with_rough_objects().with_lamp().scene, settings);
    EXPECT_EQ(room.light_paths, 0);
    EXPECT_EQ(room.gain, 1);
    RenderSettings without = settings;
    without.light_sampling = false;
    EXPECT_EQ(trial_of(caustic_of_lamp(0.03), without).light_paths, 0);
}

/// A quick trial finds large gains, and none where there is none.
TEST(LightTrial, AQuickOneFindsLargeGains)
{
    const RenderSettings settings = small_image_settings(60, 60);
    for (const double radius : {0.02, 0.05}) {
        const LightTracingTrial trial = trial_of(caustic_of_lamp(radius), settings, TrialEffort::quick);
        EXPECT_GT(trial.light_paths, 0) << radius;
        EXPECT_GT(trial.gain, 5) << radius;
    }
    const SceneDescription room = Room().with_rough_objects().with_lamp().scene;
    EXPECT_EQ(trial_of(room, settings, TrialEffort::quick).light_paths, 0);
    // What path tracing cannot find is that of a full trial.
    const SceneDescription spot = Room().with_smooth_objects().with(lamps()[1].second).scene;
    const double missing = trial_of(spot, settings).missing_light;
    EXPECT_NEAR(trial_of(spot, settings, TrialEffort::quick).missing_light, missing, 0.3 * missing);
}

/// The gain that a trial tells is that of images: variance times rays.
TEST(LightTrial, TellsTheGain)
{
    for (const double radius : {0.05, 0.1}) {
        const SceneDescription scene = caustic_of_lamp(radius);
        RenderSettings settings = small_image_settings(60, 60);
        const LightTracingTrial trial = trial_of(scene, settings);
        ASSERT_GT(trial.light_paths, 0);
        settings.light_paths = 1;
        const Image bright = render_film(scene, settings, 256).image(false, false);
        const auto noise = [&](double light_paths) {
            settings.light_paths = light_paths;
            const Image image = render_film(scene, settings, 256).image(false, true);
            double sum = 0;
            for (std::size_t i = 0; i < bright.layers[0].pixels.size(); ++i) {
                const double pixel = bright.layers[0].pixels[i];
                sum += double(image.find("variance")->pixels[i]) / (pixel * pixel + 1e-4);
            }
            return sum;
        };
        const double fewer = noise(0) / noise(trial.light_paths);
        // The trial divides the ratio of variances by that of times, at most four times as long per light path and
        // pixel.
        EXPECT_LT(trial.gain, 2 * fewer) << radius << " " << fewer;
        EXPECT_GT(trial.gain, fewer / (2 * (1 + 4 * trial.light_paths))) << radius;
    }
}

TEST(LightTrial, DoesNotDependOnThreads)
{
    RenderSettings settings = small_image_settings(60, 40);
    settings.threads = 1;
    const LightTracingTrial one = trial_of(caustic_of_lamp(0.1), settings);
    settings.threads = 3;
    const LightTracingTrial three = trial_of(caustic_of_lamp(0.1), settings);
    EXPECT_EQ(one.gain, three.gain);
    EXPECT_EQ(one.light_paths, three.light_paths);
    std::atomic<bool> cancel = true;
    Warnings warnings;
    EXPECT_FALSE(try_light_tracing(RenderJob(Scene::compile(caustic_of_lamp(0.1), "", warnings), settings), &cancel));
}

}  // namespace
}  // namespace fathom
