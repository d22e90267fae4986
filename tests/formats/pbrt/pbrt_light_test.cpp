// SPDX-License-Identifier: Apache-2.0
// Tests of lights in pbrt files.
#include <fmt/format.h>
#include <cmath>

#include "pbrt_fixture.h"

namespace fathom::test {
namespace {

// --------------------------------------------------------------------------------------------------- lights

TEST_F(Pbrt, LightsHaveTheirUnits)
{
    SceneDescription scene = world(R"(LightSource "point" "rgb I" [ 1 2 3 ] "float scale" 2 "point3 from" [ 0 1 0 ])");
    expect_color(scene.lights.at(0).intensity, 2, 4, 6);
    expect_near(origin(scene, 0), {0, 1, 0});
    scene = world("LightSource \"point\" \"float power\" 12.566370614");
    expect_color(scene.lights.at(0).intensity, 1, 1, 1);
    scene = world("LightSource \"distant\" \"point3 from\" [ 0 5 0 ] \"point3 to\" [ 0 0 0 ] \"float illuminance\" 3");
    expect_color(scene.lights.at(0).intensity, 3, 3, 3);
    expect_near(scene.nodes.at(0).parent_from_node.vector({0, 0, -1}), {0, -1, 0});
    scene = world("LightSource \"spot\" \"float coneangle\" 40 \"float conedeltaangle\" 10");
    EXPECT_NEAR(scene.lights.at(0).outer_angle, 40 * degree, 1e-9);
    EXPECT_NEAR(scene.lights.at(0).inner_angle, 30 * degree, 1e-9);
    EXPECT_EQ(scene.lights.at(0).falloff, SpotFalloff::smooth);
    // The default cone has 30 degrees with a falloff over the last 5.
    scene = world("LightSource \"spot\"");
    EXPECT_NEAR(scene.lights.at(0).outer_angle, 30 * degree, 1e-9);
    EXPECT_NEAR(scene.lights.at(0).inner_angle, 25 * degree, 1e-9);
}

/// pbrt's image orientation: projections look along +z with x right and y up; goniometric maps exchange y and z, so the
/// center is +z, the right +x and the bottom +y.
TEST_F(Pbrt, LightsWithPictures)
{
    write("p.png", "x");
    SceneDescription scene = world(R"(LightSource "projection" "string filename" "p.png" "float scale" 3 "float fov" 60
Translate 1 2 3 LightSource "goniometric" "string filename" "p.png" "rgb I" [ 1 2 3 ] "float scale" 2)");
    EXPECT_TRUE(warnings_.counts().empty());
    const Light &projection = scene.lights.at(0), &goniometric = scene.lights.at(1);
    EXPECT_EQ(projection.kind, LightKind::projector);
    expect_color(projection.intensity, 3, 3, 3);
    EXPECT_NEAR(projection.fov, 60 * degree, 1e-12);
    EXPECT_EQ(projection.fov_axis, FovAxis::smaller);
    EXPECT_FALSE(projection.flat_field);
    EXPECT_FALSE(projection.intensity_is_flux);
    EXPECT_TRUE(projection.picture.nearest);
    EXPECT_EQ(scene.images.at(std::size_t(projection.picture.image)).name, "p.png");
    const Transform& p = scene.nodes.at(0).parent_from_node;
    expect_near(p.vector({0, 0, -1}), {0, 0, 1});
    expect_near(p.vector({1, 0, 0}), {1, 0, 0});
    expect_near(p.vector({0, 1, 0}), {0, 1, 0});
    EXPECT_EQ(goniometric.kind, LightKind::goniometric);
    expect_color(goniometric.intensity, 2, 4, 6);
    const Transform& g = scene.nodes.at(1).parent_from_node;
    expect_near(g.point({0, 0, 0}), {1, 2, 3});
    expect_near(g.vector({0, 0, -1}), {0, 1, 0});
    expect_near(g.vector({1, 0, 0}), {1, 0, 0});
    expect_near(g.vector({0, -1, 0}), {0, 0, 1});

    scene = world(R"(LightSource "projection" "string filename" "p.png" "float scale" 2 "float power" 30
LightSource "goniometric" "string filename" "p.png" "float power" 40)");
    for (const Light& light : scene.lights) EXPECT_TRUE(light.intensity_is_flux);
    expect_color(scene.lights.at(0).intensity, 60, 60, 60);
    expect_color(scene.lights.at(1).intensity, 40, 40, 40);
    EXPECT_EQ(world("LightSource \"goniometric\"").lights.at(0).kind, LightKind::point);
    EXPECT_NE(error("LightSource \"projection\"").find("it needs a 'filename'"), std::string::npos);
    EXPECT_NE(error("LightSource \"projection\" \"string filename\" \"p.png\" \"float fov\" 180").find("'fov'"),
              std::string::npos);
    world("LightSource \"projection\" \"string filename\" \"p.png\" \"point3 from\" [ 1 2 3 ]");
    EXPECT_TRUE(has_warning("the parameter 'from' is ignored"));
}

TEST_F(Pbrt, SpectraOfLightHaveALuminanceOfOne)
{
    for (const char* spectrum :
         {"\"blackbody I\" 3000", "\"spectrum I\" [ 300 5 900 5 ]", "\"spectrum I\" \"stdillum-A\""}) {
        const Color c = world(std::string("LightSource \"point\" ") + spectrum).lights.at(0).intensity;
        EXPECT_NEAR(0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b, 1, 1e-4) << spectrum;
        EXPECT_GT(c.r, c.b) << spectrum;
    }
    expect_color(world("LightSource \"point\" \"spectrum I\" \"stdillum-D65\"").lights.at(0).intensity, 1, 1, 1, 2e-3);
}

TEST_F(Pbrt, ShapesShine)
{
    const SceneDescription scene =
        world(R"(AreaLightSource "diffuse" "rgb L" [ 1 2 3 ] "float scale" 2 "bool twosided" true
Shape "sphere")");
    expect_color(material_of(scene).emission.radiance.value, 2, 4, 6);
    EXPECT_TRUE(material_of(scene).emission.two_sided);
    const Material given = material("AreaLightSource \"diffuse\" \"float power\" 100");
    EXPECT_NEAR(given.emission.radiance.value.g, 100 / (4 * std::numbers::pi * std::numbers::pi), 1e-4);
}

/// In pbrt, an area light with alpha 0 illuminates but is invisible (DiffuseAreaLight, DeltaPosition).
TEST_F(Pbrt, InvisibleLamps)
{
    const std::string lamp = "AreaLightSource \"diffuse\" \"rgb L\" [ 1 2 3 ] ";
    const auto shape = [&](const std::string& text) { return material_of(world(text)); };
    EXPECT_TRUE(shape(lamp + "Shape \"sphere\" \"float alpha\" 0").visibility.invisible_light);
    expect_color(shape(lamp + "Shape \"sphere\" \"float alpha\" 0").emission.radiance.value, 1, 2, 3);
    EXPECT_TRUE(shape("Texture \"no\" \"float\" \"constant\" \"float value\" 0 " + lamp +
                      "Shape \"sphere\" \"texture alpha\" \"no\"")
                    .visibility.invisible_light);
    // An area light with a constant or textured alpha above 0 emits in proportion to its alpha.
    const Material half = shape(lamp + "Shape \"sphere\" \"float alpha\" 0.5");
    EXPECT_FALSE(half.visibility.invisible_light);
    EXPECT_EQ(half.opacity.alpha.value, 0.5f);
    expect_color(half.emission.radiance.value, 1, 2, 3);
    EXPECT_FALSE(shape("Texture \"t\" \"float\" \"checkerboard\" " + lamp + "Shape \"sphere\" \"texture alpha\" \"t\"")
                     .visibility.invisible_light);
    const Material nothing = shape("Shape \"sphere\" \"float alpha\" 0");
    EXPECT_FALSE(nothing.visibility.invisible_light);
    EXPECT_EQ(nothing.opacity.alpha.value, 0);
}

TEST_F(Pbrt, EnvironmentsAreConstantOrPictures)
{
    SceneDescription scene =
        world("LightSource \"infinite\" \"rgb L\" [ 1 2 3 ] LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]");
    EXPECT_EQ(scene.environment.kind, EnvironmentKind::constant);
    expect_color(scene.environment.color, 2, 3, 4);
    expect_color(world("LightSource \"infinite\" \"float illuminance\" 6.2831853").environment.color, 2, 2, 2);
    scene = world("Rotate 90 0 1 0 LightSource \"infinite\" \"string filename\" \"a.exr\" \"float scale\" 3");
    EXPECT_EQ(scene.environment.kind, EnvironmentKind::equal_area);
    expect_color(scene.environment.color, 3, 3, 3);
    expect_near(scene.environment.world_from_environment.vector({0, 0, 1}), {1, 0, 0}, 1e-9);
    EXPECT_EQ(scene.environment.illuminance, 0);
    // pbrt doubles the given illuminance, see light.cpp.
    EXPECT_EQ(world("LightSource \"infinite\" \"string filename\" \"a.exr\" \"float illuminance\" 50")
                  .environment.illuminance,
              100);
}

}  // namespace
}  // namespace fathom::test
