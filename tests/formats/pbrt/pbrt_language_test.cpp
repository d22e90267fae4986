// SPDX-License-Identifier: Apache-2.0
// Tests of pbrt files: the language, cameras, films and integrators.
#include <fmt/format.h>
#include <zlib.h>
#include <cmath>

#include "pbrt_fixture.h"

namespace fathom::test {
namespace {

// -------------------------------------------------------------------------------------------------------- language

TEST_F(Pbrt, TransformsAreAppliedOneAfterTheOther)
{
    const SceneDescription scene = world(R"(Translate 1 2 3 Scale 2 2 2 Rotate 90 0 0 1
AttributeBegin Translate 1 0 0 Shape "sphere" AttributeEnd # gone again
Shape "sphere"
CoordinateSystem "here" Identity Shape "sphere" CoordSysTransform "here" Shape "sphere"
Transform [ 1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1 ] ConcatTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 1 1 1 1 ] Shape "sphere")");
    expect_near(origin(scene, 0), {1, 4, 3});
    expect_near(origin(scene, 1), {1, 2, 3});
    expect_near(origin(scene, 2), {0, 0, 0});
    expect_near(origin(scene, 3), {1, 2, 3});
    expect_near(origin(scene, 4), {6, 7, 8});
}

TEST_F(Pbrt, TransformsMayChangeWithTime)
{
    const SceneDescription scene = world(R"(TransformTimes 0 2
ActiveTransform EndTime Translate 4 0 0 ActiveTransform All Translate 0 1 0 Shape "sphere")");
    const Node& node = scene.nodes.at(0);
    ASSERT_EQ(node.motion.size(), 2u);
    EXPECT_EQ(node.motion[1].time, 2);
    expect_near(node.motion[0].parent_from_node.point({}), {0, 1, 0});
    expect_near(node.motion[1].parent_from_node.point({}), {4, 1, 0});
}

TEST_F(Pbrt, ObjectsAreInstances)
{
    const SceneDescription scene =
        world(fmt::format(R"(ObjectBegin "o" Translate 0 0 1 Shape "trianglemesh" {} ObjectEnd
Translate 1 0 0 ObjectInstance "o" Translate 1 0 0 ObjectInstance "o")",
                          triangle));
    ASSERT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.roots.size(), 2u);
    const Node& second = scene.nodes.at(std::size_t(scene.roots[1]));
    EXPECT_EQ(second.children, scene.nodes.at(std::size_t(scene.roots[0])).children);
    expect_near(second.parent_from_node.point({}), {2, 0, 0});
    expect_near(origin(scene, std::size_t(second.children.at(0))), {0, 0, 1});
}

TEST_F(Pbrt, FilesAreIncludedAndImported)
{
    write("inner.pbrt", "Translate 1 0 0 Shape \"sphere\"");
    const SceneDescription scene =
        world("Import \"inner.pbrt\" Shape \"sphere\" Include \"inner.pbrt\" Shape \"sphere\"");
    ASSERT_EQ(scene.roots.size(), 4u);
    expect_near(origin(scene, 1), {0, 0, 0});
    expect_near(origin(scene, 3), {1, 0, 0});
    EXPECT_EQ(scene.files.size(), 3u);
}

TEST_F(Pbrt, AttributesAreUsualValues)
{
    const SceneDescription scene = world(R"(Attribute "shape" "float radius" 3
Shape "sphere" Shape "sphere" "float radius" 5)");
    EXPECT_EQ(std::get<Sphere>(scene.nodes.at(0).shapes.at(0).geometry).radius, 3);
    EXPECT_EQ(std::get<Sphere>(scene.nodes.at(1).shapes.at(0).geometry).radius, 5);
}

TEST_F(Pbrt, CompressedScenesAreRead)
{
    const std::string text = "WorldBegin Shape \"sphere\" \"float radius\" [ 4 ]";
    gzFile file = gzopen((folder_ / "a.pbrt.gz").c_str(), "wb");
    gzwrite(file, text.data(), unsigned(text.size()));
    gzclose(file);
    const SceneDescription scene = load_scene(folder_ / "a.pbrt.gz", {}, warnings_);
    EXPECT_EQ(std::get<Sphere>(shape_of(scene).geometry).radius, 4);
    write("b.pbrt.gz", "\x1f\x8b\x08 no");
    EXPECT_EQ(error_of(folder_ / "b.pbrt.gz"), "the compressed data is damaged or truncated");
}

TEST_F(Pbrt, ReportsUnknownParameters)
{
    world("Shape \"sphere\" \"float radius\" 2\n  \"float colour\" 3");
    EXPECT_TRUE(has_warning("a.pbrt: line 3, column 3: Shape 'sphere': the parameter 'colour' is ignored"));
    EXPECT_EQ(warnings_.counts().size(), 1u);
}

TEST_F(Pbrt, ErrorsNameTheirPlace)
{
    EXPECT_EQ(error("Shape \"sphere\"\n AttributeBegin"),
              "line 3, column 2: AttributeBegin has no matching AttributeEnd");
    EXPECT_EQ(error("AttributeEnd"), "line 2, column 1: there is no matching AttributeBegin before it");
    EXPECT_EQ(error("Shap \"sphere\""), "line 2, column 1: 'Shap' is not a directive; did you mean 'Shape'?");
    EXPECT_EQ(error("Shape \"sphere\" \"flaot radius\" 2"),
              "line 2, column 16: 'flaot' is not a parameter type; did you mean 'float'?");
    EXPECT_EQ(error("Shape \"sphere\" \"float radius\" [ 1 x ]"),
              "line 2, column 35: 'x' is not a value of 'float radius'");
    EXPECT_EQ(error("Shape \"sphere\" \"float radius\" [ 1 2"),
              "line 2, column 16: the values of 'radius' are not closed by ]");
    EXPECT_EQ(error("Shape \"sphere\" \"float radius\" [ 1 2 ]"), "line 2, column 16: 'radius' must be one number");
    EXPECT_EQ(error("Translate 1 2"), "line 2, column 14: the file ends where a number is expected");
    EXPECT_EQ(error("Translate 1 2 1e999"), "line 2, column 15: the number '1e999' is too large");
    EXPECT_EQ(error("Shape \"sphere\" \"point3 P\" [ 1 2 ]"),
              "line 2, column 16: 'point3 P' has 2 numbers: not a multiple of 3");
    EXPECT_EQ(error("NamedMaterial \"a\" Shape \"sphere\""), "line 2, column 19: there is no material 'a'");
    EXPECT_EQ(error("ObjectInstance \"a\""), "line 2, column 1: there is no object 'a'");
    EXPECT_EQ(error("Include \"a.pbrt\"").find("line 2, column 1: '"), 0u);
    EXPECT_NE(error("Include \"a.pbrt\"").find("includes itself"), std::string::npos);
    EXPECT_EQ(error("Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 3 ]"),
              "line 2, column 1: Shape 'trianglemesh': there is no vertex 3: 'P' has 3");
    EXPECT_EQ(
        error("Texture \"t\" \"float\" \"scale\" \"texture tex\" \"t\" \nShape \"sphere\" \"texture alpha\" \"t\""),
        "line 2, column 29: a texture can't contain itself");
    EXPECT_EQ(error("Shape \"loopsubdiv\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 2 ] "
                    "\"integer levels\" 40"),
              "line 2, column 1: Shape 'loopsubdiv': 'levels' is too large: more than 12000000 corners of triangles");
}

TEST_F(Pbrt, PathsOutOfTheFolderAreRefused)
{
    std::filesystem::create_directories(folder_ / "inner");
    write("secret.pbrt", "Shape \"sphere\"");
    const auto path = write("inner/a.pbrt", "WorldBegin\nInclude \"../secret.pbrt\"");
    LoadOptions options;
    options.confine = true;
    try {
        load_scene(path, options, warnings_);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.place(), "line 2, column 1");
    }
    EXPECT_EQ(error_of(path), "loaded");
}

// ---------------------------------------------------------------------------------- cameras, films and integrators

TEST_F(Pbrt, CamerasAreLeftHanded)
{
    const std::string text = "LookAt 0 0 -5  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 40 WorldBegin";
    const Camera c = camera(text);
    expect_near(c.position, {0, 0, -5});
    // fov applies to the shorter side, which is vertical here.
    EXPECT_NEAR(c.fov_y, 40 * degree, 1e-9);
    // The whole world is mirrored, because +x is to the right of a pbrt camera that looks along +z.
    const SceneDescription scene = load("a.pbrt", text);
    EXPECT_LT(scene.nodes.at(std::size_t(scene.roots.at(0))).parent_from_node.determinant(), 0);
    const SceneDescription other = load("a.pbrt", "Scale -1 1 1 " + text);
    EXPECT_EQ(other.roots.size(), 1u);
    EXPECT_EQ(other.nodes.at(std::size_t(other.roots.at(0))).camera, 0);
}

TEST_F(Pbrt, CamerasHaveLensesAndWindows)
{
    const Camera lens = camera(R"(Camera "perspective" "float lensradius" 0.25 "float focaldistance" 3
"float shutteropen" 0.5 "float shutterclose" 2)");
    EXPECT_EQ(lens.aperture, 0.5);
    EXPECT_EQ(lens.focus_distance, 3);
    EXPECT_EQ(lens.shutter_close, 2);
    // The camera's space is scaled relative to the world; lens lengths are in camera space.
    const Camera small = camera(R"(Scale 4 4 4 Camera "perspective" "float lensradius" 0.25 "float focaldistance" 3)");
    EXPECT_NEAR(small.aperture, 0.5 / 4, 1e-9);
    EXPECT_NEAR(small.focus_distance, 3.0 / 4, 1e-9);
    const Camera window = camera(R"(Camera "perspective" "float fov" 90 "float screenwindow" [ -1 1 -0.5 0.5 ])");
    EXPECT_NEAR(window.fov_y, 2 * std::atan(0.5), 1e-9);
    const Camera flat = camera(R"(Camera "orthographic" "float screenwindow" [ -6 6 -3 3 ])");
    EXPECT_EQ(flat.kind, CameraKind::orthographic);
    EXPECT_NEAR(flat.height, 6, 1e-9);
    const Camera aside = camera(R"(Camera "orthographic" "float screenwindow" [ 1 5 -1 3 ])");
    EXPECT_NEAR(aside.shift_x, 0.75, 1e-9);
    EXPECT_NEAR(aside.shift_y, 0.25, 1e-9);
    EXPECT_EQ(camera("Camera \"spherical\"").kind, CameraKind::equal_area);
    const Camera around = camera(R"(Camera "spherical" "string mapping" "equirectangular")");
    EXPECT_EQ(around.kind, CameraKind::spherical);
    EXPECT_LT(around.look_at.x, -0.5);  // the image's center looks along pbrt's -x
    // The image of a spherical camera is mirrored.
    EXPECT_EQ(load("a.pbrt", "Camera \"spherical\" WorldBegin Shape \"sphere\"").roots.size(), 1u + 1u);
    camera("Camera \"realistic\" \"string lensfile\" \"a.dat\"");
    EXPECT_TRUE(has_warning("the lens is approximated by a thin lens"));
}

/// The crop is the upper right quarter of a 400 x 200 film that shows -2 to 2 and -1 to 1.
TEST_F(Pbrt, CropsAreThePicture)
{
    for (const char* crop : {"\"float cropwindow\" [ 0.5 1 0 0.5 ]", "\"integer pixelbounds\" [ 200 400 -7 100 ]"}) {
        const SceneDescription scene = load(
            "a.pbrt", std::string("Camera \"perspective\" \"float fov\" 90 Film \"rgb\" \"integer xresolution\" 400 "
                                  "\"integer yresolution\" 200 ") +
                          crop + " WorldBegin Shape \"sphere\"");
        EXPECT_EQ(scene.hints.width, 200);
        EXPECT_EQ(scene.hints.height, 100);
        EXPECT_NEAR(scene.cameras.at(0).fov_y, 2 * std::atan(0.5), 1e-9);
        EXPECT_NEAR(scene.cameras.at(0).shift_x, 0.5, 1e-9);
        EXPECT_NEAR(scene.cameras.at(0).shift_y, 0.5, 1e-9);
    }
    EXPECT_NE(error_of("a.pbrt", "Film \"rgb\" \"float cropwindow\" [ 0.5 0.5 0 1 ] WorldBegin Shape \"sphere\"")
                  .find("its crop is empty"),
              std::string::npos);
}

TEST_F(Pbrt, FilmsAndIntegratorsAreHints)
{
    const SceneDescription scene = load("a.pbrt", R"(Film "rgb" "integer xresolution" 40 "integer yresolution" 30
"float iso" 400 Sampler "halton" "integer pixelsamples" 8 PixelFilter "box" Integrator "volpath" "integer maxdepth" 7)");
    EXPECT_EQ(scene.hints.width, 40);
    EXPECT_EQ(scene.hints.height, 30);
    EXPECT_EQ(scene.hints.samples, 8);
    EXPECT_EQ(scene.hints.filter, "box");
    EXPECT_EQ(scene.hints.max_depth, 7);
    EXPECT_EQ(scene.hints.exposure, 2);
    EXPECT_TRUE(warnings_.empty());
    load("a.pbrt", "Film \"spectral\" \"string sensor\" \"canon_eos_5d\" PixelFilter \"mitchell\" Integrator \"bdpt\"");
    for (const char* words :
         {"is not supported: 'rgb' is used", "the sensor 'canon_eos_5d'",
          "filters with negative lobes are not supported", "is not supported: path tracing is used"})
        EXPECT_TRUE(has_warning(words)) << words;
    EXPECT_FALSE(scene.hints.white_balance);
    EXPECT_EQ(load("a.pbrt", R"(Camera "perspective" "float shutterclose" 0.5
Film "rgb" "float whitebalance" 3200 "float maxcomponentvalue" 10 "float iso" 800)")
                  .hints.white_balance,
              3200);
    const auto filter = [&](const char* words) {
        const RenderHints hints = load("a.pbrt", std::string("PixelFilter ") + words).hints;
        return hints.filter.value_or("") + " " + std::to_string(hints.filter_radius.value_or(0)).substr(0, 4);
    };
    EXPECT_EQ(filter("\"triangle\""), "tent 2.00");
    EXPECT_EQ(filter("\"triangle\" \"float xradius\" 1 \"float yradius\" 1"), "tent 0.00");
    EXPECT_EQ(filter("\"gaussian\""), "gaussian 0.00");
    EXPECT_EQ(filter("\"gaussian\" \"float sigma\" 0.75"), "gaussian 3.00");
    EXPECT_EQ(filter("\"box\" \"float xradius\" 1.5 \"float yradius\" 1.5"), "box 1.50");
    // The clamp limits what the film records, which is four times the radiance.
    EXPECT_TRUE(has_warning("--clamp-indirect 2.5"));
    EXPECT_EQ(load("a.pbrt", "Film \"rgb\" \"float whitebalance\" 500").hints.white_balance, 1000);
    EXPECT_TRUE(has_warning("'whitebalance' is out of range: 1000 K is used"));
}

}  // namespace
}  // namespace fathom::test
