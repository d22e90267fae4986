// SPDX-License-Identifier: Apache-2.0
// Tests of emitters in Mitsuba files.
#include <fmt/format.h>
#include <cmath>

#include "formats/common/spectra.h"
#include "mitsuba_fixture.h"

namespace fathom::test {
namespace {

// ------------------------------------------------------------------------------------------------- emitters

TEST_F(Mitsuba, Emitters)
{
    const SceneDescription scene =
        read(R"(<emitter type="point"><rgb name="intensity" value="1 2 3"/><point name="position" x="1" y="2" z="3"/>
</emitter><emitter type="spot"><float name="cutoff_angle" value="40"/><transform name="to_world"><lookat origin="0,5,0" target="0,0,0" up="1,0,0"/>
</transform></emitter><emitter type="directional"><vector name="direction" x="0" y="-1" z="0"/><rgb name="irradiance" value="7"/></emitter>
<shape type="sphere"><emitter type="area"><rgb name="radiance" value="4 5 6"/></emitter></shape>)");
    const auto node_of = [&](int light) {
        for (const Node& node : scene.nodes)
            if (node.light == light) return node;
        return Node();
    };
    expect_near(node_of(0).parent_from_node.point({0, 0, 0}), {1, 2, 3});
    expect_color(scene.lights.at(0).intensity, 1, 2, 3);
    // Lights emit along -z of their node.
    expect_near(node_of(1).parent_from_node.vector({0, 0, -1}), {0, -1, 0});
    EXPECT_NEAR(scene.lights.at(1).outer_angle, 40 * degree, 1e-12);
    EXPECT_NEAR(scene.lights.at(1).inner_angle, 30 * degree, 1e-12);
    EXPECT_EQ(scene.lights.at(1).falloff, SpotFalloff::linear);
    expect_near(normalize(node_of(2).parent_from_node.vector({0, 0, -1})), {0, -1, 0});
    expect_color(scene.lights.at(2).intensity, 7, 7, 7);
    expect_color(material_of(scene).emission.radiance.value, 4, 5, 6);
    // A shape without a BSDF only emits.
    expect_color(material_of(scene).base_color.value, 0, 0, 0);
}

/// Parallel light from the whole shape along its normal; the shape itself is visible but not emissive.
TEST_F(Mitsuba, DirectionalArea)
{
    const SceneDescription scene = read(
        R"(<shape type="rectangle"><transform name="to_world"><scale x="2" y="3"/><rotate y="1" angle="90"/><translate x="5"/></transform>
<emitter type="directionalarea"><rgb name="radiance" value="1 2 3"/></emitter></shape>
<shape type="disk"><boolean name="flip_normals" value="true"/><emitter type="directionalarea"/></shape>
<shape type="sphere"><emitter type="directionalarea"/></shape>)");
    ASSERT_EQ(scene.lights.size(), 2u);
    for (const Light& light : scene.lights) EXPECT_EQ(light.kind, LightKind::beam);
    expect_color(scene.lights[0].intensity, 1, 2, 3);
    EXPECT_EQ(scene.lights[0].width, 2);
    EXPECT_FALSE(scene.lights[0].round);
    EXPECT_TRUE(scene.lights[1].round);
    const auto place_of = [&](int light) {
        for (const Node& node : scene.nodes)
            for (const int child : node.children)
                if (scene.nodes[std::size_t(child)].light == light)
                    return node.parent_from_node * scene.nodes[std::size_t(child)].parent_from_node;
        return Transform();
    };
    expect_near(normalize(place_of(0).vector({0, 0, -1})), {1, 0, 0});
    expect_near(place_of(0).point({1, 1, 0}), {5, 3, -2});
    expect_near(place_of(1).vector({0, 0, -1}), {0, 0, -1});
    expect_color(material_of(scene).emission.radiance.value, 0, 0, 0);
    EXPECT_TRUE(has_warning("on rectangles and disks only"));
}

/// A projector's image is upright when looking along +z with +y up; a spot light's texture is rotated by 180 degrees.
TEST_F(Mitsuba, EmittersWithPictures)
{
    write("p.png", "x");
    SceneDescription scene =
        read(R"(<emitter type="projector"><float name="scale" value="2"/><float name="fov" value="50"/>
<string name="fov_axis" value="larger"/><texture type="bitmap" name="irradiance"><string name="filename" value="p.png"/><boolean name="raw" value="true"/>
<string name="filter_type" value="nearest"/></texture><transform name="to_world"><translate x="1" y="2" z="3"/></transform></emitter>
<emitter type="spot"><float name="cutoff_angle" value="30"/><texture type="bitmap" name="texture"><string name="filename" value="p.png"/></texture></emitter>
<emitter type="projector"><rgb name="irradiance" value="1 2 3"/></emitter>)");
    EXPECT_TRUE(warnings_.counts().empty());
    const Light& projector = scene.lights.at(0);
    EXPECT_EQ(projector.kind, LightKind::projector);
    expect_color(projector.intensity, 2 * std::numbers::pi, 2 * std::numbers::pi, 2 * std::numbers::pi, 1e-5);
    EXPECT_NEAR(projector.fov, 50 * degree, 1e-12);
    EXPECT_EQ(projector.fov_axis, FovAxis::larger);
    EXPECT_TRUE(projector.flat_field);
    EXPECT_EQ(scene.images.at(std::size_t(projector.picture.image)).name, "p.png");
    EXPECT_EQ(projector.picture.color_space, ColorSpace::linear);
    EXPECT_TRUE(projector.picture.nearest);
    const Transform& t = scene.nodes.at(0).parent_from_node;
    expect_near(t.point({0, 0, 0}), {1, 2, 3});
    expect_near(t.vector({0, 0, -1}), {0, 0, 1});
    expect_near(t.vector({1, 0, 0}), {-1, 0, 0});
    expect_near(t.vector({0, 1, 0}), {0, 1, 0});
    const Light& spot = scene.lights.at(1);
    EXPECT_EQ(spot.kind, LightKind::spot);
    EXPECT_EQ(spot.picture.image, projector.picture.image);
    EXPECT_EQ(spot.picture.color_space, ColorSpace::srgb);
    const Transform& s = scene.nodes.at(1).parent_from_node;
    expect_near(s.vector({0, 0, -1}), {0, 0, 1});
    expect_near(s.vector({1, 0, 0}), {1, 0, 0});
    expect_near(s.vector({0, 1, 0}), {0, -1, 0});
    // The image is white and spans the diagonal of 35 mm film.
    const Light& plain = scene.lights.at(2);
    EXPECT_EQ(plain.picture.image, -1);
    expect_color(plain.intensity, std::numbers::pi, 2 * std::numbers::pi, 3 * std::numbers::pi, 1e-5);
    EXPECT_NEAR(plain.fov, 2 * std::atan(std::hypot(18, 12) / 50), 1e-12);
    EXPECT_EQ(plain.fov_axis, FovAxis::diagonal);

    scene = read(R"(<emitter type="spot"><texture type="checkerboard" name="texture"/></emitter>)");
    EXPECT_EQ(scene.lights.at(0).picture.image, -1);
    EXPECT_TRUE(has_warning("a light's image must be a bitmap"));
    EXPECT_NE(error(R"(<emitter type="projector"><float name="fov" value="180"/></emitter>)").find("'fov' must be"),
              std::string::npos);
    EXPECT_NE(error(R"(<emitter type="projector"><string name="focal_length" value="-3mm"/></emitter>)")
                  .find("'focal_length'"),
              std::string::npos);
}

/// The image's center is at +z, the part right of it towards -x.
TEST_F(Mitsuba, EnvironmentMaps)
{
    write("e.exr", "x");
    const SceneDescription scene = read(
        R"(<emitter type="envmap"><string name="filename" value="e.exr"/><float name="scale" value="2"/></emitter>)");
    const Transform& t = scene.environment.world_from_environment;
    expect_near(t.vector({1, 0, 0}), {0, 0, 1});
    expect_near(t.vector({0, 0, 1}), {-1, 0, 0});
    expect_near(t.vector({0, 1, 0}), {0, 1, 0});
    EXPECT_EQ(scene.environment.color.g, 2);
}

/// Directions are those of Mitsuba 3.9.1 to 0.2 degrees: +x is south, +y west, +z up.
TEST_F(Mitsuba, SunByDate)
{
    const auto sun = [&](const std::string& inside) {
        const SceneDescription scene = read("<emitter type=\"sky\">" + inside + "</emitter>");
        return scene.environment.world_from_environment.vector(scene.environment.to_sun);
    };
    expect_near(sun(""), {0.0513854, 0.691748, 0.720308}, 4e-3);
    expect_near(sun(R"(<float name="hour" value="9"/>)"), {0.0956952, -0.614786, 0.782867}, 4e-3);
}

/// The sun's irradiance was measured in Mitsuba's images of a plane, between the elevations and turbidities of the
/// table.
TEST_F(Mitsuba, SunOfSunsky)
{
    struct Case {
        double turbidity, height_deg, red, green, blue;
    };
    for (const Case& c : {Case{3, 24.63, 1.3405, 1.0237, 0.6367}, Case{6.5, 6, 0.3161, 0.1474, 0.0331},
                          Case{1, 1, 0.4837, 0.1379, 0}}) {
        const double e = c.height_deg * degree;
        const SceneDescription scene = read(fmt::format(
            R"(<emitter type="sunsky"><vector name="sun_direction" x="{}" y="0" z="{}"/><float name="turbidity" value="{}"/></emitter>)",
            std::cos(e), std::sin(e), c.turbidity));
        const Color sun = scene.lights.at(0).intensity;
        EXPECT_NEAR(sun.r, c.red, 3e-3 * c.red);
        EXPECT_NEAR(sun.g, c.green, 3e-3 * c.green);
        EXPECT_NEAR(sun.b, c.blue, 3e-3 * c.blue + 1e-9);
    }
}

TEST_F(Mitsuba, SkyWithItsSun)
{
    const SceneDescription scene =
        read(R"(<emitter type="sunsky"><transform name="to_world"><rotate x="1" angle="-90"/></transform>
<vector name="sun_direction" x="0.6" y="0.8" z="0"/><float name="sun_scale" value="2"/><float name="sun_aperture" value="3"/>
<float name="sky_scale" value="4"/><float name="albedo" value="0.25"/></emitter>)");
    EXPECT_EQ(scene.environment.kind, EnvironmentKind::hosek_wilkie);
    EXPECT_EQ(scene.environment.turbidity, 3);
    EXPECT_EQ(scene.environment.ground_albedo, 0.25);
    EXPECT_EQ(scene.environment.color.g, 4);
    const Transform& t = scene.environment.world_from_environment;
    expect_near(t.vector({0, 1, 0}), {0, 1, 0}, 1e-9);
    expect_near(t.vector(scene.environment.to_sun), {0.6, 0.8, 0}, 1e-9);
    const Light& sun = scene.lights.at(0);
    EXPECT_NEAR(sun.angle, 3 * degree, 1e-12);
    // Irradiance of Mitsuba 3.9.1 at turbidity 3 and this elevation, which lies between the table's entries.
    expect_color(sun.intensity, 2 * 1.4865, 2 * 1.2360, 2 * 0.9364, 0.02);
    for (const Node& node : scene.nodes)
        if (node.light == 0) expect_near(normalize(node.parent_from_node.vector({0, 0, -1})), {-0.6, -0.8, 0}, 1e-9);
}

/// Colors are those of Mitsuba 3.9.1's `llvm_ad_rgb` variant.
TEST(MitsubaSpectra, AsColors)
{
    const std::vector<SpectrumPoint> points = {{400, 0.1}, {500, 0.5}, {600, 0.9}, {700, 0.3}};
    expect_color(color_of_surface(points), 0.854797, 0.68754, 0.265015, 0.02);
    expect_color(color_of_light(points), 0.999234, 0.6597, 0.229444, 0.02);
    expect_color(color_of_light({{300, 2}, {900, 2}}), 2.40959, 1.89658, 1.81783, 0.03);
    expect_color(color_of_surface({{300, 0.5}, {900, 0.5}}), 0.5, 0.5, 0.5, 1e-3);
    const Color warm = color_of_black_body(3000), cold = color_of_black_body(9000);
    EXPECT_GT(warm.r, 2 * warm.b);
    EXPECT_GT(cold.b, cold.r);
}

}  // namespace
}  // namespace fathom::test
