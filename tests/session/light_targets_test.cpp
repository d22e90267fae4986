// SPDX-License-Identifier: Apache-2.0
#include "session/light_targets.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "compile/scene_data.h"
#include "integrate/light_tracing_scenes.h"
#include "session/guiding.h"
#include "session/job.h"
#include "session/trial_image.h"

namespace fathom {
namespace {

using namespace test;

/// A large floor with a small ball of glass on it, which the camera sees from close by.
SceneDescription small_ball(int spheres = 0)
{
    SeenFloor b(spheres, 4);
    b.add(Sphere{{0.1, 0.2, 0.1}, 0.15, {}}, b.material(dielectric()));
    b.scene.cameras[0].kind = CameraKind::orthographic;
    return b.scene;
}

KernelSettings kernel_settings()
{
    KernelSettings s;
    s.width = 64, s.height = 64;
    return s;
}

struct Compiled {
    explicit Compiled(const SceneDescription& description)
        : job(Scene::compile(description, "", warnings), small_image_settings(64, 64))
    {
    }
    std::unique_ptr<const LightTargets> learn(const std::atomic<bool>* cancel = nullptr, bool gathers = false) const
    {
        return learn_light_targets(*job.scene().data().kernel, *job.scene().data().tables, job.data().camera_record,
                                   kernel_settings(), gathers, cancel);
    }
    /// Second moment of what light paths bring, per pixel, with or without targets.
    double noise(const LightTargets* targets) const
    {
        TrialImage image(kernel_settings());
        image.settings.light_targets = targets;
        const LightSamples samples =
            trace_light_samples(*job.scene().data().kernel, job.data().camera_record, image, 5, 16, {}, nullptr);
        double sum = 0;
        for (const LightPathResults& results : samples.jobs)
            for (const LightSplat& splat : results.splats) sum += std::pow(brightness(splat.value), 2);
        return sum;
    }

    Warnings warnings;
    RenderJob job;
};

Light light_of(LightKind kind, float intensity)
{
    Light l;
    l.kind = kind;
    l.intensity = {intensity, intensity, intensity};
    return l;
}

/// Lights of three kinds far from the ball are aimed at it, with less than a fifth of the noise.
TEST(LightTargets, LieAtWhatMakesCaustics)
{
    for (const int spheres : {0, 100}) {
        SceneDescription scenes[] = {small_ball(spheres), small_ball(spheres), small_ball(spheres)};
        const auto add = [](SceneDescription& scene, const Light& l) {
            SceneBuilder b;
            b.scene = scene;
            b.light(l, Transform::translate({1, 3, 0.5}) * rotate_to({-0.3, -1, -0.15}));
            scene = b.scene;
        };
        add(scenes[0], light_of(LightKind::point, 50));
        add(scenes[1], light_of(LightKind::directional, 3));
        SceneBuilder lamp;
        lamp.scene = scenes[2];
        lamp.add(Rectangle{{1, 3, 0.5}, {0.3, 0, 0}, {0, 0, 0.3}}, lamp.material(lamp_of(300)));
        scenes[2] = lamp.scene;
        for (const SceneDescription& scene : scenes) {
            const Compiled compiled(scene);
            const std::unique_ptr<const LightTargets> targets = compiled.learn();
            ASSERT_TRUE(targets);
            const LightTargets::Target& t = targets->targets[0];
            const SceneTables& tables = *compiled.job.scene().data().tables;
            const auto ball = std::max_element(tables.spheres.begin(), tables.spheres.end(),
                                               [](const auto& a, const auto& b) { return a.radius < b.radius; });
            const double scale = tables.render_scale;
            EXPECT_LT(
                std::hypot(t.center[0] - ball->center.x, t.center[1] - ball->center.y, t.center[2] - ball->center.z),
                0.15 * scale);
            EXPECT_LT(t.radius, 0.5 * scale);
            EXPECT_LT(compiled.noise(targets.get()), 0.2 * compiled.noise(nullptr));
        }
    }
}

/// Lights that share the work by their use: one that is hidden from the ball gets only what its power brings it.
TEST(LightTargets, SelectLightsThatReachThem)
{
    SceneBuilder b;
    b.scene = small_ball();
    const Light lamp = light_of(LightKind::point, 50);
    b.light(lamp, Transform::translate({1, 3, 0.5}));
    b.light(lamp, Transform::translate({-3, 1, 0}));
    b.add(Rectangle{{-1, 0, -4}, {0, 3, 0}, {0, 0, 8}}, b.diffuse(0));
    const Compiled compiled(b.scene);
    const std::unique_ptr<const LightTargets> targets = compiled.learn();
    ASSERT_TRUE(targets);
    const float most = *std::max_element(targets->light_ratios.begin(), targets->light_ratios.begin() + 2),
                least = *std::min_element(targets->light_ratios.begin(), targets->light_ratios.begin() + 2);
    EXPECT_NEAR(most, 1.5, 0.02);
    EXPECT_NEAR(least, 0.5, 0.02);
}

/// Caustics on a floor that is seen through glass only: no connection to the camera shows them, but photons do.
TEST(LightTargets, LieWherePhotonsAreSeen)
{
    SeenFloor b(1, 20);
    b.add(Box{{-0.7, 0.2, -0.7}, {0.7, 0.3, 0.7}}, b.material(dielectric()));
    b.scene.cameras[0].position = {0, 2, 0};
    b.light(light_of(LightKind::directional, 3), rotate_to({0.2, -1, 0.1}));
    const Compiled compiled(b.scene);
    EXPECT_FALSE(compiled.learn());
    const std::unique_ptr<const LightTargets> targets = compiled.learn(nullptr, true);
    ASSERT_TRUE(targets);
    const double scale = compiled.job.scene().data().tables->render_scale;
    for (const LightTargets::Target& t : targets->targets) EXPECT_LT(t.radius, 2 * scale);
    EXPECT_LT(targets->own_share, 0.5f);
}

/// A beam cannot be aimed, and nothing is aimed at in a room that light samples light well.
TEST(LightTargets, AreNotUsedWhereTheyDoNotHelp)
{
    const Compiled room(Room().with_rough_objects().with_lamp().scene);
    EXPECT_FALSE(room.learn());
    SceneBuilder b;
    b.scene = small_ball();
    Light beam = light_of(LightKind::beam, 4);
    b.light(beam, Transform::translate({0.1, 4, 0.1}) * rotate_to({0, -1, 0}));
    EXPECT_FALSE(Compiled(b.scene).learn());
}

TEST(LightTargets, CanBeCancelled)
{
    SceneBuilder b;
    b.scene = small_ball();
    b.light(light_of(LightKind::point, 50), Transform::translate({2, 5, 1}));
    const std::atomic<bool> cancel = true;
    EXPECT_THROW(Compiled(b.scene).learn(&cancel), Cancelled);
}

}  // namespace
}  // namespace fathom
