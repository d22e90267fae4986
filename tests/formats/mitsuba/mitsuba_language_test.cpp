// SPDX-License-Identifier: Apache-2.0
// Tests of Mitsuba files: the language, cameras, films and integrators.
#include <fmt/format.h>
#include <array>
#include <cmath>

#include "mitsuba_fixture.h"

namespace fathom::test {
namespace {

// -------------------------------------------------------------------------------------------------------- language

TEST_F(Mitsuba, ParametersAreReplaced)
{
    const std::string xml = scene_of(R"(<default name="r" value="2"/><default name="r" value="5"/>
<shape type="sphere"><float name="radius" value="$r"/></shape><shape type="sphere"><float name="radius" value="${r}.5"/></shape>)");
    SceneDescription scene = load("a.xml", xml);
    const auto radius = [&](std::size_t i) { return std::get<Sphere>(scene.nodes.at(i).shapes.at(0).geometry).radius; };
    EXPECT_EQ(radius(0), 2);
    EXPECT_EQ(radius(1), 2.5);
    LoadOptions options;
    options.definitions = {{"r", "7"}};
    scene = load_scene(folder_ / "a.xml", options, warnings_);
    EXPECT_EQ(radius(0), 7);
    options.definitions = {{"q", "7"}};
    try {
        load_scene(folder_ / "a.xml", options, warnings_);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.place() + ": " + e.message(), "-D q: the scene has no parameter 'q'; known here: r");
    }
    EXPECT_EQ(error(R"(<shape type="sphere"><float name="radius" value="$size"/></shape>)"),
              "line 2, column 23: the parameter '$size' has no value: give one with -D size=VALUE");
}

TEST_F(Mitsuba, IncludesAndReferences)
{
    write(
        "b.xml",
        R"(<scene version="3.0.0"><bsdf type="diffuse" id="red"><rgb name="reflectance" value="1 0 0"/></bsdf></scene>)");
    const SceneDescription scene = read(R"(<include filename="b.xml"/><alias id="red" as="rot"/>
<shape type="sphere"><ref id="red"/></shape><shape type="sphere"><ref id="rot"/></shape>)");
    ASSERT_EQ(scene.materials.size(), 1u) << "one material, referred to twice";
    expect_color(scene.materials[0].base_color.value, 1, 0, 0);
    EXPECT_EQ(scene.files.size(), 2u);
    EXPECT_EQ(error(R"(<shape type="sphere"><ref id="blue"/></shape>)"),
              "line 2, column 23: no element has the id 'blue'");
    EXPECT_EQ(error(R"(<bsdf type="null" id="a"/><bsdf type="null" id="a"/>)").substr(0, 49),
              "line 2, column 28: the id 'a' is already used: " + (folder_ / "a.xml").string().substr(0, 2));
}

/// Included files are searched beside the including file, then beside the files that include it, then in the folders of
/// <path> (last one first), and finally beside the scene.
TEST_F(Mitsuba, IncludesWithinIncludes)
{
    const auto material = [&](const std::string& file, const char* color) {
        write(file,
              fmt::format(R"(<scene version="3.0.0"><bsdf type="diffuse" id="m"><rgb name="reflectance" value="{}"/>
</bsdf></scene>)",
                          color));
    };
    for (const char* folder : {"parts/sub", "assets", "more"}) std::filesystem::create_directories(folder_ / folder);
    const std::string shape = R"(<shape type="sphere"><ref id="m"/></shape>)";
    write("parts/a.xml", R"(<scene version="3.0.0"><include filename="sub/b.xml"/></scene>)");
    write("parts/sub/b.xml", R"(<scene version="3.0.0"><include filename="m.xml"/></scene>)");
    const std::string text = R"(<include filename="parts/a.xml"/>)" + shape;
    const auto found = [&](const std::string& scene) { return material_of(read(scene)).base_color.value; };
    material("m.xml", "0.1");
    expect_color(found(text), 0.1, 0.1, 0.1);
    material("parts/m.xml", "0.2");
    expect_color(found(text), 0.2, 0.2, 0.2);
    material("parts/sub/m.xml", "0.3");
    expect_color(found(text), 0.3, 0.3, 0.3);
    // The file is found beside the scene.
    material("assets/n.xml", "0.4");
    const std::string paths = R"(<path value="assets"/><path value="more"/><include filename="n.xml"/>)" + shape;
    expect_color(found(paths), 0.4, 0.4, 0.4);
    material("more/n.xml", "0.5");
    expect_color(found(paths), 0.5, 0.5, 0.5);
    // The included file has a single object, whose name attribute is overridden.
    write("texture.xml", R"(<texture version="3.0.0" type="checkerboard" name="other"/>)");
    const SceneDescription scene = read(R"(<shape type="sphere"><bsdf type="diffuse">
<include filename="texture.xml" name="reflectance"/></bsdf></shape>)");
    EXPECT_GE(material_of(scene).base_color.texture, 0);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(Mitsuba, CyclesAndDamage)
{
    EXPECT_NE(error(R"(<include filename="a.xml"/>)").find("files include each other more than 15 deep"),
              std::string::npos);
    EXPECT_EQ(error(R"(<bsdf type="twosided" id="a"><ref id="a"/></bsdf><shape type="sphere"><ref id="a"/></shape>)"),
              "line 2, column 2: a bsdf can't contain itself");
    EXPECT_EQ(error(R"(<shape type="merge" id="a"><ref id="a"/></shape>)"),
              "line 2, column 2: a shape can't contain itself");
    EXPECT_EQ(error("<shape type=\"sphere\">").substr(0, 31), "line 3, column 3: not XML: Star");
    EXPECT_EQ(error_of("a.xml", "<html><scene/></html>"),
              "line 1: a Mitsuba scene must begin with <scene version=\"...\">, found <html>");
    std::string deep;
    for (int i = 0; i < 200; ++i) deep += "<bsdf type=\"twosided\">";
    for (int i = 0; i < 200; ++i) deep += "</bsdf>";
    EXPECT_NE(error(deep).find("nested more than 100 deep"), std::string::npos);
    // Entities are not expanded, so expansion attacks have no effect.
    EXPECT_EQ(error_of("a.xml",
                       "<!DOCTYPE scene [<!ENTITY a \"1\">]><scene version=\"3.0.0\"><shape type=\"sphere\"><float "
                       "name=\"radius\" value=\"&a;\"/></shape></scene>")
                  .substr(0, 14),
              "line 1, column");
    EXPECT_EQ(error(R"(<shape type="sphere"><float name="radius" value="1x"/></shape>)"),
              "line 2, column 23: expected numbers, found '1x'");
}

TEST_F(Mitsuba, ReportsUnknownParameters)
{
    read(
        R"(<shape type="sphere"><float name="radious" value="1"/><bsdf type="diffuse"><float name="gloss" value="1"/></bsdf></shape>
<shape type="torus"/><bsdf type="irawan" id="p"/><shape type="disk"><ref id="p"/></shape><emitter type="directionalarea"/><volume type="x"/>)");
    EXPECT_TRUE(has_warning("'radious' of shape 'sphere' is ignored"));
    EXPECT_TRUE(has_warning("'gloss' of bsdf 'diffuse' is ignored"));
    EXPECT_TRUE(has_warning("shape 'torus': is not supported"));
    EXPECT_TRUE(has_warning("bsdf 'irawan' ('p'): is not supported: gray diffuse"));
    EXPECT_TRUE(has_warning("emitter 'directionalarea': is not supported"));
    EXPECT_TRUE(has_warning("volume 'x': is ignored"));
}

TEST_F(Mitsuba, Confined)
{
    std::filesystem::create_directory(folder_ / "inside");
    write("b.xml", "<scene version=\"3.0.0\"></scene>");
    const auto file = write("inside/a.xml", scene_of("<include filename=\"../b.xml\"/>"));
    LoadOptions options;
    options.confine = true;
    EXPECT_THROW(load_scene(file, options, warnings_), Error);
    options.confine = false;
    load_scene(file, options, warnings_);
}

// ---------------------------------------------------------------------------------- cameras, films and integrators

TEST_F(Mitsuba, TransformsActInOrder)
{
    const SceneDescription scene =
        read(R"(<shape type="sphere"><transform name="to_world"><scale value="2"/><rotate z="1" angle="90"/>
<translate x="10"/></transform></shape>)");
    expect_near(scene.nodes.at(0).parent_from_node.point({1, 0, 0}), {10, 2, 0});
    const SceneDescription matrix =
        read(R"(<shape type="sphere"><transform name="to_world"><matrix value="1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1"/>
</transform></shape>)");
    expect_near(matrix.nodes.at(0).parent_from_node.point({1, 1, 1}), {6, 7, 8});
}

TEST_F(Mitsuba, CameraLooksAlongZ)
{
    const Camera c =
        sensor(std::string(wide_film) +
               R"(<transform name="to_world"><lookat origin="1,2,3" target="1,2,0" up="0,1,0"/></transform>)");
    expect_near(c.position, {1, 2, 3});
    expect_near(normalize(c.look_at - c.position), {0, 0, -1});
    expect_near(c.up, {0, 1, 0});
    const Camera moved = sensor(R"(<transform name="to_world"><translate z="4"/></transform>)");
    expect_near(moved.look_at - moved.position, {0, 0, 1});
}

/// fov_axis selects the image side that `fov` measures; the image is twice as wide as high.
TEST_F(Mitsuba, FieldsOfView)
{
    const auto fov = [&](const std::string& said) { return sensor(wide_film + said).fov_y / degree; };
    const double half = std::tan(30 * degree), from_x = 2 * std::atan(half / 2) / degree;
    EXPECT_NEAR(fov(R"(<float name="fov" value="60"/>)"), from_x, 1e-9);
    EXPECT_NEAR(fov(R"(<float name="fov" value="60"/><string name="fov_axis" value="y"/>)"), 60, 1e-9);
    EXPECT_NEAR(fov(R"(<float name="fov" value="60"/><string name="fov_axis" value="smaller"/>)"), 60, 1e-9);
    EXPECT_NEAR(fov(R"(<float name="fov" value="60"/><string name="fov_axis" value="larger"/>)"), from_x, 1e-9);
    EXPECT_NEAR(fov(R"(<float name="fov" value="60"/><string name="fov_axis" value="diagonal"/>)"),
                2 * std::atan(half / std::sqrt(5)) / degree, 1e-9);
    const double of_50_mm = 2 * std::atan(std::hypot(36, 24) / 100 / std::sqrt(5)) / degree;
    EXPECT_NEAR(fov(R"(<string name="focal_length" value="50mm"/>)"), of_50_mm, 1e-9);
    EXPECT_NEAR(fov(""), of_50_mm, 1e-9) << "the default";
}

/// Projects pixel coordinates to camera coordinates divided by the depth along the view axis.
std::array<double, 2> image_point(const SceneDescription& scene, const Camera& c, double x, double y)
{
    const double width = *scene.hints.width, height = *scene.hints.height,
                 half = c.kind == CameraKind::orthographic ? c.height / 2 : std::tan(c.fov_y / 2);
    return {(2 * (x / width + c.shift_x) - 1) * half * width / height, (1 - 2 * (y / height - c.shift_y)) * half};
}

/// A crop of the film shows that part of the full image for every kind of camera. The crop's aspect ratio determines
/// which side keeps its angle, and the aspect ratio that fov_y refers to.
TEST_F(Mitsuba, AxesOfFieldsOfView)
{
    const auto camera = [&](const std::string& said) { return sensor(wide_film + said); };
    const std::string fov = R"(<float name="fov" value="40"/><string name="fov_axis" value=")";
    EXPECT_EQ(camera(fov + "x\"/>").fov_axis, FovAxis::width);
    EXPECT_EQ(camera(fov + "y\"/>").fov_axis, FovAxis::height);
    EXPECT_EQ(camera(fov + "diagonal\"/>").fov_axis, FovAxis::diagonal);
    EXPECT_EQ(camera(fov + "smaller\"/>").fov_axis, FovAxis::smaller);
    EXPECT_EQ(camera(fov + "larger\"/>").fov_axis, FovAxis::larger);
    EXPECT_EQ(camera("").fov_axis, FovAxis::diagonal);
    EXPECT_EQ(camera("").fov_aspect, 2);
    EXPECT_EQ(camera_of(read(std::string("<sensor type=\"orthographic\">") + wide_film + "</sensor>")).fov_axis,
              FovAxis::width);
}

TEST_F(Mitsuba, Crop)
{
    for (const char* type : {"perspective", "orthographic"}) {
        const auto with = [&](const std::string& crop, const std::string& said = "") {
            return read(fmt::format(R"(<sensor type="{}"><film type="hdrfilm"><integer name="width" value="40"/>
<integer name="height" value="20"/>{}</film>{}</sensor>)",
                                    type, crop, said));
        };
        const SceneDescription whole = with(""), part = with(R"(<integer name="crop_offset_x" value="30"/>
<integer name="crop_offset_y" value="2"/><integer name="crop_width" value="8"/><integer name="crop_height" value="15"/>)");
        EXPECT_EQ(part.hints.width, 8);
        EXPECT_EQ(part.hints.height, 15);
        EXPECT_EQ(whole.cameras.at(0).shift_x, 0);
        EXPECT_FALSE(std::signbit(whole.cameras[0].shift_y));
        for (const auto& [x, y] : {std::pair{0.0, 0.0}, {3.0, 11.0}, {8.0, 15.0}}) {
            const auto a = image_point(part, part.cameras.at(0), x, y),
                       b = image_point(whole, whole.cameras[0], x + 30, y + 2);
            EXPECT_NEAR(a[0], b[0], 1e-12) << type;
            EXPECT_NEAR(a[1], b[1], 1e-12) << type;
        }
        if (type == std::string("orthographic")) continue;
        // The offset is a fraction of the film's width to the right and of its height down, for any crop.
        const std::string offset = R"(<float name="principal_point_offset_x" value="0.25"/>
<float name="principal_point_offset_y" value="0.1"/>)";
        for (const char* crop : {"", R"(<integer name="crop_width" value="10"/>)"}) {
            const SceneDescription plain = with(crop), shifted = with(crop, offset);
            const auto a = image_point(shifted, shifted.cameras.at(0), 5, 7),
                       b = image_point(plain, plain.cameras.at(0), 15, 9);
            EXPECT_NEAR(a[0], b[0], 1e-12);
            EXPECT_NEAR(a[1], b[1], 1e-12);
        }
    }
    EXPECT_TRUE(warnings_.empty());
    EXPECT_NE(error_of("c.xml", R"(<scene version="3.0.0"><sensor type="perspective"><film type="hdrfilm">
<integer name="width" value="40"/><integer name="crop_offset_x" value="33"/><integer name="crop_width" value="8"/></film></sensor></scene>)")
                  .find("the crop of 8x576 pixels at 33, 0 is not inside the film of 40x576"),
              std::string::npos);
}

/// Wrapper integrators such as `moment` contain the actual integrator.
TEST_F(Mitsuba, NestedIntegrators)
{
    const SceneDescription scene = read(R"(<integrator type="moment"><integrator type="path">
<integer name="max_depth" value="3"/></integrator></integrator>)");
    EXPECT_EQ(scene.hints.max_depth, 2);
    EXPECT_TRUE(has_warning("only the nested integrator"));
    EXPECT_EQ(read(R"(<integrator type="direct"/>)").hints.max_depth, 1) << "one scattering event";
}

TEST_F(Mitsuba, Settings)
{
    const SceneDescription scene = read(R"(<integrator type="path"><integer name="max_depth" value="8"/></integrator>
<sensor type="thinlens"><float name="aperture_radius" value="0.5"/><float name="focus_distance" value="3"/>
<sampler type="independent"><integer name="sample_count" value="16"/></sampler><film type="hdrfilm"><integer name="width" value="20"/>
<integer name="height" value="10"/><rfilter type="box"/></film></sensor>)");
    // The eighth path segment reaches the light after scattering at seven surfaces.
    EXPECT_EQ(scene.hints.max_depth, 7);
    EXPECT_EQ(scene.hints.samples, 16);
    EXPECT_EQ(scene.hints.width, 20);
    EXPECT_EQ(scene.hints.height, 10);
    EXPECT_EQ(scene.hints.filter, "box");
    EXPECT_FALSE(scene.hints.filter_radius);
    EXPECT_EQ(camera_of(scene).aperture, 1);
    EXPECT_EQ(camera_of(scene).focus_distance, 3);
    EXPECT_TRUE(warnings_.empty());
    const auto filter = [&](const std::string& inside) {
        const RenderHints hints =
            read(R"(<sensor type="perspective"><film type="hdrfilm">)" + inside + "</film></sensor>").hints;
        return hints.filter.value_or("") + " " + std::to_string(hints.filter_radius.value_or(0)).substr(0, 4);
    };
    EXPECT_EQ(filter(R"(<rfilter type="tent"/>)"), "tent 0.00");
    EXPECT_EQ(filter(R"(<rfilter type="tent"><float name="radius" value="1.5"/></rfilter>)"), "tent 1.50");
    EXPECT_EQ(filter(R"(<rfilter type="gaussian"><float name="stddev" value="0.25"/></rfilter>)"), "gaussian 1.00");
    EXPECT_EQ(filter(R"(<rfilter type="mitchell"/>)"), "blackman-harris 0.00");
}

}  // namespace
}  // namespace fathom::test
