#include <cmath>
#include <cstring>
#include <numbers>

#include "import/common/spectra.h"
#include "import_test_helpers.h"
#include "scene/conductors.h"

#include <fmt/format.h>
#include <zlib.h>

namespace fathom::test {
namespace {

constexpr double degree = std::numbers::pi / 180;

class Mitsuba : public ImportTest {
protected:
    static std::string scene_of(const std::string& inside)
    {
        return "<scene version=\"3.0.0\">\n" + inside + "\n</scene>";
    }
    SceneDescription read(const std::string& inside) { return load("a.xml", scene_of(inside)); }
    std::string error(const std::string& inside) { return error_of("a.xml", scene_of(inside)); }
    bool is_told(const std::string& words) const
    {
        for (const auto& [message, times] : warnings_.counts())
            if (message.find(words) != std::string::npos) return true;
        return false;
    }
    /// Of the only shape.
    static const Material& material_of(const SceneDescription& scene)
    {
        for (const Node& node : scene.nodes)
            for (const Shape& shape : node.shapes) return scene.materials.at(std::size_t(shape.material));
        throw std::runtime_error("no shape");
    }
    Material bsdf(const std::string& xml) { return material_of(read("<shape type=\"sphere\">" + xml + "</shape>")); }
    static const Camera& camera_of(const SceneDescription& scene) { return scene.cameras.at(0); }
    Camera sensor(const std::string& inside)
    {
        return camera_of(read("<sensor type=\"perspective\">" + inside + "</sensor>"));
    }
};

constexpr const char* wide_film =
    R"(<film type="hdrfilm"><integer name="width" value="200"/><integer name="height" value="100"/></film>)";

void expect_color(const Color& c, double r, double g, double b, double tolerance = 1e-6)
{
    EXPECT_NEAR(c.r, r, tolerance);
    EXPECT_NEAR(c.g, g, tolerance);
    EXPECT_NEAR(c.b, b, tolerance);
}

// ---------------------------------------------------------------------------------------------------- the language

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
              "line 2, column 23: there is nothing with the id 'blue'");
    EXPECT_EQ(error(R"(<bsdf type="null" id="a"/><bsdf type="null" id="a"/>)").substr(0, 50),
              "line 2, column 28: the id 'a' is taken already: " + (folder_ / "a.xml").string().substr(0, 2));
}

TEST_F(Mitsuba, CyclesAndDamage)
{
    EXPECT_NE(error(R"(<include filename="a.xml"/>)").find("files include each other more than 15 deep"),
              std::string::npos);
    EXPECT_EQ(error(R"(<bsdf type="twosided" id="a"><ref id="a"/></bsdf><shape type="sphere"><ref id="a"/></shape>)"),
              "line 2, column 2: a bsdf can't contain itself");
    EXPECT_EQ(error(R"(<shape type="merge" id="a"><ref id="a"/></shape>)"),
              "line 2, column 2: a shape can't contain itself");
    EXPECT_EQ(error("<shape type=\"sphere\">").substr(0, 30), "line 3, column 3: no XML: Star");
    EXPECT_EQ(error_of("a.xml", "<html><scene/></html>"),
              "line 1: a Mitsuba scene begins with <scene version=\"...\">, found <html>");
    std::string deep;
    for (int i = 0; i < 200; ++i) deep += "<bsdf type=\"twosided\">";
    for (int i = 0; i < 200; ++i) deep += "</bsdf>";
    EXPECT_NE(error(deep).find("nested more than 100 deep"), std::string::npos);
    // Entities are not expanded.
    EXPECT_EQ(error_of("a.xml",
                       "<!DOCTYPE scene [<!ENTITY a \"1\">]><scene version=\"3.0.0\"><shape type=\"sphere\"><float "
                       "name=\"radius\" value=\"&a;\"/></shape></scene>")
                  .substr(0, 14),
              "line 1, column");
    EXPECT_EQ(error(R"(<shape type="sphere"><float name="radius" value="1x"/></shape>)"),
              "line 2, column 23: expected numbers, found '1x'");
}

TEST_F(Mitsuba, WhatNobodyReadsIsTold)
{
    read(
        R"(<shape type="sphere"><float name="radious" value="1"/><bsdf type="diffuse"><float name="gloss" value="1"/></bsdf></shape>
<shape type="torus"/><bsdf type="phong" id="p"/><shape type="disk"><ref id="p"/></shape><emitter type="directionalarea"/><volume type="x"/>)");
    EXPECT_TRUE(is_told("'radious' of shape 'sphere' is ignored"));
    EXPECT_TRUE(is_told("'gloss' of bsdf 'diffuse' is ignored"));
    EXPECT_TRUE(is_told("shape 'torus': is not known"));
    EXPECT_TRUE(is_told("bsdf 'phong' ('p'): is not known: grey diffuse"));
    EXPECT_TRUE(is_told("emitter 'directionalarea': is not known"));
    EXPECT_TRUE(is_told("volume 'x': is ignored"));
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

// ---------------------------------------------------------------------------------------------------- what is seen

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

/// Which side of the picture `fov` is of: a picture twice as wide as high.
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
    EXPECT_NEAR(fov(""), of_50_mm, 1e-9) << "unless anything is said";
}

/// Where the camera looks at a point of its picture, in pixels, over its way along the view axis.
std::array<double, 2> seen_at(const SceneDescription& scene, const Camera& c, double x, double y)
{
    const double width = *scene.hints.width, height = *scene.hints.height,
                 half = c.kind == CameraKind::orthographic ? c.height / 2 : std::tan(c.fov_y / 2);
    return {(2 * (x / width + c.shift_x) - 1) * half * width / height, (1 - 2 * (y / height - c.shift_y)) * half};
}

/// A part of the film is a picture of its own that shows what was there, of every kind of camera.
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
            const auto a = seen_at(part, part.cameras.at(0), x, y), b = seen_at(whole, whole.cameras[0], x + 30, y + 2);
            EXPECT_NEAR(a[0], b[0], 1e-12) << type;
            EXPECT_NEAR(a[1], b[1], 1e-12) << type;
        }
        if (type == std::string("orthographic")) continue;
        // So many widths to the right, and heights down: of the film, whatever the crop.
        const std::string offset = R"(<float name="principal_point_offset_x" value="0.25"/>
<float name="principal_point_offset_y" value="0.1"/>)";
        for (const char* crop : {"", R"(<integer name="crop_width" value="10"/>)"}) {
            const SceneDescription plain = with(crop), shifted = with(crop, offset);
            const auto a = seen_at(shifted, shifted.cameras.at(0), 5, 7),
                       b = seen_at(plain, plain.cameras.at(0), 15, 9);
            EXPECT_NEAR(a[0], b[0], 1e-12);
            EXPECT_NEAR(a[1], b[1], 1e-12);
        }
    }
    EXPECT_TRUE(warnings_.empty());
    EXPECT_NE(error_of("c.xml", R"(<scene version="3.0.0"><sensor type="perspective"><film type="hdrfilm">
<integer name="width" value="40"/><integer name="crop_offset_x" value="33"/><integer name="crop_width" value="8"/></film></sensor></scene>)")
                  .find("the crop of 8x576 from 33, 0 on is not within the film of 40x576"),
              std::string::npos);
}

/// Those that measure another's picture stand around it.
TEST_F(Mitsuba, NestedIntegrators)
{
    const SceneDescription scene = read(R"(<integrator type="moment"><integrator type="path">
<integer name="max_depth" value="3"/></integrator></integrator>)");
    EXPECT_EQ(scene.hints.max_depth, 2);
    EXPECT_TRUE(is_told("the integrator in it"));
    EXPECT_EQ(read(R"(<integrator type="direct"/>)").hints.max_depth, 1) << "light comes by one surface";
}

TEST_F(Mitsuba, Settings)
{
    const SceneDescription scene = read(R"(<integrator type="path"><integer name="max_depth" value="8"/></integrator>
<sensor type="thinlens"><float name="aperture_radius" value="0.5"/><float name="focus_distance" value="3"/>
<sampler type="independent"><integer name="sample_count" value="16"/></sampler><film type="hdrfilm"><integer name="width" value="20"/>
<integer name="height" value="10"/><rfilter type="box"/></film></sensor>)");
    // The eighth way leads to the light; seven surfaces scatter.
    EXPECT_EQ(scene.hints.max_depth, 7);
    EXPECT_EQ(scene.hints.samples, 16);
    EXPECT_EQ(scene.hints.width, 20);
    EXPECT_EQ(scene.hints.height, 10);
    EXPECT_EQ(scene.hints.filter, "box");
    EXPECT_EQ(camera_of(scene).aperture, 1);
    EXPECT_EQ(camera_of(scene).focus_distance, 3);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(Mitsuba, OldNames)
{
    const SceneDescription scene =
        load("a.xml", R"(<scene version="0.6.0"><sensor type="perspective"><string name="fovAxis" value="y"/>
<float name="fov" value="50"/><transform name="toWorld"><lookAt origin="0,0,5" target="0,0,0" up="0,1,0"/></transform></sensor></scene>)");
    EXPECT_NEAR(camera_of(scene).fov_y, 50 * degree, 1e-12);
    expect_near(camera_of(scene).position, {0, 0, 5});
}

// ---------------------------------------------------------------------------------------------------- shapes

TEST_F(Mitsuba, Rectangles)
{
    const auto normal = [&](const std::string& said) {
        const SceneDescription scene = read("<shape type=\"rectangle\">" + said + "</shape>");
        const auto& r = std::get<Rectangle>(scene.nodes.at(0).shapes.at(0).geometry);
        EXPECT_EQ(length(r.edge_u), 2);
        return normalize(cross(r.edge_u, r.edge_v));
    };
    expect_near(normal(""), {0, 0, 1});
    expect_near(normal(R"(<boolean name="flip_normals" value="true"/>)"), {0, 0, -1});
    // With a picture: a mesh, whose first row of it is at y = -1.
    write("t.png", "x");
    const SceneDescription scene =
        read(R"(<shape type="rectangle"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">
<string name="filename" value="t.png"/></texture></bsdf></shape>)");
    const Mesh& mesh = scene.meshes.at(0);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(mesh.uvs[0][i].x, (mesh.positions[i].x + 1) / 2);
        EXPECT_EQ(mesh.uvs[0][i].y, (mesh.positions[i].y + 1) / 2);
    }
}

TEST_F(Mitsuba, ModelsTurnPicturesAsMitsubaDoes)
{
    write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0.25\nf 1/1 2/1 3/1\nf 1/1 3/1 4/1\n");
    write("a.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty "
          "float u\n"
          "property float v\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0.25\n1 0 0 0 "
          "0.25\n"
          "0 1 0 0 0.25\n3 0 1 2\n");
    const auto v = [&](const char* type, const std::string& said) {
        const SceneDescription scene =
            read(fmt::format("<shape type=\"{0}\"><string name=\"filename\" value=\"a.{0}\"/>{1}</shape>", type, said));
        return scene.meshes.at(0).uvs[0].at(0).y;
    };
    EXPECT_EQ(v("obj", ""), 0.75f);
    EXPECT_EQ(v("obj", R"(<boolean name="flip_tex_coords" value="false"/>)"), 0.25f);
    EXPECT_EQ(v("ply", ""), 0.25f);
    EXPECT_EQ(v("ply", R"(<boolean name="flip_tex_coords" value="true"/>)"), 0.75f);
}

/// Meshes without normals are smooth unless they are said not to be.
TEST_F(Mitsuba, NormalsOfMeshes)
{
    // A roof of two triangles that share an edge along y, of slopes 1 and 0.
    write("a.obj", "v 0 0 0\nv 0 1 0\nv -1 0 1\nv 1 0 0\nf 1 2 3\nf 1 4 2\n");
    const auto mesh = [&](const std::string& said) {
        return read(R"(<shape type="obj"><string name="filename" value="a.obj"/>)" + said + "</shape>").meshes.at(0);
    };
    const Mesh smooth = mesh("");
    ASSERT_EQ(smooth.normals.size(), smooth.positions.size());
    // At the first vertex both faces have a right angle.
    const double n = std::sqrt(0.5), x = n, z = n + 1, l = std::hypot(x, z);
    EXPECT_NEAR(smooth.normals[0].x, x / l, 1e-6);
    EXPECT_NEAR(smooth.normals[0].z, z / l, 1e-6);
    EXPECT_TRUE(mesh(R"(<boolean name="face_normals" value="true"/>)").normals.empty());
    const Mesh flipped = mesh(R"(<boolean name="flip_normals" value="true"/>)");
    EXPECT_NEAR(flipped.normals[0].z, -z / l, 1e-6);
    EXPECT_EQ(flipped.indices[1], smooth.indices[2]);
}

/// Attributes of vertices and of faces by their names, as numbers and as colours.
TEST_F(Mitsuba, AttributesOfMeshes)
{
    // Two triangles that share an edge.
    write("a.ply",
          "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty "
          "float heat_x\nproperty float color_0\nproperty float color_1\nproperty float color_2\nelement face 2\n"
          "property list uchar int vertex_indices\nproperty float weight_0\nproperty float paint_r\nproperty float "
          "paint_g\nproperty float paint_b\nend_header\n0 0 0 0.5 1 2 3\n1 0 0 0.5 1 2 3\n1 1 0 0.5 1 2 3\n0 1 1 0.5 1 "
          "2 3\n3 0 1 2 0.25 0.1 0.2 0.3\n3 0 2 3 0.75 0.4 0.5 0.6\n");
    const auto mesh = [&](const std::string& name) {
        return read(R"(<shape type="ply"><string name="filename" value="a.ply"/><bsdf type="diffuse"><texture
type="mesh_attribute" name="reflectance"><string name="name" value=")" +
                    name + R"("/></texture></bsdf></shape>)")
            .meshes.at(0);
    };
    const auto expect = [&](const Mesh& m, std::size_t corner, Vec3f color) {
        const Vec4f& c = m.colors.at(m.indices.at(corner));
        EXPECT_EQ(c.x, color.x) << corner;
        EXPECT_EQ(c.y, color.y) << corner;
        EXPECT_EQ(c.z, color.z) << corner;
    };
    const Mesh weight = mesh("face_weight"), paint = mesh("face_paint_color");
    for (std::size_t i = 0; i < 6; ++i) {
        const float w = i < 3 ? 0.25f : 0.75f;
        expect(weight, i, {w, w, w});
        expect(paint, i, i < 3 ? Vec3f{0.1f, 0.2f, 0.3f} : Vec3f{0.4f, 0.5f, 0.6f});
        expect(mesh("vertex_heat"), i, {0.5f, 0.5f, 0.5f});
        expect(mesh("vertex_color"), i, {1, 2, 3});
    }
    // Normals are those of the shared edge.
    const auto normal_x = [&](std::size_t corner) { return weight.normals.at(weight.indices[corner]).x; };
    EXPECT_EQ(normal_x(0), normal_x(3));
    EXPECT_NE(normal_x(0), normal_x(1));
    EXPECT_TRUE(warnings_.empty());
    EXPECT_TRUE(mesh("face_color").colors.empty());
    EXPECT_TRUE(is_told("the mesh has no 'face_color'"));
}

TEST_F(Mitsuba, InstancesShareTheirGroup)
{
    const SceneDescription scene =
        read(R"(<shape type="shapegroup" id="g"><shape type="sphere"/><shape type="disk"/></shape>
<shape type="instance"><ref id="g"/><transform name="to_world"><translate x="1"/></transform></shape>
<shape type="instance"><ref id="g"/></shape>)");
    ASSERT_EQ(scene.roots.size(), 2u) << "the group itself is not seen";
    const auto& a = scene.nodes.at(std::size_t(scene.roots[0]));
    const auto& b = scene.nodes.at(std::size_t(scene.roots[1]));
    EXPECT_EQ(a.children.size(), 2u);
    EXPECT_EQ(a.children, b.children);
    EXPECT_EQ(scene.nodes.size(), 4u);
    EXPECT_EQ(error(R"(<shape type="instance"><shape type="sphere"/></shape>)"),
              "line 2, column 25: an instance is one of a 'shapegroup'");
}

TEST_F(Mitsuba, Cylinders)
{
    const SceneDescription scene =
        read(R"(<shape type="cylinder"><point name="p0" x="1" y="2" z="3"/><point name="p1" x="1" y="7" z="3"/>
<float name="radius" value="2"/></shape>)");
    const Transform& t = scene.nodes.at(0).parent_from_node;
    expect_near(t.point({0, 0, 0}), {1, 2, 3});
    expect_near(t.point({0, 0, 1}), {1, 7, 3});
    for (const Vec3f& p : scene.meshes.at(0).positions)
        EXPECT_NEAR(std::hypot(t.point({p.x, p.y, p.z}).x - 1, t.point({p.x, p.y, p.z}).z - 3), 2, 1e-6);
    EXPECT_GT(t.determinant(), 0);
}

TEST_F(Mitsuba, Curves)
{
    write("c.txt",
          "0 0 0 0.1\n1 0 0 0.1\n2 0 0 0.1\n3 0 0 0.2\n\n\n0 1 0 0.1\n1 1 0 0.1\n2 1 0 0.1\n3 1 0 0.1\n4 1 0 0.1\n");
    const SceneDescription scene =
        read(R"(<shape type="bsplinecurve"><string name="filename" value="c.txt"/></shape>)");
    EXPECT_EQ(scene.curves.at(0).counts, (std::vector<std::uint32_t>{4, 5}));
    EXPECT_EQ(scene.curves.at(0).radii[3], 0.2f);
    EXPECT_EQ(scene.curves.at(0).basis, CurveBasis::bspline);
}

// ---------------------------------------------------------------------------------------------------- serialized
// meshes

template <class T>
std::string raw(const std::vector<T>& values)
{
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string deflated(const std::string& bytes)
{
    uLongf size = compressBound(uLong(bytes.size()));
    std::string out(size, 0);
    compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
             uLong(bytes.size()));
    out.resize(size);
    return out;
}

/// Of one triangle each: floats with normals and uv; doubles.
std::string two_meshes(std::uint32_t last_index = 2)
{
    const std::string sign = {0x1c, 0x04, 4, 0};
    const std::string counts = raw(std::vector<std::uint64_t>{3, 1});
    const std::string indices = raw(std::vector<std::uint32_t>{0, 1, last_index});
    const std::string first = sign + deflated(raw(std::vector<std::uint32_t>{0x1003}) + std::string("ab\0", 3) +
                                              counts + raw(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}) +
                                              raw(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}) +
                                              raw(std::vector<float>{0, 0.25f, 1, 0, 0, 1}) + indices);
    const std::string second = sign + deflated(raw(std::vector<std::uint32_t>{0x2000}) + std::string(1, 0) + counts +
                                               raw(std::vector<double>{5, 0, 0, 6, 0, 0, 5, 1, 0}) + indices);
    return first + second + raw(std::vector<std::uint64_t>{0, first.size()}) + raw(std::vector<std::uint32_t>{2});
}

constexpr const char* of_serialized =
    R"(<shape type="serialized"><string name="filename" value="m.serialized"/><integer name="shape_index" value="{}"/></shape>)";

TEST_F(Mitsuba, SerializedMeshes)
{
    write("m.serialized", two_meshes());
    const SceneDescription scene =
        read(fmt::format(fmt::runtime(of_serialized), 0) + fmt::format(fmt::runtime(of_serialized), 1) +
             fmt::format(fmt::runtime(of_serialized), 0));
    ASSERT_EQ(scene.meshes.size(), 2u) << "a mesh that is used twice is there once";
    EXPECT_EQ(scene.meshes[0].name, "ab");
    EXPECT_EQ(scene.meshes[0].uvs[0].at(0).y, 0.25f);
    EXPECT_EQ(scene.meshes[0].normals.at(2).z, 1);
    EXPECT_EQ(scene.meshes[1].positions.at(1).x, 6);
    EXPECT_EQ(scene.meshes[1].indices, (std::vector<std::uint32_t>{0, 1, 2}));
}

/// A volume file of the distances of a function, by its numbers along x, y, z.
template <class Distance>
std::string volume_of(std::array<std::int32_t, 3> size, const Distance& distance)
{
    std::string bytes("VOL\3", 4);
    const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    for (const std::int32_t word : {1, size[0], size[1], size[2], 1}) add(word);
    for (const float side : {0.f, 0.f, 0.f, 1.f, 1.f, 1.f}) add(side);
    for (std::int32_t z = 0; z < size[2]; ++z)
        for (std::int32_t y = 0; y < size[1]; ++y)
            for (std::int32_t x = 0; x < size[0]; ++x)
                add(float(distance(Vec3d{x / double(size[0] - 1), y / double(size[1] - 1), z / double(size[2] - 1)})));
    return bytes;
}

/// Numbers along each axis of their own; the whole lies in the unit cube.
TEST_F(Mitsuba, GridsOfDistances)
{
    const Vec3d center{0.5, 0.45, 0.55};
    write("a.vol", volume_of({24, 30, 20}, [&](Vec3d p) { return length(p - center) - 0.3; }));
    const auto mesh = [&](const std::string& said) {
        return read(R"(<shape type="sdfgrid"><string name="filename" value="a.vol"/>)" + said + "</shape>")
            .meshes.at(0);
    };
    const Mesh smooth = mesh("");
    ASSERT_EQ(smooth.normals.size(), smooth.positions.size());
    const auto at = [&](std::size_t i) {
        const Vec3f p = smooth.positions[i];
        return Vec3d{p.x, p.y, p.z} - center;
    };
    for (std::size_t i = 0; i < smooth.positions.size(); ++i) {
        const Vec3f n = smooth.normals[i];
        // What is linear lies below what is curved: by at most an eighth of a cell's square over the two radii.
        EXPECT_NEAR(length(at(i)), 0.3, 2 / 0.3 / 8 / (19 * 19));
        EXPECT_GT(dot(normalize(at(i)), {n.x, n.y, n.z}), 0.998);
    }
    // Closed and turned outwards: what it holds is the ball's volume.
    double volume = 0;
    for (std::size_t i = 0; i < smooth.indices.size(); i += 3)
        volume += dot(at(smooth.indices[i]), cross(at(smooth.indices[i + 1]), at(smooth.indices[i + 2]))) / 6;
    EXPECT_NEAR(volume, 4 * std::numbers::pi / 3 * 0.027, 0.0024 * 4 * std::numbers::pi * 0.09);
    EXPECT_TRUE(mesh(R"(<string name="normals" value="analytic"/>)").normals.empty());
    EXPECT_TRUE(warnings_.empty());
}

/// Between numbers it is what is linear along each axis: of one cell with four corners inside, a saddle.
TEST_F(Mitsuba, CellsOfDistancesAreTrilinear)
{
    const auto saddle = [](Vec3d p) { return (p.x - 0.5) * (p.y - 0.5) + 0.25 * (p.z - 0.4); };
    write("a.vol", volume_of({2, 2, 2}, saddle));
    const Mesh mesh = read(R"(<shape type="sdfgrid"><string name="filename" value="a.vol"/></shape>)").meshes.at(0);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3d p{mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z};
        EXPECT_NEAR(saddle(p), 0, 1e-6);
        const Vec3d gradient = normalize({p.y - 0.5, p.x - 0.5, 0.25});
        const Vec3f n = mesh.normals[i];
        EXPECT_NEAR(dot(gradient, {n.x, n.y, n.z}), 1, 1e-6);
    }
}

TEST_F(Mitsuba, DamagedGridsOfDistances)
{
    const std::string good = volume_of({3, 3, 3}, [](Vec3d p) { return p.x - 0.4; });
    const auto told = [&](const std::string& bytes) {
        write("a.vol", bytes);
        return error(R"(<shape type="sdfgrid"><string name="filename" value="a.vol"/></shape>)");
    };
    EXPECT_EQ(told(good), "loaded");
    EXPECT_NE(told("VOL").find("this is no volume file"), std::string::npos);
    EXPECT_NE(told(good.substr(0, good.size() - 4)).find("104 bytes of numbers, not 108"), std::string::npos);
    EXPECT_NE(told(volume_of({3, 3, 3}, [](Vec3d) { return 1.0; })).find("there is no surface in it"),
              std::string::npos);
    EXPECT_NE(told(volume_of({3, 3, 3}, [](Vec3d p) { return 1 / (p.x - 0.5); })).find("not finite"),
              std::string::npos);
    std::string wide = good;
    wide[9] = 1;
    EXPECT_NE(told(wide).find("bytes of numbers"), std::string::npos);
}

TEST_F(Mitsuba, DamagedSerializedMeshes)
{
    const std::string asked = fmt::format(fmt::runtime(of_serialized), 1);
    write("m.serialized", two_meshes(3));
    EXPECT_NE(error(asked).find("mesh 1: has a triangle of vertex 3, but only 3 vertices"), std::string::npos)
        << error(asked);
    write("m.serialized", two_meshes());
    EXPECT_NE(error(fmt::format(fmt::runtime(of_serialized), 2)).find("there is no mesh 2"), std::string::npos);
    std::string file = two_meshes();
    write("m.serialized", file.substr(0, 20));
    EXPECT_NE(error(asked).find("list of meshes is damaged"), std::string::npos) << error(asked);
    file[0] = 'x';
    write("m.serialized", file);
    EXPECT_NE(error(asked).find("is no file of serialized meshes"), std::string::npos) << error(asked);
}

// ---------------------------------------------------------------------------------------------------- surfaces

TEST_F(Mitsuba, TexturesAsAlpha)
{
    const SceneDescription scene = read(R"(<shape type="sphere"><bsdf type="roughconductor">
<texture type="bitmap" name="alpha"><string name="filename" value="p.png"/></texture></bsdf></shape>)");
    const FloatInput& roughness = scene.materials.at(0).roughness;
    const Texture& curve = scene.textures.at(std::size_t(roughness.texture));
    ASSERT_EQ(curve.kind, TextureKind::ramp);
    for (const RampStop& stop : curve.stops) EXPECT_NEAR(stop.color.g, std::sqrt(double(stop.position)), 1e-6);
    EXPECT_TRUE(warnings_.empty());
}

/// Along u and along v, each by itself; of glass and plastic one is taken.
TEST_F(Mitsuba, TexturesAsTwoAlphas)
{
    const auto rough = [&](const char* type) {
        return read(fmt::format(R"(<shape type="sphere"><bsdf type="{}">
<texture type="checkerboard" name="alpha_u"/><float name="alpha_v" value="0.09"/></bsdf></shape>)",
                                type))
            .materials.at(0);
    };
    const Material m = rough("roughconductor");
    EXPECT_TRUE(m.two_roughnesses);
    EXPECT_GE(m.anisotropy.texture, 0) << "along u, where the tangent is";
    EXPECT_NEAR(m.roughness.value, 0.3, 1e-6);
    EXPECT_EQ(m.roughness.texture, -1);
    EXPECT_TRUE(warnings_.empty());
    EXPECT_FALSE(rough("roughdielectric").two_roughnesses);
    EXPECT_TRUE(is_told("glass is as rough along u"));
}

/// What comes from below as Mitsuba 3.9.1 has it, by what its roughplastic shows of bodies of two colours.
TEST_F(Mitsuba, InnerReflectanceOfRoughPlastic)
{
    const struct {
        const char* distribution;
        double ior, alpha, expected;
    } cases[] = {{"ggx", 1.49, 0.01, 0.5805},     {"ggx", 1.49, 0.4, 0.3426},     {"ggx", 1.9, 0.1, 0.7203},
                 {"beckmann", 1.49, 0.1, 0.5748}, {"beckmann", 1.9, 0.4, 0.6673}, {"beckmann", 1.9, 0.9, 0.4288}};
    for (const auto& c : cases) {
        const Material m = bsdf(fmt::format(R"(<bsdf type="roughplastic"><string name="distribution" value="{}"/>
<float name="int_ior" value="{}"/><float name="ext_ior" value="1"/><float name="alpha" value="{}"/></bsdf>)",
                                            c.distribution, c.ior, c.alpha));
        EXPECT_NEAR(m.inner_reflectance, c.expected, 0.0005) << c.distribution << ' ' << c.ior << ' ' << c.alpha;
        EXPECT_TRUE(m.separable);
    }
    EXPECT_LT(bsdf(R"(<bsdf type="plastic"/>)").inner_reflectance, 0);
}

TEST_F(Mitsuba, Conductors)
{
    const Material mirror = bsdf(R"(<bsdf type="conductor"/>)");
    EXPECT_EQ(mirror.metallic.value, 1);
    EXPECT_EQ(mirror.roughness.value, 0);
    expect_color(mirror.base_color.value, 1, 1, 1);
    const Material gold =
        bsdf(R"(<bsdf type="roughconductor"><string name="material" value="Au"/><float name="alpha" value="0.25"/>
<string name="distribution" value="ggx"/></bsdf>)");
    EXPECT_NEAR(gold.roughness.value, 0.5, 1e-6) << "alpha is the square of it";
    EXPECT_FALSE(gold.energy_compensation);
    EXPECT_GT(gold.base_color.value.r, 2 * gold.base_color.value.b);
    EXPECT_TRUE(warnings_.empty());
    const Material given = bsdf(R"(<bsdf type="conductor"><rgb name="eta" value="1.5"/><rgb name="k" value="2"/>
<rgb name="specular_reflectance" value="0.2 0.4 0.6"/></bsdf>)");
    EXPECT_NEAR(given.base_color.value.g, conductor_reflectance(1, 1.5, 2), 1e-6);
    // Left of all that it reflects, at every angle.
    EXPECT_EQ(given.coat_ior, 1);
    EXPECT_EQ(given.coat.value, 1);
    expect_color(given.coat_color.value, 0.2, 0.4, 0.6);
}

/// They may be above 1, also as spectra.
TEST_F(Mitsuba, IndicesOfConductors)
{
    const Material m = bsdf(R"(<bsdf type="conductor"><spectrum name="eta" value="0.789"/>
<spectrum name="k" value="400:6.15, 700:6.15"/></bsdf>)");
    EXPECT_NEAR(m.base_color.value.r, conductor_reflectance(1, 0.789, 6.15), 1e-2);
    EXPECT_NEAR(m.base_color.value.b, conductor_reflectance(1, 0.789, 6.15), 1e-2);
}

TEST_F(Mitsuba, AnisotropicConductors)
{
    const auto rough = [&](const char* u, const char* v) {
        return bsdf(
            fmt::format(R"(<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha_u"
 value="{}"/><float name="alpha_v" value="{}"/></bsdf>)",
                        u, v));
    };
    const auto check = [](const Material& m, double turned) {
        const double narrow = m.roughness.value * m.roughness.value, a = m.anisotropy.value;
        EXPECT_NEAR(narrow, 0.04, 1e-6);
        EXPECT_NEAR(narrow + (1 - narrow) * a * a, 0.36, 1e-6);
        EXPECT_NEAR(m.anisotropy_rotation, turned, 1e-12);
    };
    check(rough("0.36", "0.04"), 0);
    check(rough("0.04", "0.36"), std::numbers::pi / 2);
}

/// Beckmann's unless another is named.
TEST_F(Mitsuba, DistributionsOfFacets)
{
    for (const char* type : {"roughconductor", "roughdielectric", "roughplastic"}) {
        const Material m = bsdf(fmt::format(R"(<bsdf type="{}"><float name="alpha" value="0.09"/></bsdf>)", type));
        EXPECT_TRUE(m.beckmann) << type;
        EXPECT_NEAR(m.roughness.value, 0.3, 1e-6) << type;
        EXPECT_FALSE(
            bsdf(fmt::format(R"(<bsdf type="{}"><string name="distribution" value="ggx"/></bsdf>)", type)).beckmann)
            << type;
    }
}

TEST_F(Mitsuba, Dielectrics)
{
    const Material glass =
        bsdf(R"(<bsdf type="dielectric"><string name="int_ior" value="water"/><float name="ext_ior" value="1"/>
<rgb name="specular_transmittance" value="0.5"/></bsdf>)");
    EXPECT_EQ(glass.kind, MaterialKind::glass);
    EXPECT_NEAR(glass.ior, 1.333, 1e-6);
    expect_color(glass.transmission_color.value, 0.25, 0.25, 0.25);
    EXPECT_NEAR(bsdf(R"(<bsdf type="dielectric"/>)").ior, 1.5046 / 1.000277, 1e-6);
    const Material thin = bsdf(R"(<bsdf type="thindielectric"/>)");
    EXPECT_TRUE(thin.thin);
    EXPECT_NE(
        error(R"(<shape type="sphere"><bsdf type="dielectric"><string name="int_ior" value="watr"/></bsdf></shape>)")
            .find("did you mean 'water'?"),
        std::string::npos);
}

TEST_F(Mitsuba, Plastic)
{
    const Material m = bsdf(
        R"(<bsdf type="roughplastic"><rgb name="diffuse_reflectance" value="0.1 0.2 0.3"/><float name="alpha" value="0.09"/>
<string name="distribution" value="ggx"/><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/>
<boolean name="nonlinear" value="true"/></bsdf>)");
    expect_color(m.base_color.value, 0.1, 0.2, 0.3);
    EXPECT_EQ(m.kind, MaterialKind::plastic);
    EXPECT_NEAR(m.roughness.value, 0.3, 1e-6);
    EXPECT_EQ(m.ior, 1.5f);
    EXPECT_TRUE(m.nonlinear);
    EXPECT_FALSE(m.energy_compensation);
    const Material smooth = bsdf(R"(<bsdf type="plastic"/>)");
    EXPECT_EQ(smooth.roughness.value, 0);
    EXPECT_FALSE(smooth.nonlinear);
}

TEST_F(Mitsuba, Hair)
{
    const Material usual = bsdf(R"(<bsdf type="hair"/>)");
    EXPECT_EQ(usual.kind, MaterialKind::hair);
    EXPECT_EQ(usual.eumelanin, 1.3f);
    EXPECT_EQ(usual.pheomelanin, 0.2f);
    EXPECT_NEAR(usual.hair_ior, 1.55 / 1.000277, 1e-6);
    EXPECT_NEAR(usual.scale_tilt, 2 * std::numbers::pi / 180, 1e-9);
    const Material m = bsdf(
        R"(<bsdf type="hair"><float name="longitudinal_roughness" value="0.2"/><float name="scale_tilt" value="4"/>
<float name="azimuthal_roughness" value="0.4"/><float name="int_ior" value="1.5"/><float name="ext_ior" value="1.25"/>
<rgb name="sigma_a" value="0.1 0.2 0.3"/><float name="scale" value="5"/></bsdf>)");
    EXPECT_EQ(m.beta_m.value, 0.2f);
    EXPECT_EQ(m.beta_n.value, 0.4f);
    EXPECT_NEAR(m.scale_tilt, 4 * std::numbers::pi / 180, 1e-9);
    EXPECT_NEAR(m.hair_ior, 1.2, 1e-6);
    expect_color(m.absorption.value, 0.5, 1, 1.5);
    expect_color(m.base_color.value, 1, 1, 1);
    EXPECT_EQ(m.eumelanin, 0);
    EXPECT_EQ(bsdf(R"(<bsdf type="hair"><float name="eumelanin" value="0.5"/></bsdf>)").pheomelanin, 0.2f);
    expect_color(bsdf(R"(<bsdf type="hair"><rgb name="sigma_a" value="3 4 5"/></bsdf>)").absorption.value, 3, 4, 5);
}

TEST_F(Mitsuba, MasksAndNothing)
{
    const Material mask =
        bsdf(R"(<bsdf type="mask"><float name="opacity" value="0.25"/><bsdf type="diffuse"/></bsdf>)");
    EXPECT_EQ(mask.alpha_mode, AlphaMode::blend);
    EXPECT_EQ(mask.alpha.value, 0.25f);
    const Material none = bsdf(R"(<bsdf type="null"/>)");
    EXPECT_EQ(none.alpha_mode, AlphaMode::blend);
    EXPECT_EQ(none.alpha.value, 0);
}

TEST_F(Mitsuba, Blends)
{
    const char* const both =
        R"(<bsdf type="diffuse"><rgb name="reflectance" value="1 0 0"/></bsdf><bsdf type="conductor">
<string name="material" value="none"/></bsdf>)";
    const SceneDescription scene = read(fmt::format(
        R"(<shape type="sphere"><bsdf type="blendbsdf"><float name="weight" value="0.25"/>{}</bsdf></shape>)", both));
    const Material& m = material_of(scene);
    EXPECT_EQ(m.kind, MaterialKind::mix);
    EXPECT_EQ(m.factor.value, 0.25f);
    EXPECT_EQ(scene.materials.at(std::size_t(m.material_a)).kind, MaterialKind::diffuse);
    EXPECT_EQ(scene.materials.at(std::size_t(m.material_b)).metallic.value, 1);
    // Nothing and something: how much of it lets light pass.
    const auto alpha = [&](const char* first, const char* second) {
        return bsdf(
                   fmt::format(
                       R"(<bsdf type="blendbsdf"><float name="weight" value="0.25"/><bsdf type="{}"/><bsdf type="{}"/></bsdf>)",
                       first, second))
            .alpha.value;
    };
    EXPECT_EQ(alpha("null", "diffuse"), 0.25f);
    EXPECT_EQ(alpha("diffuse", "null"), 0.75f);
}

/// Without 'twosided' a bsdf that only reflects is black on its back.
TEST_F(Mitsuba, Sides)
{
    EXPECT_TRUE(bsdf(R"(<bsdf type="diffuse"/>)").black_behind);
    EXPECT_FALSE(bsdf(R"(<bsdf type="dielectric"/>)").black_behind);
    EXPECT_FALSE(bsdf(R"(<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>)").black_behind);
    EXPECT_TRUE(bsdf(R"(<bsdf type="mask"><bsdf type="diffuse"/></bsdf>)").black_behind);
    EXPECT_FALSE(bsdf(R"(<bsdf type="twosided"><bsdf type="mask"><bsdf type="diffuse"/></bsdf></bsdf>)").black_behind);
    const SceneDescription scene = read(
        R"(<bsdf type="diffuse" id="a"/><shape type="sphere"><ref id="a"/></shape><shape type="sphere"><bsdf type="twosided">
<ref id="a"/><bsdf type="diffuse"><rgb name="reflectance" value="1 0 0"/></bsdf></bsdf></shape>)");
    const auto of_shape = [&](std::size_t i) -> const Material& {
        return scene.materials.at(std::size_t(scene.nodes.at(std::size_t(scene.roots.at(i))).shapes.at(0).material));
    };
    EXPECT_TRUE(of_shape(0).black_behind);
    EXPECT_EQ(of_shape(1).kind, MaterialKind::two_sided);
    for (const int part : {of_shape(1).material_a, of_shape(1).material_b})
        EXPECT_FALSE(scene.materials.at(std::size_t(part)).black_behind);
    expect_color(scene.materials.at(std::size_t(of_shape(1).material_b)).base_color.value, 1, 0, 0);
    // A lamp of no bsdf reflects nothing.
    expect_color(material_of(read(R"(<shape type="sphere"><emitter type="area"/></shape>)")).base_color.value, 0, 0, 0);
}

/// Texture coordinates of shapes that are meshes where they have pictures, as Mitsuba tells them of these places.
/// By Mitsuba's poles, along z, go also facets that are drawn out.
TEST_F(Mitsuba, AnisotropicSpheres)
{
    const auto meshes = [&](const char* u, const char* v) {
        return read(fmt::format(R"(<shape type="sphere"><bsdf type="roughconductor"><float name="alpha_u" value="{}"/>
<float name="alpha_v" value="{}"/></bsdf></shape>)",
                                u, v))
            .meshes.size();
    };
    EXPECT_EQ(meshes("0.4", "0.1"), 1u);
    EXPECT_EQ(meshes("0.2", "0.2"), 0u);
}

TEST_F(Mitsuba, PicturesOnShapes)
{
    const auto uv_at = [&](const char* shape, Vec3f place) {
        const SceneDescription scene = read(fmt::format(
            R"(<shape type="{}"><bsdf type="diffuse"><texture type="checkerboard" name="reflectance"/></bsdf></shape>)",
            shape));
        const Mesh& mesh = scene.meshes.at(0);
        std::size_t nearest = 0;
        const auto distance = [&](std::size_t i) {
            const Vec3f p = mesh.positions[i];
            return std::hypot(p.x - place.x, p.y - place.y, p.z - place.z);
        };
        for (std::size_t i = 0; i < mesh.positions.size(); ++i)
            if (distance(i) < distance(nearest)) nearest = i;
        return mesh.uvs[0][nearest];
    };
    const auto expect_uv = [](Vec2f uv, float u, float v) {
        EXPECT_NEAR(uv.x, u, 0.005);
        EXPECT_NEAR(uv.y, v, 0.005);
    };
    expect_uv(uv_at("sphere", {0.3f, 0.4f, 0.86602545f}), 0.14758f, 0.16667f);
    expect_uv(uv_at("sphere", {-0.2f, -0.5f, 0.8426151f}), 0.68944f, 0.18101f);
    expect_uv(uv_at("disk", {0, -1, 0}), 1, 0.75f);
    expect_uv(uv_at("cube", {1, -1, -1}), 0, 1);  // of the face y = -1, the first
    expect_uv(uv_at("rectangle", {1, -1, 0}), 1, 0);
}

/// Of the straight way both absorption and scattering take: exp(-sigma_t way) is left.
TEST_F(Mitsuba, Interiors)
{
    const SceneDescription scene =
        read(R"(<shape type="sphere"><bsdf type="dielectric"/><medium type="homogeneous" name="interior">
<rgb name="sigma_t" value="1 2 4"/><rgb name="albedo" value="0 0.5 0"/><float name="scale" value="3"/></medium></shape>)");
    const Material& m = material_of(scene);
    const auto sigma = [&](float left) { return -std::log(left) / m.attenuation_distance; };
    EXPECT_NEAR(sigma(m.attenuation_color.r), 3, 1e-4);
    EXPECT_NEAR(sigma(m.attenuation_color.g), 6, 1e-4);
    EXPECT_NEAR(sigma(m.attenuation_color.b), 12, 1e-4);
    EXPECT_NEAR(m.transmission_scatter.g / m.attenuation_distance, 3, 1e-4);
}

/// Where the boundary is none.
TEST_F(Mitsuba, InteriorsBehindNull)
{
    constexpr const char* medium =
        R"(<medium type="homogeneous" name="interior"><float name="sigma_t" value="2"/></medium></shape>)";
    const SceneDescription scene = read(fmt::format(R"(<shape type="sphere"><bsdf type="null"/>{})", medium));
    const Material& m = material_of(scene);
    EXPECT_EQ(m.kind, MaterialKind::glass);
    EXPECT_EQ(m.ior, 1);
    EXPECT_NEAR(m.transmission_scatter.r / m.attenuation_distance, 2 * 0.75, 1e-4);
    EXPECT_TRUE(is_told("solid of index 1"));
    read(fmt::format(R"(<shape type="sphere"><bsdf type="diffuse"/>{})", medium));
    EXPECT_TRUE(is_told("not rendered in what is not glass"));
}

TEST_F(Mitsuba, Bitmaps)
{
    write("t.png", "x");
    const SceneDescription scene =
        read(R"(<shape type="sphere"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">
<string name="filename" value="t.png"/><string name="wrap_mode" value="mirror"/><string name="filter_type" value="nearest"/>
<transform name="to_uv"><scale x="3" y="5"/></transform></texture></bsdf></shape>)");
    const Texture& t = scene.textures.at(std::size_t(material_of(scene).base_color.texture));
    EXPECT_EQ(t.color_space, ColorSpace::srgb);
    EXPECT_EQ(t.wrap_u, Wrap::mirror);
    EXPECT_TRUE(t.nearest);
    EXPECT_EQ(t.uv_scale.x, 3);
    EXPECT_EQ(t.uv_scale.y, 5);
}

TEST_F(Mitsuba, BumpsAreHeights)
{
    const std::string map = R"(<bsdf type="bumpmap"><texture type="checkerboard"/><float name="scale" value="0.25"/>)";
    const Material m = bsdf(map + R"(<bsdf type="diffuse"/></bsdf>)");
    EXPECT_GE(m.bump.texture, 0);
    EXPECT_EQ(m.bump.value, 0.25f);
    EXPECT_LT(m.normal_texture, 0);
    EXPECT_TRUE(warnings_.counts().empty());
    bsdf(map + R"(<bsdf type="blendbsdf"><float name="weight" value="0.5"/>
<bsdf type="diffuse"/><bsdf type="conductor"/></bsdf></bsdf>)");
    EXPECT_FALSE(warnings_.counts().empty());
}

// ---------------------------------------------------------------------------------------------------- light

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
    // Lights shine along -z here.
    expect_near(node_of(1).parent_from_node.vector({0, 0, -1}), {0, -1, 0});
    EXPECT_NEAR(scene.lights.at(1).outer_angle, 40 * degree, 1e-12);
    EXPECT_NEAR(scene.lights.at(1).inner_angle, 30 * degree, 1e-12);
    EXPECT_EQ(scene.lights.at(1).falloff, SpotFalloff::linear);
    expect_near(normalize(node_of(2).parent_from_node.vector({0, 0, -1})), {0, -1, 0});
    expect_color(scene.lights.at(2).intensity, 7, 7, 7);
    expect_color(material_of(scene).emission.value, 4, 5, 6);
    // Without a bsdf it only shines.
    expect_color(material_of(scene).base_color.value, 0, 0, 0);
}

/// A projector's picture is upright for who looks along +z with +y up, a spot's is turned by half a turn.
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
    // White, through the diagonal of 35 mm film.
    const Light& plain = scene.lights.at(2);
    EXPECT_EQ(plain.picture.image, -1);
    expect_color(plain.intensity, std::numbers::pi, 2 * std::numbers::pi, 3 * std::numbers::pi, 1e-5);
    EXPECT_NEAR(plain.fov, 2 * std::atan(std::hypot(18, 12) / 50), 1e-12);
    EXPECT_EQ(plain.fov_axis, FovAxis::diagonal);

    scene = read(R"(<emitter type="spot"><texture type="checkerboard" name="texture"/></emitter>)");
    EXPECT_EQ(scene.lights.at(0).picture.image, -1);
    EXPECT_TRUE(is_told("a texture other than a bitmap is no picture for a light"));
    EXPECT_NE(error(R"(<emitter type="projector"><float name="fov" value="180"/></emitter>)").find("'fov' must be"),
              std::string::npos);
    EXPECT_NE(error(R"(<emitter type="projector"><string name="focal_length" value="-3mm"/></emitter>)")
                  .find("'focal_length'"),
              std::string::npos);
}

/// The picture's middle lies towards +z, what is right of it towards -x.
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
    // Mitsuba 3.9.1, of turbidity 3 at this height, which lies between those of the table.
    expect_color(sun.intensity, 2 * 1.4865, 2 * 1.2360, 2 * 0.9364, 0.02);
    for (const Node& node : scene.nodes)
        if (node.light == 0) expect_near(normalize(node.parent_from_node.vector({0, 0, -1})), {-0.6, -0.8, 0}, 1e-9);
}

/// As Mitsuba 3.9.1's `llvm_ad_rgb` gives them.
TEST(MitsubaSpectra, AsColours)
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

// ---------------------------------------------------------------------------------------------------- files by others

TEST(SharedMitsuba, AllScenesLoad)
{
    const std::filesystem::path folder = std::filesystem::path(FATHOM_SHARED_SCENES) / "mitsuba";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is missing";
    int scenes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        Warnings warnings;
        const SceneDescription scene = load_scene(entry.path() / "scene.xml", {}, warnings);
        EXPECT_EQ(scene.cameras.size(), 1u) << entry.path();
        EXPECT_GT(scene.roots.size(), 5u) << entry.path();
        for (const auto& [message, times] : warnings.counts())
            EXPECT_EQ(message.find("is not known"), std::string::npos) << message;
        ++scenes;
    }
    EXPECT_GT(scenes, 0);
}

}  // namespace
}  // namespace fathom::test
