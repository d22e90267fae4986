// SPDX-License-Identifier: Apache-2.0
// Tests of shapes in Mitsuba files.
#include <fmt/format.h>
#include <array>
#include <cmath>
#include <cstring>

#include "mitsuba_fixture.h"
#include "support/deflated.h"

namespace fathom::test {
namespace {

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
    // A textured rectangle becomes a mesh with the image's first row at y = -1.
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

/// Meshes without normals are smooth unless face_normals is set.
TEST_F(Mitsuba, NormalsOfMeshes)
{
    // The mesh is a roof of two triangles with slopes 1 and 0 that share an edge along y.
    write("a.obj", "v 0 0 0\nv 0 1 0\nv -1 0 1\nv 1 0 0\nf 1 2 3\nf 1 4 2\n");
    const auto mesh = [&](const std::string& said) {
        return read(R"(<shape type="obj"><string name="filename" value="a.obj"/>)" + said + "</shape>").meshes.at(0);
    };
    const Mesh smooth = mesh("");
    ASSERT_EQ(smooth.normals.size(), smooth.positions.size());
    // Both faces have a right angle at the first vertex, so their normals have equal weights.
    const double n = std::sqrt(0.5), x = n, z = n + 1, l = std::hypot(x, z);
    EXPECT_NEAR(smooth.normals[0].x, x / l, 1e-6);
    EXPECT_NEAR(smooth.normals[0].z, z / l, 1e-6);
    EXPECT_TRUE(mesh(R"(<boolean name="face_normals" value="true"/>)").normals.empty());
    const Mesh flipped = mesh(R"(<boolean name="flip_normals" value="true"/>)");
    EXPECT_NEAR(flipped.normals[0].z, -z / l, 1e-6);
    EXPECT_EQ(flipped.indices[1], smooth.indices[2]);
}

/// The sides that emit and reflect are those of Mitsuba 3.9.1: meshes with normals use their normals; other meshes use
/// the winding in world space (counterclockwise seen from the front); mirrored spheres are inside out.
TEST_F(Mitsuba, FrontsOfMirroredShapes)
{
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    write("plain.obj", corners + "f 1 2 3\n");
    write("up.obj", corners + "vn 0 0 1\nf 1//1 2//1 3//1\n");
    write("down.obj", corners + "vn 0 0 -1\nf 1//1 2//1 3//1\n");
    const std::string
        ply_head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n",
        face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    write("plain.ply", ply_head + face + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    write("up.ply", ply_head + "property float nx\nproperty float ny\nproperty float nz\n" + face +
                        "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n");
    // Fathom keeps the front of object space under mirroring nodes.
    const auto front = [&](const std::string& file, const std::string& said) {
        const Mesh mesh = read("<shape type=\"" + file.substr(file.size() - 3) +
                               R"("><string name="filename" value=")" + file + "\"/>" + said + "</shape>")
                              .meshes.at(0);
        const Vec3f a = mesh.positions[mesh.indices[0]], b = mesh.positions[mesh.indices[1]],
                    c = mesh.positions[mesh.indices[2]];
        const float z = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if (!mesh.normals.empty()) EXPECT_GT(z * mesh.normals[0].z, 0) << file << said;
        return z > 0 ? 1 : -1;
    };
    const std::string mirrored = R"(<transform name="to_world"><scale x="-1"/></transform>)",
                      turned = R"(<transform name="to_world"><rotate x="1" angle="180"/></transform>)",
                      flipped = R"(<boolean name="flip_normals" value="true"/>)",
                      faceted = R"(<boolean name="face_normals" value="true"/>)";
    for (const std::string type : {"obj", "ply"}) {
        for (const std::string& said : {std::string(), faceted, turned}) {
            EXPECT_EQ(front("plain." + type, said), 1) << type << said;
            EXPECT_EQ(front("plain." + type, said + flipped), -1) << type << said;
        }
        for (const std::string& said : {mirrored, mirrored + faceted}) {
            EXPECT_EQ(front("plain." + type, said), -1) << type << said;
            EXPECT_EQ(front("plain." + type, said + flipped), 1) << type << said;
        }
        EXPECT_EQ(front("up." + type, mirrored), 1);
        EXPECT_EQ(front("up." + type, mirrored + flipped), -1);
        EXPECT_EQ(front("up." + type, mirrored + faceted), -1);
        EXPECT_EQ(front("up." + type, mirrored + faceted + flipped), 1);
    }
    EXPECT_EQ(front("down.obj", ""), -1);
    EXPECT_EQ(front("down.obj", faceted), 1);
    // The file is used twice, the second time mirrored.
    const std::string plain = R"(<shape type="ply"><string name="filename" value="plain.ply"/>)";
    EXPECT_EQ(read(plain + "</shape>" + plain + mirrored + "</shape>").meshes.size(), 2u);
    const auto radius = [&](const std::string& said) {
        return std::get<Sphere>(read("<shape type=\"sphere\">" + said + "</shape>").nodes.at(0).shapes.at(0).geometry)
            .radius;
    };
    EXPECT_EQ(radius(turned), 1);
    EXPECT_EQ(radius(mirrored), -1);
    EXPECT_EQ(radius(mirrored + flipped), 1);
}

/// Attributes of vertices and faces are found by name, as numbers and as colors.
TEST_F(Mitsuba, AttributesOfMeshes)
{
    // The file has two triangles that share an edge.
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
    // Vertices of the shared edge keep their common normals.
    const auto normal_x = [&](std::size_t corner) { return weight.normals.at(weight.indices[corner]).x; };
    EXPECT_EQ(normal_x(0), normal_x(3));
    EXPECT_NE(normal_x(0), normal_x(1));
    EXPECT_TRUE(warnings_.empty());
    EXPECT_TRUE(mesh("face_color").colors.empty());
    EXPECT_TRUE(has_warning("the mesh has no 'face_color'"));
}

TEST_F(Mitsuba, InstancesShareTheirGroup)
{
    const SceneDescription scene =
        read(R"(<shape type="shapegroup" id="g"><shape type="sphere"/><shape type="disk"/></shape>
<shape type="instance"><ref id="g"/><transform name="to_world"><translate x="1"/></transform></shape>
<shape type="instance"><ref id="g"/></shape>)");
    ASSERT_EQ(scene.roots.size(), 2u) << "the group itself is not rendered";
    const auto& a = scene.nodes.at(std::size_t(scene.roots[0]));
    const auto& b = scene.nodes.at(std::size_t(scene.roots[1]));
    EXPECT_EQ(a.children.size(), 2u);
    EXPECT_EQ(a.children, b.children);
    EXPECT_EQ(scene.nodes.size(), 4u);
    EXPECT_EQ(error(R"(<shape type="instance"><shape type="sphere"/></shape>)"),
              "line 2, column 25: an instance must refer to a 'shapegroup'");
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

/// The points with u = 0 and u = 1/4 are those of Mitsuba 3.9.1, for axes in all directions.
TEST_F(Mitsuba, CylindersBeginWhereMitsubasDo)
{
    const struct {
        Vec3d axis, begin, quarter;
    } cases[] = {{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
                 {{0, 0, -1}, {1, 0, 0}, {0, -1, 0}},
                 {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
                 {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                 {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
                 {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
                 {{0.6, 0, 0.8}, {0.8, 0, -0.6}, {0, 1, 0}},
                 {{-0.48, 0.6, -0.64}, {0.859512, 0.17561, -0.48}, {-0.17561, -0.780488, -0.6}},
                 {{2, 3, -6}, {0.956044, -0.0659341, 0.285714}, {0.065934, -0.901099, -0.428571}}};
    for (const auto& c : cases) {
        const SceneDescription scene = read(fmt::format(
            R"(<shape type="cylinder"><point name="p1" value="{} {} {}"/></shape>)", c.axis.x, c.axis.y, c.axis.z));
        const Transform& t = scene.nodes.at(0).parent_from_node;
        expect_near(t.point({1, 0, 0}), c.begin, 1e-5);
        expect_near(t.point({0, 1, 0}), c.quarter, 1e-5);
        const Mesh& mesh = scene.meshes.at(0);
        EXPECT_EQ(mesh.uvs[0].at(0).x, 0);
        EXPECT_NEAR(mesh.positions.at(0).x, 1, 1e-6);
    }
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

// --------------------------------------------------------------------------------------------- serialized meshes

template <class T>
std::string raw_bytes(const std::vector<T>& values)
{
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A file of two meshes of one triangle: floats with normals and texture coordinates, and doubles.
std::string two_meshes(std::uint32_t last_index = 2)
{
    const std::string sign = {0x1c, 0x04, 4, 0};
    const std::string counts = raw_bytes(std::vector<std::uint64_t>{3, 1});
    const std::string indices = raw_bytes(std::vector<std::uint32_t>{0, 1, last_index});
    const std::string first = sign + deflated(raw_bytes(std::vector<std::uint32_t>{0x1003}) + std::string("ab\0", 3) +
                                              counts + raw_bytes(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}) +
                                              raw_bytes(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}) +
                                              raw_bytes(std::vector<float>{0, 0.25f, 1, 0, 0, 1}) + indices);
    const std::string second =
        sign + deflated(raw_bytes(std::vector<std::uint32_t>{0x2000}) + std::string(1, 0) + counts +
                        raw_bytes(std::vector<double>{5, 0, 0, 6, 0, 0, 5, 1, 0}) + indices);
    return first + second + raw_bytes(std::vector<std::uint64_t>{0, first.size()}) +
           raw_bytes(std::vector<std::uint32_t>{2});
}

constexpr const char* of_serialized =
    R"(<shape type="serialized"><string name="filename" value="m.serialized"/><integer name="shape_index" value="{}"/></shape>)";

TEST_F(Mitsuba, SerializedMeshes)
{
    write("m.serialized", two_meshes());
    const SceneDescription scene =
        read(fmt::format(fmt::runtime(of_serialized), 0) + fmt::format(fmt::runtime(of_serialized), 1) +
             fmt::format(fmt::runtime(of_serialized), 0));
    ASSERT_EQ(scene.meshes.size(), 2u) << "a mesh that is used twice is stored once";
    EXPECT_EQ(scene.meshes[0].name, "ab");
    EXPECT_EQ(scene.meshes[0].uvs[0].at(0).y, 0.25f);
    EXPECT_EQ(scene.meshes[0].normals.at(2).z, 1);
    EXPECT_EQ(scene.meshes[1].positions.at(1).x, 6);
    EXPECT_EQ(scene.meshes[1].indices, (std::vector<std::uint32_t>{0, 1, 2}));
}

/// A volume file with the values of a signed distance function on a grid of the given size along x, y, z.
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

/// Grids may have a different size along each axis; they fill the unit cube.
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
        // A linear patch lies below the curved surface by at most h^2 / 8 / radius along each axis.
        EXPECT_NEAR(length(at(i)), 0.3, 2 / 0.3 / 8 / (19 * 19));
        EXPECT_GT(dot(normalize(at(i)), {n.x, n.y, n.z}), 0.998);
    }
    // The mesh is closed and faces outwards: its volume is that of the ball.
    double volume = 0;
    for (std::size_t i = 0; i < smooth.indices.size(); i += 3)
        volume += dot(at(smooth.indices[i]), cross(at(smooth.indices[i + 1]), at(smooth.indices[i + 2]))) / 6;
    EXPECT_NEAR(volume, 4 * std::numbers::pi / 3 * 0.027, 0.0024 * 4 * std::numbers::pi * 0.09);
    EXPECT_TRUE(mesh(R"(<string name="normals" value="analytic"/>)").normals.empty());
    EXPECT_TRUE(warnings_.empty());
}

/// Inside a cell the distance is trilinear: one cell with four corners inside has a saddle.
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
    EXPECT_NE(told("VOL").find("this is not a volume file"), std::string::npos);
    EXPECT_NE(told(good.substr(0, good.size() - 4)).find("104 bytes of numbers, expected 108"), std::string::npos);
    EXPECT_NE(told(volume_of({3, 3, 3}, [](Vec3d) { return 1.0; })).find("it contains no surface"), std::string::npos);
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
    EXPECT_NE(error(asked).find("mesh 1: has a triangle with vertex 3, but only 3 vertices"), std::string::npos)
        << error(asked);
    write("m.serialized", two_meshes());
    EXPECT_NE(error(fmt::format(fmt::runtime(of_serialized), 2)).find("there is no mesh 2"), std::string::npos);
    std::string file = two_meshes();
    write("m.serialized", file.substr(0, 20));
    EXPECT_NE(error(asked).find("list of meshes is damaged"), std::string::npos) << error(asked);
    // The offset is so large that adding the header's length wraps around: only sanitizers detect the read.
    write("m.serialized", file.substr(0, file.size() - 12) + raw_bytes(std::vector<std::uint64_t>{~std::uint64_t(0)}) +
                              file.substr(file.size() - 4));
    EXPECT_NE(error(asked).find("list of meshes is damaged"), std::string::npos) << error(asked);
    file[0] = 'x';
    write("m.serialized", file);
    EXPECT_NE(error(asked).find("is not a file of serialized meshes"), std::string::npos) << error(asked);
}

}  // namespace
}  // namespace fathom::test
