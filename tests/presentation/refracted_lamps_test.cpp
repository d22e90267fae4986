// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>

#include "fathom/lighting.h"
#include "seen_from.h"
#include "support/placed_light.h"

// Tests of the statistics about light that NEE and BSDF sampling both miss: lights without size behind smooth glass.
namespace fathom {
namespace {

/// A light at the origin of a large hollow sphere of plaster.
class RefractedLampsTest : public ::testing::Test {
protected:
    SceneDescription d = test::model_viewed_from({0, 0, 6});

    RefractedLampsTest() { d.nodes[0].shapes.push_back({Sphere{{0, 0, 0}, -20, {}}, 0, ""}); }
    void add_lamp(LightKind kind, const Transform& place = {})
    {
        Light lamp;
        lamp.kind = kind;
        lamp.inner_angle = 0.2, lamp.outer_angle = 0.3;
        lamp.width = lamp.height = 0.1;
        test::add_light(d, lamp, place);
    }
    Material& add_ball(Vec3d center, double radius)
    {
        d.nodes[0].shapes.push_back({Sphere{center, radius, {}}, int(d.materials.size()), ""});
        d.materials.emplace_back();
        d.materials.back().kind = MaterialKind::glass;
        return d.materials.back();
    }
    std::string found()
    {
        Warnings warnings;
        const LitScene lit = compile_lit(d, "", LightingMode::file, 1, warnings);
        EXPECT_TRUE(warnings.empty());
        return lit.refracted_light;
    }
    void expect_hidden(const char* what)
    {
        EXPECT_NE(found().find("1 of 1 lights without size are visible through glass only"), std::string::npos)
            << what << ": " << found();
    }
};

TEST_F(RefractedLampsTest, OfEveryKindWithinGlass)
{
    for (const LightKind kind : {LightKind::point, LightKind::spot, LightKind::beam}) {
        d = test::model_viewed_from({0, 0, 6});
        d.nodes[0].shapes.push_back({Sphere{{0, 0, 0}, -20, {}}, 0, ""});
        add_lamp(kind);
        EXPECT_EQ(found(), "");
        add_ball({0, 0, 0}, 1);
        expect_hidden("glass");
        d.materials.back().kind = MaterialKind::principled;
        d.materials.back().transmission.weight.value = 1;
        d.materials.back().base_color.value = {1, 0.9f, 0.8f};
        expect_hidden("principled");
    }
}

TEST_F(RefractedLampsTest, SmoothGlassIsNoticedInAnyLight)
{
    const auto has_glass = [&] {
        Warnings warnings;
        return compile_lit(d, "", LightingMode::file, 1, warnings).has_smooth_glass;
    };
    EXPECT_FALSE(has_glass());
    Material& ball = add_ball({0, 0, 0}, 1);
    EXPECT_TRUE(has_glass());
    ball.roughness.value = 0.2f;
    EXPECT_FALSE(has_glass());
}

/// Only directions in the spot light's cone count, so glass behind it hides nothing.
TEST_F(RefractedLampsTest, SpotsShineIntoTheirCone)
{
    add_lamp(LightKind::spot);
    add_ball({0, 0, 4}, 1);
    EXPECT_EQ(found(), "");
    // The cone is so wide that the whole sphere of directions is probed.
    d.lights.back().outer_angle = 1.4;
    EXPECT_EQ(found(), "");
    d.lights.back().outer_angle = 0.3;
    add_ball({0, 0, -4}, 2);
    expect_hidden("in front of it");
}

/// A sphere of radius 1 at distance 2 covers (1 - cos 30 degrees) / 2 of all directions.
TEST_F(RefractedLampsTest, ReportsTheFractionOfTheLight)
{
    add_lamp(LightKind::point);
    add_ball({2, 0, 0}, 1);
    EXPECT_NE(found().find("7 % of the light of lights without size falls on glass"), std::string::npos) << found();
}

TEST_F(RefractedLampsTest, DirectionsSeeTheWholeScene)
{
    d.nodes[0].shapes.clear();
    d.nodes[0].shapes.push_back({Rectangle{{-4, -4, -3}, {8, 0, 0}, {0, 8, 0}}, 0, ""});
    add_lamp(LightKind::directional);
    EXPECT_EQ(found(), "");
    // A disk of radius 1 in front of a square of side 8 covers pi / 64.
    add_ball({0, 0, 0}, 1);
    EXPECT_NE(found().find("5 % of the light"), std::string::npos) << found();
}

/// Nothing is lost with other ways of transmission, or with lights that have a size.
TEST_F(RefractedLampsTest, NoLightIsLost)
{
    add_lamp(LightKind::point);
    add_ball({0, 0, 0}, 1);
    const auto with = [&](const auto& change) {
        const SceneDescription before = d;
        change(d.materials.back());
        const std::string said = found();
        d = before;
        return said;
    };
    EXPECT_EQ(with([](Material& m) { m.interior.thin = true; }), "");
    EXPECT_EQ(with([](Material& m) { m.roughness.value = 0.2f; }), "");
    EXPECT_EQ(with([](Material& m) { m.ior = 1; }), "");
    EXPECT_EQ(with([](Material& m) { m.kind = MaterialKind::metal; }), "");
    d.roots.resize(1);
    d.nodes.resize(1);
    d.lights.clear();
    d.nodes[0].shapes.push_back({Sphere{{0, 0, 0}, 0.1, {}}, int(d.materials.size()), ""});
    d.materials.emplace_back();
    d.materials.back().emission.radiance.value = {9, 9, 9};
    EXPECT_EQ(found(), "");
}

}  // namespace
}  // namespace fathom
