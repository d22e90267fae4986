// SPDX-License-Identifier: Apache-2.0
/// Tests that the quad loop, which is an optimization, has the same estimator as the general loop.
#include <random>

#include "general_loop.h"
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

/// A material with a small closure that is not plain diffuse.
Material other_material(SceneDescription& scene, std::mt19937& engine)
{
    Material m;
    const auto uniform = [&](double lo, double hi) { return lo + (hi - lo) * double(engine() >> 8) / 16777216.0; };
    m.roughness.value = engine() % 2 ? 0.f : float(uniform(0.4, 0.9));
    m.base_color.value = {float(uniform(0.3, 0.9)), float(uniform(0.3, 0.9)), float(uniform(0.3, 0.9))};
    switch (engine() % 6) {
        case 0:
            m.kind = MaterialKind::metal;
            break;
        case 1:
            m.kind = MaterialKind::plastic;
            break;
        case 2:
            m.kind = MaterialKind::fuzz_metal, m.fuzz = uniform(0.1, 0.9);
            break;
        case 3:
            m.kind = MaterialKind::glass, m.interior.thin = engine() % 3 != 0;
            break;
        case 4:
            m.kind = MaterialKind::unlit;
            break;
        default: {
            // The material is diffuse except for a bump map or a color texture.
            Texture texture;
            const bool is_bumped = m.roughness.value == 0;
            texture.kind = is_bumped ? TextureKind::fbm : TextureKind::checker_space;
            texture.scale = 9;
            scene.textures.push_back(texture);
            const int index = int(scene.textures.size()) - 1;
            if (is_bumped)
                m.bump = {0.1f, index, 0};
            else
                m.base_color.texture = index;
        }
    }
    return m;
}

/// A room with an open front, boxes and loose quads, one to three lights, and sometimes a sky. others: half of the
/// quads have other materials.
SceneDescription random_room(unsigned seed, bool others)
{
    std::mt19937 engine(seed);
    const auto uniform = [&](double lo, double hi) { return lo + (hi - lo) * double(engine() >> 8) / 16777216.0; };
    SceneBuilder b;
    const auto color = [&] {
        Material m;
        m.base_color.value = {float(uniform(0.1, 0.95)), float(uniform(0.1, 0.95)), float(uniform(0.1, 0.95))};
        if (others && engine() % 2) m = other_material(b.scene, engine);
        b.scene.materials.push_back(m);
        return int(b.scene.materials.size()) - 1;
    };
    b.add(Rectangle{{-1, -1, 1}, {2, 0, 0}, {0, 0, -2}}, color());
    b.add(Rectangle{{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}}, color());
    b.add(Rectangle{{-1, -1, -1}, {2, 0, 0}, {0, 2, 0}}, color());
    b.add(Rectangle{{-1, -1, 1}, {0, 0, -2}, {0, 2, 0}}, color());
    b.add(Rectangle{{1, -1, -1}, {0, 0, 2}, {0, 2, 0}}, color());
    for (int i = 0; i < 2 + int(seed % 3); ++i) {
        const Vec3d corner{uniform(-0.8, 0.3), uniform(-0.99, 0), uniform(-0.8, 0.3)};
        b.add(Box{corner, corner + Vec3d{uniform(0.1, 0.5), uniform(0.1, 0.6), uniform(0.1, 0.5)}}, color());
    }
    for (int i = 0; i < int(seed % 4); ++i)
        b.add(Rectangle{{uniform(-0.5, 0.5), uniform(-0.5, 0.5), uniform(-0.5, 0.5)},
                        {uniform(-0.4, 0.4), uniform(0.1, 0.4), uniform(-0.4, 0.4)},
                        {uniform(0.1, 0.4), uniform(-0.4, 0.4), uniform(-0.4, 0.4)}},
              color());
    for (int i = 0; i < 1 + int(seed % 3); ++i) {
        Material lamp;
        lamp.kind = seed % 2 ? MaterialKind::none : MaterialKind::diffuse;
        lamp.emission.radiance.value = {float(uniform(2, 9)), float(uniform(2, 9)), float(uniform(2, 9))};
        lamp.emission.two_sided = seed % 5 == 0;
        b.scene.materials.push_back(lamp);
        const double side = uniform(0.1, 0.5);
        b.add(Rectangle{{uniform(-0.9, 0.3), uniform(0.9, 0.99), uniform(-0.9, 0.3)}, {side, 0, 0}, {0, 0, side}},
              int(b.scene.materials.size()) - 1);
    }
    if (others) {
        // A thin glass pane, through which lights and the sky are visible.
        Material pane;
        pane.kind = MaterialKind::glass, pane.interior.thin = true;
        b.scene.materials.push_back(pane);
        b.add(Rectangle{{-1, -0.8, 1.1}, {1.6, 0, 0}, {0, 1.8, 0}}, int(b.scene.materials.size()) - 1);
    }
    if (seed % 3 == 0) b.scene.environment.kind = EnvironmentKind::gradient;
    b.camera({0.2, 0.1, 3.4}, {0, 0, 0});
    return b.scene;
}

/// Renders random rooms with both loops and compares them. others: see random_room().
void compare_loops(bool others)
{
    for (unsigned seed = 1; seed <= 10; ++seed) {
        SCOPED_TRACE(seed);
        Warnings warnings;
        const SceneDescription room = random_room(seed, others);
        const Scene fast = Scene::compile(room, "", warnings), general = Scene::compile(room, "", warnings);
        force_general_loop(general);
        RenderSettings settings = small_image_settings(), other_seed = settings;
        other_seed.seed = 1;
        const RenderJob jobs[] = {{fast, settings}, {general, other_seed}};
        Film films[] = {Film(jobs[0]), Film(jobs[1])};
        for (int i = 0; i < 2; ++i) render(jobs[i], {0, 256}, films[i]);
        const Image a = films[0].image(false, true), b = films[1].image(false, true);
        const auto &va = a.find("variance")->pixels, &vb = b.find("variance")->pixels;
        // All channels of a pixel share their paths, so they are tested together.
        double z2 = 0, difference = 0, error2 = 0, more_variance = 0, variance_error2 = 0;
        int n = 0;
        for (std::size_t pixel = 0; pixel < va.size(); pixel += 3) {
            double variances = 0;
            for (std::size_t i = pixel; i < pixel + 3; ++i) {
                const double d = double(a.layers[0].pixels[i]) - double(b.layers[0].pixels[i]);
                const double v = double(va[i]) + double(vb[i]);
                difference += d, error2 += 3 * v, variances += double(va[i]) - double(vb[i]);
                if (v > 0) z2 += d * d / v, ++n;
            }
            more_variance += variances, variance_error2 += variances * variances;
        }
        // Stratified samples are at least as accurate as their variance estimate, so the mean of z^2 is at most 1.
        EXPECT_LT(z2 / n, 1.1);
        EXPECT_LT(std::abs(difference), 4 * std::sqrt(error2));
        EXPECT_LT(std::abs(more_variance), 4 * std::sqrt(variance_error2));
    }
}

TEST(QuadLoop, HasTheMeanAndTheVarianceOfTheGeneralLoop)
{
    compare_loops(false);
}
TEST(QuadLoop, SoWithOtherQuads)
{
    compare_loops(true);
}

/// Paths are deferred until they fill a group of lanes: the result doesn't depend on how many samples are rendered at
/// once.
TEST(QuadLoop, PathsThatWaitStayTheSame)
{
    for (unsigned seed = 1; seed <= 10; ++seed) {
        Warnings warnings;
        const Scene scene = Scene::compile(random_room(seed, true), "", warnings);
        const RenderJob job{scene, small_image_settings()};
        Film whole(job), parts(job);
        render(job, {0, 64}, whole);
        for (const auto& [from, to] : {std::pair(0, 7), std::pair(7, 20), std::pair(20, 64)})
            render(job, {from, to}, parts);
        EXPECT_EQ(whole.image(false, false).layers[0].pixels, parts.image(false, false).layers[0].pixels) << seed;
    }
}

}  // namespace
}  // namespace fathom
