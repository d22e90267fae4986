#include <cmath>
#include <numbers>

#include "import_test_helpers.h"
#include "scene/conductors.h"

#include <fmt/format.h>
#include <zlib.h>

namespace fathom::test {
namespace {

constexpr double degree = std::numbers::pi / 180;

class Pbrt : public ImportTest {
protected:
    /// What stands behind WorldBegin.
    SceneDescription world(const std::string& inside) { return load("a.pbrt", "WorldBegin\n" + inside); }
    std::string error(const std::string& inside) { return error_of("a.pbrt", "WorldBegin\n" + inside); }
    bool is_told(const std::string& words) const
    {
        for (const auto& [message, times] : warnings_.counts())
            if (message.find(words) != std::string::npos) return true;
        return false;
    }
    static const Shape& shape_of(const SceneDescription& scene)
    {
        for (const Node& node : scene.nodes)
            if (!node.shapes.empty()) return node.shapes[0];
        throw std::runtime_error("no shape");
    }
    static const Material& material_of(const SceneDescription& scene)
    {
        return scene.materials.at(std::size_t(shape_of(scene).material));
    }
    static const Mesh& mesh_of(const SceneDescription& scene)
    {
        return scene.meshes.at(std::size_t(std::get<MeshInstance>(shape_of(scene).geometry).mesh));
    }
    Material material(const std::string& text) { return material_of(world(text + "\nShape \"sphere\"")); }
    Camera camera(const std::string& text)
    {
        return load("a.pbrt", "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100\n" + text)
            .cameras.at(0);
    }
    static Vec3d origin(const SceneDescription& scene, std::size_t node)
    {
        return scene.nodes.at(node).parent_from_node.point({0, 0, 0});
    }
};

void expect_color(const Color& c, double r, double g, double b, double tolerance = 1e-6)
{
    EXPECT_NEAR(c.r, r, tolerance);
    EXPECT_NEAR(c.g, g, tolerance);
    EXPECT_NEAR(c.b, b, tolerance);
}

constexpr const char* triangle = R"("point3 P" [ 0 0 0 1 0 0 0 1 0 ] "integer indices" [ 0 1 2 ])";

// ---------------------------------------------------------------------------------------------------- the language

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
    const gzFile file = gzopen((folder_ / "a.pbrt.gz").c_str(), "wb");
    gzwrite(file, text.data(), unsigned(text.size()));
    gzclose(file);
    const SceneDescription scene = load_scene(folder_ / "a.pbrt.gz", {}, warnings_);
    EXPECT_EQ(std::get<Sphere>(shape_of(scene).geometry).radius, 4);
    write("b.pbrt.gz", "\x1f\x8b\x08 no");
    EXPECT_EQ(error_of(folder_ / "b.pbrt.gz"), "the compressed data are damaged or end too early");
}

TEST_F(Pbrt, WhatNobodyReadsIsTold)
{
    world("Shape \"sphere\" \"float radius\" 2\n  \"float colour\" 3");
    EXPECT_TRUE(is_told("a.pbrt: line 3, column 3: Shape 'sphere': the parameter 'colour' is ignored"));
    EXPECT_EQ(warnings_.counts().size(), 1u);
}

TEST_F(Pbrt, MistakesAreToldWithTheirPlace)
{
    EXPECT_EQ(error("Shape \"sphere\"\n AttributeBegin"),
              "line 3, column 2: AttributeBegin is never followed by its AttributeEnd");
    EXPECT_EQ(error("AttributeEnd"), "line 2, column 1: there is no AttributeBegin before it");
    EXPECT_EQ(error("Shap \"sphere\""), "line 2, column 1: 'Shap' is no directive; did you mean 'Shape'?");
    EXPECT_EQ(error("Shape \"sphere\" \"flaot radius\" 2"),
              "line 2, column 16: 'flaot' is no type of parameter; did you mean 'float'?");
    EXPECT_EQ(error("Shape \"sphere\" \"float radius\" [ 1 x ]"),
              "line 2, column 35: 'x' is no value of 'float radius'");
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

// ---------------------------------------------------------------------------------------------------- what is seen

TEST_F(Pbrt, CamerasAreLeftHanded)
{
    const std::string text = "LookAt 0 0 -5  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 40 WorldBegin";
    const Camera c = camera(text);
    expect_near(c.position, {0, 0, -5});
    // The shorter side is the vertical one.
    EXPECT_NEAR(c.fov_y, 40 * degree, 1e-9);
    // The whole world is mirrored, as +x is to the right of a camera that looks along +z.
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
    EXPECT_LT(around.look_at.x, -0.5);  // in the picture's middle is pbrt's -x
    // What it shows is as in a mirror.
    EXPECT_EQ(load("a.pbrt", "Camera \"spherical\" WorldBegin Shape \"sphere\"").roots.size(), 1u + 1u);
    camera("Camera \"realistic\" \"string lensfile\" \"a.dat\"");
    EXPECT_TRUE(is_told("the lens is taken as a thin one"));
}

/// The upper right quarter of a film of 400 x 200, which shows -2 to 2 and -1 to 1.
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
                  .find("there is nothing in its crop"),
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
    for (const char* words : {"the picture has red, green and blue", "the sensor 'canon_eos_5d'",
                              "no filter with negative", "paths are traced instead"})
        EXPECT_TRUE(is_told(words)) << words;
}

// ---------------------------------------------------------------------------------------------------- light

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
}

/// pbrt's own directions of pictures: of a projection along +z, x to the right and y up; the map of a goniometric light
/// has y and z exchanged, its middle being at +z, its right at +x and its bottom at +y.
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
    EXPECT_TRUE(is_told("the parameter 'from' is ignored"));
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
    expect_color(material_of(scene).emission.value, 2, 4, 6);
    EXPECT_TRUE(material_of(scene).emission_two_sided);
    const Material given = material("AreaLightSource \"diffuse\" \"float power\" 100");
    EXPECT_NEAR(given.emission.value.g, 100 / (4 * std::numbers::pi * std::numbers::pi), 1e-4);
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
}

// ---------------------------------------------------------------------------------------------------- materials

TEST_F(Pbrt, Diffuse)
{
    expect_color(material("").base_color.value, 0.5, 0.5, 0.5);
    expect_color(material("Material \"diffuse\" \"rgb reflectance\" [ 0.1 0.2 3 ]").base_color.value, 0.1, 0.2, 1);
    expect_color(material(R"(MakeNamedMaterial "m" "string type" "diffuse" "spectrum reflectance" [ 300 0.25 900 0.25 ]
NamedMaterial "m")")
                     .base_color.value,
                 0.25, 0.25, 0.25, 1e-4);
}

TEST_F(Pbrt, RoughnessIsRemapped)
{
    // alpha is the roughness here squared: 0.25^2, and of a remapped one the root.
    EXPECT_NEAR(
        material("Material \"conductor\" \"float roughness\" 0.0625 \"bool remaproughness\" false").roughness.value,
        0.25, 1e-6);
    EXPECT_NEAR(material("Material \"conductor\" \"float roughness\" 0.0625").roughness.value, 0.5, 1e-6);
    const Material m = material("Material \"conductor\" \"float uroughness\" 0.01 \"float vroughness\" 0.16");
    EXPECT_NEAR(m.roughness.value, std::sqrt(0.1), 1e-6);
    EXPECT_GT(m.anisotropy.value, 0.5f);
    EXPECT_NEAR(m.anisotropy_rotation, 90 * degree, 1e-9);
}

TEST_F(Pbrt, TexturesAsRoughnessAreRemapped)
{
    for (const double power : {0.25, 0.5}) {
        const SceneDescription scene = world(fmt::format(R"(Texture "t" "float" "imagemap" "string filename" "a.png"
Material "conductor" "texture roughness" "t" "bool remaproughness" {} Shape "sphere")",
                                                         power < 0.5));
        const FloatInput& roughness = material_of(scene).roughness;
        const Texture& curve = scene.textures.at(std::size_t(roughness.texture));
        ASSERT_EQ(curve.kind, TextureKind::ramp);
        EXPECT_EQ(scene.textures.at(std::size_t(curve.factor.texture)).kind, TextureKind::image);
        for (const RampStop& stop : curve.stops)
            EXPECT_NEAR(stop.color.g, std::pow(double(stop.position), power), 1e-6);
    }
}

/// Each direction has its own; of what has facets of one roughness only one is taken.
TEST_F(Pbrt, TexturesAsTwoRoughnesses)
{
    const auto rough = [&](const char* kind) {
        return material(fmt::format(R"(Texture "t" "float" "imagemap" "string filename" "a.png"
Material "{}" "texture uroughness" "t" "float vroughness" 0.25 "bool remaproughness" false)",
                                    kind));
    };
    const Material m = rough("conductor");
    EXPECT_TRUE(m.two_roughnesses);
    EXPECT_GE(m.anisotropy.texture, 0) << "along u, where the tangent is";
    EXPECT_EQ(m.roughness.value, 0.5f);
    EXPECT_FALSE(is_told("rough"));
    EXPECT_FALSE(rough("dielectric").two_roughnesses);
    EXPECT_TRUE(is_told("glass is as rough in all directions as in one"));
    EXPECT_FALSE(rough("coateddiffuse").two_roughnesses);
    EXPECT_TRUE(is_told("the coat is as rough in all directions as in one"));
}

TEST_F(Pbrt, Metals)
{
    // What pbrt's own curves reflect in daylight.
    expect_color(material("Material \"conductor\" \"spectrum eta\" \"metal-Ag-eta\" \"spectrum k\" \"metal-Ag-k\"")
                     .base_color.value,
                 0.9715, 0.9599, 0.9153, 1e-3);
    const Material copper = material("Material \"conductor\"");
    expect_color(copper.base_color.value, 0.9553, 0.6376, 0.5382, 2e-3);
    const auto at_82 = [](float base, float edge) { return edge * (base + (1 - base) * std::pow(6.0 / 7, 5)); };
    EXPECT_NEAR(at_82(copper.base_color.value.g, copper.edge_color.value.g), 0.7669, 1e-3);
    expect_color(
        material("Material \"coatedconductor\" \"spectrum conductor.eta\" \"metal-CuZn-eta\"").base_color.value, 0.8717,
        0.7191, 0.3346, 3e-3);
    const double f = conductor_reflectance(1, 1.5, 3);
    expect_color(material("Material \"conductor\" \"rgb eta\" [ 1.5 1.5 1.5 ] \"rgb k\" [ 3 3 3 ]").base_color.value, f,
                 f, f);
    expect_color(material("Material \"conductor\" \"spectrum eta\" [ 300 1.5 900 1.5 ] \"spectrum k\" [ 300 3 900 3 ]")
                     .base_color.value,
                 f, f, f, 1e-3);
    write("n.spd", "# a comment\n300 1.5\n900 1.5\n");
    write("k.spd", "300 3\n900 3\n");
    const char* const files = "Material \"conductor\" \"spectrum eta\" \"n.spd\" \"spectrum k\" \"k.spd\"";
    expect_color(material(files).base_color.value, f, f, f, 1e-3);
    const Material plain = material("Material \"conductor\" \"rgb reflectance\" [ 0.7 0.6 0.5 ]");
    expect_color(plain.base_color.value, 0.7, 0.6, 0.5);
    const double k = 2 * std::sqrt(0.7 / 0.3);
    EXPECT_NEAR(at_82(plain.base_color.value.r, plain.edge_color.value.r), conductor_reflectance(1.0 / 7, 1, k), 1e-4);
    const char* const coated = "Material \"coatedconductor\" \"rgb reflectance\" [ 0.7 0.6 0.5 ]";
    EXPECT_NEAR(material(coated).base_color.value.r, conductor_reflectance(1, 1 / 1.5, k / 1.5), 1e-4)
        << "the reflectance is that in air";
}

TEST_F(Pbrt, Coats)
{
    const Material m = material(
        "Material \"coateddiffuse\" \"rgb reflectance\" [ 1 0 0 ] \"float roughness\" 0.0001 \"float eta\" 1.4");
    EXPECT_EQ(m.kind, MaterialKind::plastic);
    EXPECT_FALSE(m.energy_compensation);
    EXPECT_EQ(m.ior, 1.4f);
    EXPECT_EQ(m.optical_thickness, 0.01f) << "pbrt's layers absorb";
    EXPECT_EQ(material("Material \"coateddiffuse\" \"float thickness\" 0.5").optical_thickness, 0.5f);
    EXPECT_NEAR(m.roughness.value, 0.1, 1e-6);
    const Material metal = material("Material \"coatedconductor\" \"float conductor.roughness\" 0.0001");
    EXPECT_EQ(metal.metallic.value, 1);
    EXPECT_EQ(metal.coat.value, 1);
    EXPECT_NEAR(metal.coat_color.value.g, std::exp(-0.02 / std::sqrt(1 - 0.5 / 2.25)), 1e-6);
    // Refraction widens what rough metal reflects; the grazing angle of the outside is none below.
    EXPECT_NEAR(metal.roughness.value, std::sqrt(1.5 * 0.01), 1e-5);
    EXPECT_NEAR(metal.edge_color.value.g, 0.677, 2e-3);
    EXPECT_TRUE(is_told("light below the coat is not followed"));
}

TEST_F(Pbrt, Glass)
{
    EXPECT_EQ(material("Material \"dielectric\"").ior, 1.5f);
    EXPECT_NEAR(material("Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"").ior, 1.5168, 1e-6);
    EXPECT_TRUE(material("Material \"thindielectric\"").thin);
    const Material green = material(R"(MakeNamedMedium "g" "string type" "homogeneous" "rgb sigma_a" [ 1 2 4 ]
"rgb sigma_s" [ 0 0 0 ] "float scale" 2 MediumInterface "g" "" Material "dielectric")");
    const auto left = [&](float c) { return std::pow(double(c), 1 / green.attenuation_distance); };
    EXPECT_NEAR(left(green.attenuation_color.r), std::exp(-2), 1e-6);
    EXPECT_NEAR(left(green.attenuation_color.b), std::exp(-8), 1e-6);
    EXPECT_EQ(material("Material \"interface\"").alpha.value, 0);
    world(R"(MakeNamedMedium "c" "string type" "cloud" MediumInterface "c" "" Material "interface" Shape "sphere")");
    EXPECT_TRUE(is_told("Medium 'cloud': is not rendered yet"));
}

TEST_F(Pbrt, DiffuseTransmission)
{
    const char* const text = R"(Material "diffusetransmission" "rgb reflectance" [ 0.9 0.6 0.1 ]
"rgb transmittance" [ 0.1 0.2 0.8 ] "float scale" {})";
    const Material m = material(fmt::format(fmt::runtime(text), 1));
    EXPECT_TRUE(m.diffuse_transmission_added) << "neither is taken from the other";
    EXPECT_EQ(m.diffuse_transmission.value, 1);
    expect_color(m.base_color.value, 0.9, 0.6, 0.1);
    expect_color(m.diffuse_transmission_color.value, 0.1, 0.2, 0.8);
    expect_color(material(fmt::format(fmt::runtime(text), 0.5)).diffuse_transmission_color.value, 0.05, 0.1, 0.4);
    EXPECT_FALSE(is_told("more than it gets"));
    expect_color(material(fmt::format(fmt::runtime(text), 2)).base_color.value, 1, 1, 0.2);
    EXPECT_TRUE(is_told("more than it gets"));
}

TEST_F(Pbrt, Hair)
{
    const Material usual = material("Material \"hair\"");
    EXPECT_EQ(usual.kind, MaterialKind::hair);
    EXPECT_EQ(usual.eumelanin, 1.3f);
    EXPECT_EQ(usual.pheomelanin, 0);
    EXPECT_EQ(usual.hair_ior, 1.55f);
    EXPECT_EQ(usual.beta_m.value, 0.3f);
    EXPECT_EQ(usual.beta_n.value, 0.3f);
    EXPECT_NEAR(usual.scale_tilt, 2 * std::numbers::pi / 180, 1e-9);
    const Material red = material(
        R"(Material "hair" "float pheomelanin" 0.7 "float beta_m" 0.2 "float beta_n" 0.4 "float alpha" 3 "float eta" 1.4)");
    EXPECT_EQ(red.eumelanin, 0);
    EXPECT_EQ(red.pheomelanin, 0.7f);
    EXPECT_EQ(red.beta_m.value, 0.2f);
    EXPECT_EQ(red.beta_n.value, 0.4f);
    EXPECT_NEAR(red.scale_tilt, 3 * std::numbers::pi / 180, 1e-9);
    EXPECT_EQ(red.hair_ior, 1.4f);
    const Material colored = material(R"(Material "hair" "rgb reflectance" [ 0.1 0.2 0.3 ] "float eumelanin" 2)");
    expect_color(colored.base_color.value, 0.1, 0.2, 0.3);
    EXPECT_EQ(colored.eumelanin, 0);
    const Material absorbing = material(R"(Material "hair" "rgb sigma_a" [ 0.5 1.5 2.5 ] "rgb color" [ 0.1 0.2 0.3 ])");
    expect_color(absorbing.absorption.value, 0.5, 1.5, 2.5);
    expect_color(absorbing.base_color.value, 1, 1, 1);
    EXPECT_FALSE(is_told("hair"));
}

TEST_F(Pbrt, WhatIsApproximatedIsTold)
{
    const std::pair<const char*, const char*> approximated[] = {
        {"Texture \"t\" \"float\" \"checkerboard\" Material \"hair\" \"texture eumelanin\" \"t\"",
         "of textures as melanins"},
        {"Material \"measured\" \"string filename\" \"a.bsdf\"", "measured materials are not read"},
        {"Material \"subsurface\" \"string name\" \"Skin1\"", "the media that have names are not known"},
        {"Material \"velvet\"", "is not known: grey diffuse instead"}};
    for (const auto& [text, words] : approximated) {
        material(text);
        EXPECT_TRUE(is_told(words)) << text;
    }
    EXPECT_GT(material("Material \"subsurface\"").transmission_scatter.r, 0);
    EXPECT_EQ(material("Material \"subsurface\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]").subsurface.value, 1);
    const char* const two = R"(MakeNamedMaterial "a" "string type" "diffuse" "rgb reflectance" [ 1 1 1 ]
MakeNamedMaterial "b" "string type" "diffuse" "rgb reflectance" [ 0 0 0 ] Material "mix" "string materials" [ "a" "b" ] "float amount" 0.25)";
    expect_color(material(two).base_color.value, 0.75, 0.75, 0.75);
    const SceneDescription mixed = world(R"(MakeNamedMaterial "a" "string type" "diffuse"
MakeNamedMaterial "b" "string type" "conductor" Material "mix" "string materials" [ "a" "b" ] "float amount" 0.25 Shape "sphere")");
    const Material& mixture = material_of(mixed);
    EXPECT_EQ(mixture.kind, MaterialKind::mix);
    EXPECT_EQ(mixture.factor.value, 0.25f);
    EXPECT_EQ(mixed.materials.at(std::size_t(mixture.material_a)).kind, MaterialKind::diffuse);
    EXPECT_EQ(mixed.materials.at(std::size_t(mixture.material_b)).metallic.value, 1);
}

// ---------------------------------------------------------------------------------------------------- textures

TEST_F(Pbrt, Textures)
{
    const SceneDescription scene =
        world(R"(Texture "t" "spectrum" "imagemap" "string filename" "a.png" "string wrap" "clamp"
"float uscale" 2 "float vscale" 3 "float udelta" 0.5 "float vdelta" 0.25 "float scale" 0.5 "string encoding" "linear"
Material "diffuse" "texture reflectance" "t" Shape "sphere")");
    const ColorInput& c = material_of(scene).base_color;
    expect_color(c.value, 0.5, 0.5, 0.5);
    const Texture& t = scene.textures.at(std::size_t(c.texture));
    EXPECT_EQ(t.wrap_u, Wrap::clamp);
    EXPECT_EQ(t.color_space, ColorSpace::linear);
    EXPECT_EQ(t.uv_scale.y, 3);
    EXPECT_EQ(t.uv_offset.x, 0.5f);
    // v grows downwards here: 1 - (3 (1 - v) + 0.25).
    EXPECT_EQ(t.uv_offset.y, -2.25f);
    // A sphere with a picture has pbrt's texture coordinates.
    EXPECT_FALSE(scene.meshes.empty());
}

TEST_F(Pbrt, TexturesOfTextures)
{
    const SceneDescription scene = world(R"(Texture "c" "spectrum" "checkerboard" "rgb tex1" [ 1 0 0 ] "float uscale" 4
Texture "half" "float" "constant" "float value" 0.5
Texture "s" "spectrum" "scale" "texture tex" "c" "texture scale" "half"
Material "diffuse" "texture reflectance" "s" Shape "sphere")");
    const ColorInput& c = material_of(scene).base_color;
    expect_color(c.value, 0.5, 0.5, 0.5);
    const Texture& t = scene.textures.at(std::size_t(c.texture));
    EXPECT_EQ(t.kind, TextureKind::checker_uv);
    expect_color(t.color_a.value, 1, 0, 0);
    EXPECT_EQ(t.uv_scale.x, 4);
}

/// A world whose reflectance is a texture of pbrt's, and what was made of it.
struct Textured {
    SceneDescription scene;

    const Texture& base() const
    {
        for (const Node& node : scene.nodes)
            if (!node.shapes.empty())
                return of(scene.materials.at(std::size_t(node.shapes[0].material)).base_color.texture);
        throw std::runtime_error("no shape");
    }
    const Texture& of(int texture) const { return scene.textures.at(std::size_t(texture)); }
};

TEST_F(Pbrt, ProceduralTextures)
{
    const auto read = [&](const std::string& type, const std::string& parameters) {
        warnings_ = {};
        Textured t{
            world(fmt::format("Texture \"t\" \"spectrum\" \"{}\" {}\n"
                              "Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
                              type, parameters))};
        EXPECT_EQ(is_told("Texture '"), type == "ptex") << type;
        return t;
    };
    // What may leave 0 to 1 is limited, as reflectances are.
    const auto limited = [](const Textured& t) -> const Texture& {
        EXPECT_EQ(t.base().kind, TextureKind::clamp);
        return t.of(t.base().color_a.texture);
    };
    const Textured fbm = read("fbm", "\"integer octaves\" 3 \"float roughness\" 0.75");
    EXPECT_EQ(limited(fbm).kind, TextureKind::fbm);
    EXPECT_EQ(limited(fbm).octaves, 3);
    EXPECT_EQ(limited(fbm).gain, 0.75f);
    // Only the place matters: the sphere needs no coordinates of pbrt's.
    EXPECT_TRUE(fbm.scene.meshes.empty());
    const Textured wrinkled = read("wrinkled", "");
    EXPECT_EQ(limited(wrinkled).kind, TextureKind::wrinkled);
    EXPECT_EQ(limited(wrinkled).octaves, 8);
    EXPECT_EQ(limited(read("windy", "")).kind, TextureKind::windy);
    const Textured marble = read("marble", "\"float scale\" 2 \"float variation\" 0.5");
    EXPECT_EQ(marble.base().kind, TextureKind::veined_marble);
    EXPECT_EQ(marble.base().scale, 2);
    EXPECT_EQ(marble.base().turbulence_weight, 0.5f);
    const Textured dots = read("dots", "\"rgb inside\" [ 1 0 0 ] \"rgb outside\" [ 0 1 0 ] \"float uscale\" 3");
    EXPECT_EQ(dots.base().kind, TextureKind::dots);
    // pbrt-v4 has the two the other way round.
    expect_color(dots.base().color_a.value, 1, 0, 0);
    expect_color(dots.base().color_b.value, 0, 1, 0);
    EXPECT_EQ(dots.base().uv_scale.x, 3);
    const Textured mix = read("directionmix", "\"vector dir\" [ 3 0 4 ] \"rgb tex1\" [ 1 0 0 ]");
    EXPECT_EQ(mix.base().kind, TextureKind::facing);
    expect_color(mix.base().color_b.value, 1, 0, 0);
    EXPECT_EQ(mix.base().direction, (Vec3d{3, 0, 4}));
    read("ptex", "");
    EXPECT_TRUE(is_told("Ptex files are not read"));
}

/// s and t of a mapping at a place, by the texture's own parameters.
Vec2f mapped(const Texture& t, double u, double v)
{
    const double c = std::cos(double(t.uv_rotation)), s = std::sin(double(t.uv_rotation));
    const double x = u * double(t.uv_scale.x), y = v * double(t.uv_scale.y);
    return {float(c * x + s * y) + t.uv_offset.x, float(-s * x + c * y) + t.uv_offset.y};
}

TEST_F(Pbrt, BilerpGoesFromCornerToCorner)
{
    const Textured t{world(R"(Texture "t" "spectrum" "bilerp" "rgb v00" [ 0.1 0 0 ] "rgb v01" [ 0.2 0 0 ]
"rgb v10" [ 0.3 0 0 ] "rgb v11" [ 0.4 0 0 ] Material "diffuse" "texture reflectance" "t" Shape "sphere")")};
    // Coordinates may leave 0 to 1, and colours with them.
    const Texture& mix = t.of(t.base().color_a.texture);
    const Texture &low = t.of(mix.color_a.texture), &high = t.of(mix.color_b.texture);
    EXPECT_NEAR(low.color_a.value.r, 0.1, 1e-6);
    EXPECT_NEAR(low.color_b.value.r, 0.3, 1e-6);
    EXPECT_NEAR(high.color_a.value.r, 0.2, 1e-6);
    EXPECT_NEAR(high.color_b.value.r, 0.4, 1e-6);
    EXPECT_EQ(mix.factor.channel, 1);
    EXPECT_EQ(low.factor.channel, 0);
    EXPECT_EQ(high.factor.channel, 0);
    const Texture& place = t.of(mix.factor.texture);
    EXPECT_EQ(place.kind, TextureKind::coordinates);
    // v of meshes grows downwards here.
    EXPECT_NEAR(mapped(place, 0.25, 0.125).y, 0.875, 1e-6);
}

TEST_F(Pbrt, MappingsByPlace)
{
    const auto read = [&](const std::string& type, const std::string& parameters) {
        // Through this camera x runs the other way.
        return Textured{load("a.pbrt", fmt::format(R"(Camera "perspective" WorldBegin AttributeBegin Translate 1 2 3
Texture "t" "spectrum" "{}" {} AttributeEnd
Material "diffuse" "texture reflectance" "t" Shape "sphere")",
                                                   type, parameters))};
    };
    const std::string picture = "\"string filename\" \"a.png\" ";
    // s is the angle from the axis there, t that about it: u and v here the other way round.
    const Textured ball = read("imagemap", picture + "\"string mapping\" \"spherical\"");
    EXPECT_EQ(ball.base().mapping, TextureMapping::spherical);
    const Vec2f on_ball = mapped(ball.base(), 0.125, 0.25);
    EXPECT_NEAR(on_ball.x, 0.25, 1e-6);
    EXPECT_NEAR(on_ball.y, 1 - 0.125, 1e-6);
    // The sphere needs no coordinates of its own, but the place where the texture was defined, in the mirrored world.
    EXPECT_TRUE(ball.scene.meshes.empty());
    EXPECT_EQ(ball.base().world_from_texture.point({1, 0, 0}), (Vec3d{-2, 2, 3}));
    const Texture dots_on_ball = read("dots", "\"string mapping\" \"spherical\"").base();
    EXPECT_NEAR(mapped(dots_on_ball, 0.125, 0.25).x, 0.25, 1e-6);
    EXPECT_NEAR(mapped(dots_on_ball, 0.125, 0.25).y, 0.125, 1e-6);
    const Texture tube = read("imagemap", picture + "\"string mapping\" \"cylindrical\"").base();
    EXPECT_EQ(tube.mapping, TextureMapping::cylindrical);
    EXPECT_NEAR(mapped(tube, 0.125, 0.25).x, 0.125, 1e-6);
    EXPECT_NEAR(mapped(tube, 0.125, 0.25).y, 0.75, 1e-6);
    const Texture plane = read("checkerboard",
                               "\"string mapping\" \"planar\" \"vector v1\" [ 0 2 0 ] \"vector v2\" [ 0 0 4 ] "
                               "\"float udelta\" 0.5 \"float vdelta\" 0.25")
                              .base();
    EXPECT_EQ(plane.mapping, TextureMapping::planar);
    // At y = 2 + 3 and z = 3 + 5.
    const Vec3d p = plane.world_from_texture.inverse().point({0, 5, 8});
    EXPECT_NEAR(mapped(plane, p.x, p.y).x, 6.5, 1e-6);
    EXPECT_NEAR(mapped(plane, p.x, p.y).y, 20.25, 1e-6);
    const Texture cubes = read("checkerboard", "\"integer dimension\" 3").base();
    EXPECT_EQ(cubes.kind, TextureKind::checker_space);
    EXPECT_EQ(cubes.world_from_texture.point({0, 0, 0}), (Vec3d{-1, 2, 3}));
    EXPECT_EQ(read("directionmix", "\"vector dir\" [ 3 0 4 ]").base().direction, (Vec3d{-3, 0, 4}));
}

TEST_F(Pbrt, PicturesAreInvertedAndWrapped)
{
    const Textured t{world(R"(Texture "t" "spectrum" "imagemap" "string filename" "a.png" "string wrap" "black"
"bool invert" true "float scale" 0.5 Material "diffuse" "texture reflectance" "t" Shape "sphere")")};
    EXPECT_EQ(t.base().kind, TextureKind::invert);
    expect_color(t.base().color_a.value, 0.5, 0.5, 0.5);
    EXPECT_EQ(t.of(t.base().color_a.texture).wrap_u, Wrap::black);
    EXPECT_EQ(t.of(t.base().color_a.texture).wrap_v, Wrap::black);
    const Textured sky{world(R"(Texture "t" "spectrum" "imagemap" "string filename" "a.png" "string wrap"
"octahedralsphere" Material "diffuse" "texture reflectance" "t" Shape "sphere")")};
    EXPECT_EQ(sky.base().wrap_u, Wrap::octahedral);
    EXPECT_FALSE(is_told("the wrap"));
}

TEST_F(Pbrt, HeightsBendNormals)
{
    const char* const waves = "Texture \"t\" \"float\" \"scale\" \"texture tex\" \"w\" \"float scale\" 0.25 ";
    const std::string windy = std::string("Texture \"w\" \"float\" \"windy\" ") + waves;
    const Material water = material(windy + "Material \"dielectric\" \"texture displacement\" \"t\"");
    EXPECT_GE(water.bump.texture, 0);
    EXPECT_EQ(water.bump.value, 0.25f);
    EXPECT_TRUE(warnings_.counts().empty());
    // Where there is a normal map it counts.
    const Material both = material(windy +
                                   "Material \"diffuse\" \"texture displacement\" \"t\" "
                                   "\"string normalmap\" \"n.png\"");
    EXPECT_LT(both.bump.texture, 0);
    EXPECT_GE(both.normal_texture, 0);
}

TEST_F(Pbrt, AlphaMakesHoles)
{
    const SceneDescription scene = world("Shape \"sphere\" \"float alpha\" 0.25 Shape \"sphere\"");
    EXPECT_EQ(material_of(scene).alpha.value, 0.25f);
    EXPECT_EQ(material_of(scene).alpha_mode, AlphaMode::blend);
    EXPECT_EQ(scene.materials.at(std::size_t(scene.nodes.at(1).shapes.at(0).material)).alpha_mode, AlphaMode::opaque);
}

// ---------------------------------------------------------------------------------------------------- shapes

TEST_F(Pbrt, TrianglesFaceTheirNormals)
{
    const std::string normals = " \"normal N\" [ 0 0 -1 0 0 -1 0 0 -1 ]";
    const auto z_of = [](const Mesh& mesh) {
        const Vec3f a = mesh.positions[mesh.indices[0]], b = mesh.positions[mesh.indices[1]],
                    c = mesh.positions[mesh.indices[2]];
        return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    };
    const std::string mesh = std::string("Shape \"trianglemesh\" ") + triangle;
    EXPECT_GT(z_of(mesh_of(world(mesh))), 0);
    EXPECT_LT(z_of(mesh_of(world("ReverseOrientation " + mesh))), 0);
    EXPECT_LT(z_of(mesh_of(world(mesh + normals))), 0);
    EXPECT_GT(z_of(mesh_of(world("ReverseOrientation " + mesh + normals))), 0);
    EXPECT_EQ(mesh_of(world("ReverseOrientation " + mesh + normals)).normals.at(0).z, 1);
}

TEST_F(Pbrt, PlyMeshesAreReadOnce)
{
    write("a.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    const SceneDescription scene =
        world("Shape \"plymesh\" \"string filename\" \"a.ply\" Shape \"plymesh\" \"string filename\" \"a.ply\"");
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.nodes.size(), 2u);
    EXPECT_EQ(error("Shape \"plymesh\" \"string filename\" \"b.ply\"").find("line 2, column 1: "), 0u);
}

TEST_F(Pbrt, RoundShapes)
{
    EXPECT_EQ(
        std::get<Sphere>(shape_of(world("ReverseOrientation Shape \"sphere\" \"float radius\" 2")).geometry).radius,
        -2);
    EXPECT_EQ(std::get<Disk>(shape_of(world("Shape \"disk\" \"float radius\" 2 \"float height\" 1")).geometry).center.z,
              1);
    const auto area = [&](const std::string& text) {
        const SceneDescription scene = world("Shape " + text);
        const Mesh& mesh = mesh_of(scene);
        double sum = 0;
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            const auto p = [&](std::size_t k) {
                const Vec3f v = mesh.positions[mesh.indices[i + k]];
                return Vec3d{v.x, v.y, v.z};
            };
            const Vec3d n = cross(p(1) - p(0), p(2) - p(0));
            const Vec3f normal = mesh.normals[mesh.indices[i]];
            EXPECT_GT(n.x * normal.x + n.y * normal.y + n.z * normal.z, 0);
            sum += length(n) / 2;
        }
        return sum;
    };
    constexpr double pi = std::numbers::pi;
    EXPECT_NEAR(area("\"cylinder\" \"float radius\" 2 \"float zmin\" 0 \"float zmax\" 3"), 12 * pi, 0.01);
    EXPECT_NEAR(area("\"sphere\" \"float zmin\" 0"), 2 * pi, 0.01);
    EXPECT_NEAR(area("\"disk\" \"float innerradius\" 0.5 \"float phimax\" 180"), 0.375 * pi, 0.001);
    EXPECT_NEAR(area("\"bilinearmesh\" \"point3 P\" [ 0 0 0 2 0 0 0 3 0 2 3 0 ]"), 6, 1e-6);
}

TEST_F(Pbrt, CurvesAndSubdivision)
{
    const SceneDescription scene = world(
        R"(Shape "curve" "point3 P" [ 0 0 0 1 0 0 2 0 0 3 0 0 ] "float width0" 1 "float width1" 0.5 "string type" "cylinder")");
    const Curves& curves = scene.curves.at(0);
    EXPECT_EQ(curves.basis, CurveBasis::bezier);
    EXPECT_FALSE(curves.ribbons);
    EXPECT_EQ(curves.radii.front(), 0.5f);
    EXPECT_EQ(curves.radii.back(), 0.25f);
    EXPECT_EQ(world(R"(Shape "curve" "integer degree" 2 "point3 P" [ 0 0 0 1 2 0 2 0 0 ])").curves.at(0).points.size(),
              4u);
    // An octahedron's limit is nearly a ball, all alike around.
    const SceneDescription loop =
        world(R"(Shape "loopsubdiv" "integer levels" 3 "point3 P" [ 1 0 0 -1 0 0 0 1 0 0 -1 0 0 0 1 0 0 -1 ]
"integer indices" [ 0 2 4 2 1 4 1 3 4 3 0 4 2 0 5 1 2 5 3 1 5 0 3 5 ])");
    const Mesh& mesh = mesh_of(loop);
    EXPECT_EQ(mesh.indices.size(), 3u * 8 * 64);
    const auto radius = [&](std::size_t i) {
        return std::hypot(mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z);
    };
    // Of a corner of valence 4: the limit's weights are 1/2 of itself where its neighbours cancel out.
    EXPECT_NEAR(radius(0), radius(4), 1e-6);
    EXPECT_GT(radius(0), 0.4);
    EXPECT_LT(radius(0), 0.8);
}

}  // namespace
}  // namespace fathom::test
