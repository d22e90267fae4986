// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fathom/lighting.h"
#include "seen_from.h"

// Tests of the ground below models: it looks like the backdrop where it is unoccluded, and shows shadows elsewhere.
namespace fathom {
namespace {

constexpr int across = 64;

/// A model on the plane y = 0 and a camera that looks down at it.
class GroundTest : public ::testing::Test {
protected:
    SceneDescription d = test::model_viewed_from({0, 6, 12});
    Warnings warnings;

    void add_sheet() { d.nodes[0].shapes.push_back({Rectangle{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}}, 0, ""}); }
    void add_box() { d.nodes[0].shapes.push_back({Box{{-1, 0, -1}, {1, 2, 1}}, 0, ""}); }
    void add_lamp(Vec3d place)
    {
        Node node;
        node.parent_from_node = Transform::translate(place);
        node.light = 0;
        d.lights.emplace_back();
        d.lights[0].kind = LightKind::point;
        d.lights[0].intensity = {1000, 1000, 1000};
        d.roots.push_back(int(d.nodes.size()));
        d.nodes.push_back(node);
    }
    LitScene lit(const std::optional<Ground>& ground, LightingMode light = LightingMode::automatic)
    {
        return compile_lit(d, "", light, 1, warnings, BvhQuality::standard, ground);
    }
    Image picture(const Ground& ground, std::uint64_t samples = 64)
    {
        const LitScene scene = lit(ground);
        EXPECT_TRUE(scene.ground);
        RenderSettings settings;
        settings.width = settings.height = across;
        settings.filter = Filter::box;
        settings.background = ground.backdrop;
        const RenderJob job(scene.scene, settings);
        Film film(job);
        render(job, {0, samples}, film);
        return film.image(false, false);
    }
    /// Intersection of a pixel's center ray with y = 0, or nothing above the horizon.
    std::optional<Vec3d> place(int x, int y) const
    {
        const Camera& c = d.cameras[0];
        const Vec3d forward = normalize(c.look_at - c.position), right = normalize(cross(forward, c.up));
        const double t = std::tan(c.fov_y / 2);
        const Vec3d ray = forward + ((x + 0.5) / across * 2 - 1) * t * right -
                          ((y + 0.5) / across * 2 - 1) * t * cross(right, forward);
        if (ray.y >= 0) return {};
        return c.position + (-c.position.y / ray.y) * ray;
    }
    struct Mean {
        double value = 0, error = 0;
        int count = 0;
    };
    /// Mean and standard error of one channel over the ground pixels that `which` selects.
    template <class Which>
    Mean mean(const Image& image, int channel, const Which& which) const
    {
        double sum = 0, squares = 0;
        int count = 0;
        for (int y = 0; y < across; ++y)
            for (int x = 0; x < across; ++x) {
                const std::optional<Vec3d> p = place(x, y);
                if (!p || !which(*p)) continue;
                const double v = image.find("")->pixels[std::size_t(3 * (y * across + x) + channel)];
                sum += v, squares += v * v, ++count;
            }
        const double m = sum / count;
        return {m, std::sqrt(std::max(0.0, squares / count - m * m) / count), count};
    }
};

double beside(const Vec3d& p)
{
    return std::max(std::abs(p.x), std::abs(p.z));
}

/// A flat model casts no shadow, so the whole ground matches the backdrop, also where it fades out; beyond it the bits
/// are unchanged. The brightest backdrops exceed what a floor can reflect.
TEST_F(GroundTest, MatchesTheBackdropWhereUnoccluded)
{
    add_sheet();
    d.cameras[0].position = {0, 2, 4};
    for (const Color& backdrop : {studio_backdrop, Color{0.1f, 0.3f, 0.6f}, Color{1, 0.9f, 1.3f}}) {
        Ground ground;
        ground.backdrop = backdrop;
        const Image image = picture(ground, 256);
        const float wanted[] = {backdrop.r, backdrop.g, backdrop.b};
        for (int c = 0; c < 3; ++c) {
            const Mean near = mean(image, c, [](const Vec3d& p) { return beside(p) > 1.1 && length(p) < 1.35; });
            const Mean fading = mean(image, c, [](const Vec3d& p) { return length(p) > 1.6 && length(p) < 2.6; });
            ASSERT_GT(near.count, 50);
            ASSERT_GT(fading.count, 200);
            EXPECT_LT(near.error, 0.003 * wanted[c]);
            EXPECT_NEAR(near.value, wanted[c], 0.01 * wanted[c]);
            EXPECT_NEAR(fading.value, wanted[c], 0.01 * wanted[c]);
            const Mean beyond = mean(image, c, [](const Vec3d& p) { return length(p) > 3.2; });
            ASSERT_GT(beyond.count, 20);
            EXPECT_NEAR(beyond.value, wanted[c], 1e-7);
            EXPECT_LT(beyond.error, 1e-7);
        }
    }
}

/// The key light is at the front left, so a shadow lies to the right behind the box, darkest at its base. In front of
/// the box only indirect light is missing, because the box is black.
TEST_F(GroundTest, CatchesTheShadow)
{
    add_box();
    d.materials[0].base_color.value = {0, 0, 0};
    const Image image = picture({}, 64);
    const auto right = [&](double from, double to) {
        return mean(image, 1, [&](const Vec3d& p) { return p.x > from && p.x < to && std::abs(p.z) < 0.8; });
    };
    const double tone = studio_backdrop.g;
    EXPECT_LT(right(1.1, 1.5).value, 0.75 * tone);
    EXPECT_LT(right(1.1, 1.5).value, right(2.5, 3.5).value - 0.02);
    const Mean left = mean(image, 1, [](const Vec3d& p) { return p.x < -2.5 && p.x > -3.5 && std::abs(p.z) < 1; });
    EXPECT_NEAR(left.value, tone, 0.12 * tone);
    EXPECT_LT(left.value, tone);
}

/// Twice the reflectance doubles the brightness where the ground is unobstructed.
TEST_F(GroundTest, HasTheRequestedColor)
{
    add_sheet();
    d.cameras[0].position = {0, 2, 4};
    Ground ground;
    ground.color = Color{0.8f, 0.4f, 0.2f};
    const Image image = picture(ground, 64);
    double value[3];
    for (int c = 0; c < 3; ++c)
        value[c] = mean(image, c, [](const Vec3d& p) { return beside(p) > 1.1 && length(p) < 1.35; }).value;
    EXPECT_NEAR(value[1], value[0] / 2, 1e-3);
    EXPECT_NEAR(value[2], value[0] / 4, 1e-3);
    EXPECT_GT(value[0], 0.4);
}

TEST_F(GroundTest, IsOnlyAddedWhereItFits)
{
    add_box();
    const SceneDescription model = d;
    EXPECT_FALSE(lit({}).ground);
    const LitScene added = lit(Ground());
    EXPECT_TRUE(added.ground);
    ASSERT_EQ(added.added.size(), 2u);
    EXPECT_NE(added.added[1].find("--ground none"), std::string::npos);
    EXPECT_TRUE(lit(Ground(), LightingMode::studio).ground);
    EXPECT_FALSE(lit(Ground(), LightingMode::file).ground);
    // The ground is not added for a camera inside a room or below the ground.
    d.cameras[0].position = {0, 1, 0.5};
    EXPECT_FALSE(lit(Ground()).ground);
    d.cameras[0].position = {0, -1, 9};
    EXPECT_FALSE(lit(Ground()).ground);
    d = model;
    d.hints.own_light = true;
    EXPECT_FALSE(lit(Ground()).ground);
    // A light outside the view would illuminate the ground.
    d = model;
    add_lamp({0, 1, -1.5});
    EXPECT_TRUE(lit(Ground()).studio);
    EXPECT_FALSE(lit(Ground()).ground);
    d = model;
    add_lamp({0, 5, 5});
    EXPECT_FALSE(lit(Ground()).ground);
    Ground wanted;
    wanted.only_if_visible_from_above = false;
    EXPECT_TRUE(lit(wanted).ground);
    // Exposure depends on the model only.
    ASSERT_TRUE(lit({}).exposure_ev);
    EXPECT_EQ(lit(wanted).exposure_ev, lit({}).exposure_ev);
    EXPECT_EQ(lit(wanted).added, lit({}).added);
}

/// The ground is below everything at all times of the shot, not only at the first frame.
TEST_F(GroundTest, LiesBelowAllGeometry)
{
    add_box();
    const auto height = [&](const Ground& ground) {
        EditableScene edit(d);
        compile_lit(edit, LightingMode::automatic, 1, warnings, ground);
        return edit.description().nodes.back().parent_from_node.point({0, 0, 0}).y;
    };
    Ground ground;
    EXPECT_NEAR(height(ground), 0, 1e-3);
    EXPECT_LT(height(ground), 0);
    ground.bounds = Bounds{{-1, -3, -1}, {1, 2, 1}, false};
    EXPECT_NEAR(height(ground), -3, 1e-3);
}

}  // namespace
}  // namespace fathom
