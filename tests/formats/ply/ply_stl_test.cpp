// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "formats/import_test_helpers.h"
#include "formats/mesh/mesh_fault_counts.h"

namespace fathom::test {
namespace {

class Ply : public ImportTest {};
class Stl : public ImportTest {};

std::string header(const std::string& format, const std::string& vertex, const std::string& face, int vertices = 4,
                   int faces = 1)
{
    return fmt::format("ply\nformat {} 1.0\ncomment made by hand\nelement vertex {}\n{}element face {}\n{}end_header\n",
                       format, vertices, vertex, faces, face);
}
const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string indices = "property list uchar int vertex_indices\n";

template <class T>
void append(std::string& bytes, T value, bool big)
{
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof value);
    if (big) std::reverse(raw, raw + sizeof raw);
    bytes.append(raw, sizeof raw);
}

TEST_F(Ply, Ascii)
{
    const SceneDescription scene =
        load("a.ply", header("ascii", xyz, indices) + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(scene.meshes[0].positions[2].y, 1);
    EXPECT_EQ(scene.nodes[0].shapes[0].material, -1);
    EXPECT_TRUE(warnings_.empty());
}

/// Vertex attributes in Mitsuba's style are linear numbers, not display bytes.
TEST_F(Ply, LinearColors)
{
    std::string bytes = header("binary_little_endian",
                               "property float x\nproperty float y\nproperty float z\n"
                               "property float color_0\nproperty float color_1\nproperty float color_2\n",
                               "property list uchar int vertex_indices\n", 3, 1);
    for (int i = 0; i < 3; ++i)
        for (float x : {float(i == 1), float(i == 2), 0.f, 0.25f, 0.5f, 0.75f}) append(bytes, x, false);
    bytes += char(3);
    for (int i : {0, 1, 2}) append(bytes, i, false);
    const Mesh mesh = load("a.ply", bytes).meshes.at(0);
    ASSERT_EQ(mesh.colors.size(), 3u);
    EXPECT_EQ(mesh.colors[1].x, 0.25f);
    EXPECT_EQ(mesh.colors[2].z, 0.75f);
    EXPECT_EQ(mesh.colors[2].w, 1.f);
}

/// A square and a triangle that share an edge, with colors per face as MeshLab writes them.
constexpr const char* colored_faces = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 0\n255 0 0 128 4 0 1 2 3\n0 0 255 255 3 1 4 2\n";
const std::string face_bytes = "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";

TEST_F(Ply, ColorsOfFaces)
{
    const SceneDescription scene = load("a.ply", header("ascii", xyz, face_bytes + indices, 5, 2) + colored_faces);
    const Mesh& mesh = scene.meshes.at(0);
    ASSERT_EQ(mesh.indices.size(), 9u);
    ASSERT_EQ(mesh.colors.size(), mesh.positions.size());
    EXPECT_EQ(mesh.positions.size(), 7u) << "two vertices are doubled";
    const float red_of[] = {1, 1, 0};
    for (std::size_t i = 0; i < 9; ++i) {
        const Vec4f& c = mesh.colors[mesh.indices[i]];
        EXPECT_EQ(c.x, red_of[i / 3]) << i;
        EXPECT_EQ(c.z, 1 - red_of[i / 3]) << i;
        EXPECT_FLOAT_EQ(c.w, i < 6 ? 128 / 255.f : 1) << i;
    }
    EXPECT_EQ(mesh.positions[mesh.indices[7]].x, 2);
    EXPECT_TRUE(scene.materials.at(0).use_vertex_color);
}

TEST_F(Ply, ColorsOfVerticesGoBeforeThoseOfFaces)
{
    const std::string text = header("ascii", xyz + "property uchar red\n", "property uchar blue\n" + indices, 3, 1) +
                             "0 0 0 0\n1 0 0 0\n1 1 0 0\n0 3 0 1 2\n";
    const Mesh mesh = load("a.ply", text).meshes.at(0);
    ASSERT_EQ(mesh.colors.size(), 3u);
    EXPECT_EQ(mesh.colors[0].x, 0);
    EXPECT_EQ(mesh.colors[0].z, 1);
}

TEST_F(Ply, BothByteOrdersWithEverything)
{
    for (bool big : {false, true}) {
        std::string bytes = header(
            big ? "binary_big_endian" : "binary_little_endian",
            "property double x\nproperty float y\nproperty short z\nproperty float quality\n"
            "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n",
            "property uchar flags\nproperty list ushort uint vertex_index\nproperty list uchar float extra\n", 3, 1);
        // An unknown element lies between the known ones.
        bytes.replace(bytes.find("element face"), 0, "element thing 2\nproperty list uchar int a\nproperty float b\n");
        for (int i = 0; i < 3; ++i) {
            append(bytes, double(i == 1), big);
            append(bytes, float(i == 2), big);
            append(bytes, std::int16_t(-3), big);
            append(bytes, 99.f, big);
            for (float n : {0.f, 0.f, 1.f}) append(bytes, n, big);
            append(bytes, 0.25f, big);
            append(bytes, 0.75f, big);
            for (int c : {255, 0, 188, 51}) bytes += char(c);
        }
        for (int i = 0; i < 2; ++i) {
            bytes += char(i);
            for (int k = 0; k < i; ++k) append(bytes, 7, big);
            append(bytes, 1.f, big);
        }
        bytes += char(1);
        append(bytes, std::uint16_t(3), big);
        for (std::uint32_t i : {2u, 0u, 1u}) append(bytes, i, big);
        bytes += char(1);
        append(bytes, 1.f, big);

        const SceneDescription scene = load("a.ply", bytes);
        const Mesh& mesh = scene.meshes.at(0);
        EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{2, 0, 1}));
        EXPECT_EQ(mesh.positions.at(1).x, 1);
        EXPECT_EQ(mesh.positions.at(2).y, 1);
        EXPECT_EQ(mesh.positions.at(0).z, -3);
        EXPECT_EQ(mesh.normals.at(2).z, 1);
        EXPECT_EQ(mesh.uvs[0].at(0).x, 0.25f);
        EXPECT_EQ(mesh.uvs[0].at(0).y, 0.25f);
        EXPECT_FLOAT_EQ(mesh.colors.at(0).x, 1);
        EXPECT_NEAR(mesh.colors.at(0).z, 0.5029f, 1e-4);  // the file has the sRGB code 188
        EXPECT_FLOAT_EQ(mesh.colors.at(0).w, 0.2f);
        EXPECT_TRUE(scene.materials.at(0).use_vertex_color);
    }
}

TEST_F(Ply, FastAndGeneralReadersAgree)
{
    // An extra property makes faces use the general code path.
    const auto make = [&](bool extra) {
        std::string bytes = header("binary_little_endian", xyz, (extra ? "property uchar skip\n" : "") + indices, 5, 3);
        for (float x : {0.f, 0.f, 0.f, 2.f, 0.f, 0.f, 2.f, 2.f, 0.f, 0.f, 2.f, 0.f, 0.5f, 1.f, 0.f})
            append(bytes, x, false);
        for (const std::vector<int>& face : {std::vector<int>{0, 1, 2}, {0, 1, 2, 3, 4}, {0, 1}}) {
            if (extra) bytes += 'x';
            bytes += char(face.size());
            for (int i : face) append(bytes, i, false);
        }
        return bytes;
    };
    const SceneDescription fast = load("a.ply", make(false)), slow = load("b.ply", make(true));
    EXPECT_EQ(fast.meshes[0].indices, slow.meshes[0].indices);
    EXPECT_EQ(fast.meshes[0].indices.size(), 12u);
    EXPECT_EQ(warning_count("fewer than three vertices"), 2u);
}

/// Elements may have any order: a square, a degenerate face of two corners and a triangle, with face colors.
TEST_F(Ply, FacesBeforeVertices)
{
    const std::string faces = "element face 3\nproperty uchar red\n" + indices, vertices = "element vertex 5\n" + xyz;
    const std::vector<std::vector<int>> corners = {{0, 1, 2, 3}, {0, 1}, {1, 4, 2}};
    const std::vector<float> places = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0};
    for (const char* const format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        std::string bytes = fmt::format("ply\nformat {} 1.0\n{}{}end_header\n", format, faces, vertices);
        const bool big = format == std::string("binary_big_endian"), ascii = format == std::string("ascii");
        const auto put = [&](auto value) {
            if (ascii)
                bytes += fmt::format("{} ", int(value));
            else
                append(bytes, value, big);
        };
        for (std::size_t face = 0; face < corners.size(); ++face) {
            put(std::uint8_t(face == 0 ? 0 : 255));
            put(std::uint8_t(corners[face].size()));
            for (const int i : corners[face]) put(i);
        }
        for (const float x : places) put(x);
        const Mesh mesh = load("a.ply", bytes).meshes.at(0);
        ASSERT_EQ(mesh.indices.size(), 9u) << format;
        const float x_of[] = {0, 1, 1, 0, 1, 0, 1, 2, 1};
        for (std::size_t k = 0; k < 9; ++k) {
            EXPECT_EQ(mesh.positions[mesh.indices[k]].x, x_of[k]) << format << k;
            EXPECT_EQ(mesh.colors.at(mesh.indices[k]).x, k < 6 ? 0 : 1) << format << k;
        }
        for (std::size_t size = bytes.find("end_header"); size + 1 < bytes.size(); ++size)
            EXPECT_NE(error_of("b.ply", bytes.substr(0, size)), "loaded") << format << size;
    }
    EXPECT_EQ(warning_count("fewer than three vertices"), 3u);
}

/// Other elements are triangle faces, strips, and indices out of range.
TEST_F(Ply, OtherElementsBeforeVertices)
{
    std::string usual = "ply\nformat binary_little_endian 1.0\nelement face 1\n" + indices + "element vertex 3\n" +
                        xyz + "end_header\n\3";
    for (const int i : {2, 0, 1}) append(usual, i, false);
    for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) append(usual, x, false);
    EXPECT_EQ(load("a.ply", usual).meshes.at(0).indices, (std::vector<std::uint32_t>{2, 0, 1}));
    const auto ascii = [&](const std::string& element, const std::string& row) {
        return "ply\nformat ascii 1.0\n" + element + "element vertex 4\n" + xyz + "end_header\n" + row +
               "0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
    };
    const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\n";
    EXPECT_EQ(load("a.ply", ascii(strips, "8 0 1 2 3 -1 0 1 3\n")).meshes.at(0).indices,
              (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3, 0, 1, 3}));
    EXPECT_EQ(error_of("a.ply", ascii("element face 2\n" + indices, "3 0 1 2\n3 0 1 4\n")),
              "face 1: vertex 4 is out of range: there are 4");
    EXPECT_EQ(error_of("a.ply", ascii("element curve 1\nproperty uint vertices\n", "5\n")),
              "curve 0: expected 5 vertices, but there are only 4");
    EXPECT_EQ(error_of("a.ply", "ply\nformat ascii 1.0\nelement face 1\n" + indices + "end_header\n3 0 1 2\n"),
              "face 0: vertex 0 is out of range: there are 0");
}

/// Colors are equal as bytes, shorts and floats, under each name that programs use: 128 / 255 decodes to 0.21586;
/// floats are linear.
TEST_F(Ply, NamesAndTypesOfColors)
{
    const auto color_of = [&](const std::string& prefix, const std::string& names, const std::string& type,
                              const std::string& row) {
        std::string properties = xyz + "property float ambient_red\n";
        for (std::size_t at = 0; at < names.size();) {
            const std::size_t end = names.find(' ', at);
            properties += "property " + type + " " + prefix + names.substr(at, end - at) + "\n";
            at = end == std::string::npos ? names.size() : end + 1;
        }
        std::string body;
        for (const char* place : {"0 0 0", "1 0 0", "0 1 0"}) body += std::string(place) + " 9 " + row + "\n";
        const Mesh mesh = load("a.ply", header("ascii", properties, indices, 3, 1) + body + "3 0 1 2\n").meshes.at(0);
        EXPECT_EQ(mesh.colors.size(), 3u) << prefix << names << type;
        return mesh.colors.empty() ? Vec4f{} : mesh.colors[1];
    };
    for (const std::string prefix : {"", "diffuse_"})
        for (const std::string names : {"red green blue alpha", "r g b a"})
            for (const auto& [type, row] :
                 {std::pair{"uchar", "255 128 0 51"}, std::pair{"ushort", "65535 32896 0 13107"},
                  std::pair{"float", "1 0.21586050 0 0.2"}}) {
                const Vec4f c = color_of(prefix, names, type, row);
                EXPECT_EQ(c.x, 1) << prefix << names << type;
                EXPECT_NEAR(c.y, 0.21586050, 1e-6) << prefix << names << type;
                EXPECT_EQ(c.z, 0) << prefix << names << type;
                EXPECT_NEAR(c.w, 0.2, 1e-6) << prefix << names << type;
            }
    // Plain names take precedence if a file has both.
    EXPECT_EQ(color_of("", "red green blue diffuse_red diffuse_green diffuse_blue", "uchar", "0 255 0 255 0 255").x, 0);
}

/// The first byte of binary data may look like part of the header's line ending.
TEST_F(Ply, EndsOfTheLinesOfABinaryHeader)
{
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string bytes = header("binary_little_endian", "property uchar first\n" + xyz, indices, 3, 1);
        for (std::size_t at = bytes.find('\n'); at != std::string::npos; at = bytes.find('\n', at + end.size()))
            bytes.replace(at, 1, end);
        for (int i = 0; i < 3; ++i) {
            bytes += '\n';
            for (const int k : {1, 2, 3}) append(bytes, float(k == i + 1), false);
        }
        bytes += char(3);
        for (const int i : {0, 1, 2}) append(bytes, i, false);
        const Mesh mesh = load("a.ply", bytes).meshes.at(0);
        EXPECT_EQ(mesh.positions.at(2).z, 1);
        EXPECT_EQ(mesh.indices.size(), 3u);
    }
}

TEST_F(Ply, Strips)
{
    const SceneDescription scene =
        load("a.ply", "ply\nformat ascii 1.0\nelement vertex 5\n" + xyz +
                          "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                          "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 -1 2 3 4 -1\n");
    EXPECT_EQ(scene.meshes.at(0).indices, (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3, 2, 3, 4}));
}

TEST_F(Ply, Mistakes)
{
    const std::string body = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    EXPECT_EQ(error_of("a.ply", "plx\n"), "line 1: this is not a PLY file: it must begin with 'ply'");
    EXPECT_EQ(error_of("a.ply", "ply\nformat ascii 1.0\n"),
              "line 3: the file ends within its header: there is no 'end_header'");
    EXPECT_EQ(error_of("a.ply", header("asci", xyz, indices)), "line 2: 'asci' is not a PLY format");
    EXPECT_EQ(error_of("a.ply", header("ascii", "property floaty x\n", indices)), "line 5: 'floaty' is not a type");
    EXPECT_EQ(error_of("a.ply", header("ascii", "property float a\n", indices, 1) + "0\n3 0 0 0\n"),
              "line 9: the vertices have no x, y and z");
    EXPECT_EQ(error_of("a.ply", header("ascii", xyz, indices) + body + "4 0 1 2 4\n"),
              "face 0: vertex 4 is out of range: there are 4");
    EXPECT_EQ(error_of("a.ply", header("ascii", xyz, indices) + body + "4 0 1 2 -1\n"),
              "face 0: vertex -1 is out of range: there are 4");
    for (const char* number : {"1e32", "-1e32"})
        EXPECT_EQ(error_of("a.ply", header("ascii", xyz, indices) + body + "4 0 1 2 " + number + "\n"),
                  "face 0: vertex 9007199254740992 is out of range: there are 4");
    EXPECT_EQ(error_of("a.ply", header("ascii", xyz, indices) + body + "3 0 1\n"), "line 16: the file is truncated");
    EXPECT_EQ(error_of("a.ply", header("ascii", xyz, indices) + body + "999999999 0 1\n"),
              "line 15: a list of 999999999 elements does not fit into the file");
    EXPECT_EQ(error_of("a.ply", header("ascii", xyz, indices, 4, 2000000000) + body),
              "line 14: 2000000000 elements 'face' do not fit into the file, which is truncated");
    EXPECT_EQ(error_of("a.ply", header("binary_little_endian", xyz, indices, 2000000000)),
              "2000000000 elements 'vertex' do not fit into the file, which is truncated");
    EXPECT_EQ(error_of("a.ply", header("ascii", xyz, indices) + "0 0 0\n1 0 0\n1 1 nan\n0 1 0\n3 0 1 2\n"),
              "line 13: the number 'nan' is not finite");
    std::string nan = header("binary_little_endian", xyz, indices, 3, 1);
    for (float x : {0.f, 0.f, 0.f, NAN, 0.f, 0.f, 0.f, 1.f, 0.f}) append(nan, x, false);
    nan += char(3);
    for (int i : {0, 1, 2}) append(nan, i, false);
    EXPECT_EQ(error_of("a.ply", nan), "meshes[0].positions[1]: is not finite");
}

TEST_F(Ply, CloudsOfPoints)
{
    const std::string points = "0 0 0\n3 0 0\n0 4 0\n3 4 0\n";
    const SceneDescription scene = load("a.ply", header("ascii", xyz, "", 4, 0) + points);
    EXPECT_TRUE(scene.meshes.empty());
    ASSERT_EQ(scene.points.size(), 1u);
    EXPECT_EQ(scene.points[0].centers.size(), 4u);
    EXPECT_EQ(scene.points[0].radii[0], 1.25f);
    EXPECT_TRUE(warnings_.empty());
    std::string nan = header("binary_little_endian", xyz, "", 3, 0);
    for (float x : {0.f, 0.f, 0.f, NAN, 0.f, 0.f, 0.f, 1.f, 0.f}) append(nan, x, false);
    EXPECT_EQ(load("b.ply", nan).points.at(0).centers.size(), 2u);
    const std::string sized = header("ascii", xyz + "property float radius\n", "", 2, 0) + "0 0 0 0.5\n1 0 0 0.25\n";
    EXPECT_EQ(load("c.ply", sized).points.at(0).radii, (std::vector<float>{0.5f, 0.25f}));
    EXPECT_EQ(warnings_.counts().size(), 1u);
}

TEST_F(Ply, EveryTruncation)
{
    std::string whole = header("binary_little_endian", xyz, indices, 3, 2);
    for (float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) append(whole, x, false);
    for (int face = 0; face < 2; ++face) {
        whole += char(3);
        for (int i : {0, 1, 2}) append(whole, i, false);
    }
    EXPECT_EQ(error_of("a.ply", whole), "loaded");
    for (std::size_t size = 0; size < whole.size(); ++size)
        EXPECT_NE(error_of("a.ply", whole.substr(0, size)), "loaded") << size;
}

TEST_F(Ply, KitchenOfAMillionTriangles)
{
    const std::filesystem::path file = std::filesystem::path(FATHOM_SHARED_SCENES) / "meshes/kitchen.ply";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
    const SceneDescription scene = load_scene(file, {}, warnings_);
    EXPECT_EQ(scene.meshes.at(0).positions.size(), 517503u);
    EXPECT_EQ(scene.meshes[0].indices.size() / 3 + count_in_all(warnings_, "degenerate triangles"), 1021815u);
}

std::string binary_stl(const std::vector<Vec3f>& corners, std::string start = "")
{
    start.resize(80, ' ');
    append(start, std::uint32_t(corners.size() / 3), false);
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        start.append(12, '\0');
        for (std::size_t k = i; k < i + 3; ++k)
            for (float x : {corners[k].x, corners[k].y, corners[k].z}) append(start, x, false);
        start.append(2, '\0');
    }
    return start;
}
const std::vector<Vec3f> two_triangles = {{0, 0, 0}, {1, 0, 0}, {1, 1, 2}, {0, 0, 0}, {1, 1, 2}, {0, 1, -0.0f}};

TEST_F(Stl, BinaryAndAsciiAreTheSame)
{
    std::string ascii = "solid quad\n";
    for (std::size_t i = 0; i < 6; i += 3) {
        ascii += " facet normal 0 0 1\n  outer loop\n";
        for (std::size_t k = i; k < i + 3; ++k)
            ascii += fmt::format("   vertex {} {} {}\n", two_triangles[k].x, two_triangles[k].y, two_triangles[k].z);
        ascii += "  endloop\n endfacet\n";
    }
    ascii += "endsolid quad\n";
    // Some programs begin binary files with "solid".
    for (const std::string& content : {binary_stl(two_triangles), binary_stl(two_triangles, "solid quad"), ascii}) {
        const SceneDescription scene = load("a.stl", content);
        const Mesh& mesh = scene.meshes.at(0);
        EXPECT_EQ(mesh.positions.size(), 4u);
        EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
    }
}

std::string ascii_stl(const std::string& name)
{
    return "solid" + name +
           "\nfacet normal 0 0 nan\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 2\nendloop\nendfacet\n"
           "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 1 2\nvertex 0 1 -0\nendloop\nendfacet\nendsolid" +
           name + "\n";
}

/// Programs write extra text before and after the triangles, in ASCII and binary.
TEST_F(Stl, OddBeginningsAndEnds)
{
    std::string upper = ascii_stl(" QUAD"), one_line = ascii_stl("");
    for (char& c : upper) c = char(std::toupper(c));
    for (char& c : one_line) c = c == '\n' ? ' ' : c;
    one_line.replace(0, 5, "solid\n");
    const std::string tail = "made by hand", zeros(64, '\0');
    const std::pair<const char*, std::string> files[] = {
        {"blank", "  \t" + ascii_stl(" a")},
        {"empty lines", "\r\n\n" + ascii_stl(" a")},
        {"mark", "\xef\xbb\xbf" + ascii_stl(" a")},
        {"mark and blank", "\xef\xbb\xbf \n" + ascii_stl(" a")},
        {"upper case", upper},
        {"one line", one_line},
        {"no name", ascii_stl("")},
        {"a long name", ascii_stl(" " + std::string(5000, 'x'))},
        {"a name of other words", ascii_stl(" facet vertex 9 9 9 endsolid")},
        {"a name in Latin-1", ascii_stl(" fa\xe7"
                                        "ade \xe9")},
        {"an end as of DOS", ascii_stl(" a") + '\x1a'},
        {"binary", binary_stl(two_triangles)},
        {"binary with a tail", binary_stl(two_triangles) + tail},
        {"binary solid", binary_stl(two_triangles, "solid facet normal")},
        {"binary solid with a tail", binary_stl(two_triangles, "solid facet normal") + tail},
        {"binary SOLID with a tail", binary_stl(two_triangles, "  SOLID") + zeros},
        {"binary with a mark", binary_stl(two_triangles, "\xef\xbb\xbfsolid") + tail},
        {"binary with the other mark", binary_stl(two_triangles, "\xff\xfes") + tail},
        {"binary of zeros", binary_stl(two_triangles, "a" + zeros) + tail},
    };
    for (const auto& [what, content] : files) {
        const SceneDescription scene = load("a.stl", content);
        const Mesh& mesh = scene.meshes.at(0);
        EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3})) << what;
        EXPECT_EQ(mesh.positions.at(2).z, 2) << what;
    }
    EXPECT_TRUE(warnings_.empty()) << warnings_.counts().begin()->first;
    const std::string two = ascii_stl(" a") + "\n" + ascii_stl(" b");
    EXPECT_EQ(load("b.stl", two).meshes.at(0).indices.size(), 12u);
    // Cutting the last number leaves no trace of damage.
    const std::string whole = ascii_stl(" a");
    load("c.stl", whole.substr(0, whole.rfind("endsolid")));
    EXPECT_EQ(warning_count("without 'endsolid'"), 1u);
    EXPECT_EQ(error_of("d.stl", binary_stl(two_triangles, "solid").substr(0, 140)),
              "the file is truncated: its header says 2 triangles, but there are 1");
    EXPECT_EQ(error_of("d.stl", ""), "the file is empty");
}

TEST_F(Stl, UpIsZByDefault)
{
    const auto file = write("a.stl", binary_stl(two_triangles));
    LoadOptions options;
    EXPECT_EQ(world_bounds(load_scene(file, options, warnings_)).max, (Vec3d{1, 2, 0}));
    EXPECT_EQ(world_bounds(load_scene(file, options, warnings_)).min, (Vec3d{0, 0, -1}));
    options.up_axis = 'y';
    EXPECT_EQ(world_bounds(load_scene(file, options, warnings_)).max, (Vec3d{1, 1, 2}));
    options.up_axis = 'z';
    const auto obj = write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 2\nf 1 2 3\n");
    EXPECT_EQ(world_bounds(load_scene(obj, {}, warnings_)).max, (Vec3d{1, 1, 2}));
    EXPECT_EQ(world_bounds(load_scene(obj, options, warnings_)).max, (Vec3d{1, 2, 0}));
}

TEST_F(Stl, Mistakes)
{
    const std::string whole = binary_stl(two_triangles);
    for (std::size_t size = 0; size < whole.size(); ++size)
        EXPECT_NE(error_of("a.stl", whole.substr(0, size)), "loaded") << size;
    EXPECT_EQ(error_of("a.stl", whole.substr(0, 140)),
              "the file is truncated: its header says 2 triangles, but there are 1");
    EXPECT_EQ(error_of("a.stl", "hello"), "this is not an STL file: it ends within its header");
    EXPECT_EQ(error_of("a.stl", "solid\nvertex 0 0 0\nvertex 1 0 0\n"), "line 4: the file ends within a triangle");
    EXPECT_EQ(error_of("a.stl", "solid\nvertex 0 0\n"), "line 2: expected a number, found ''");
    EXPECT_EQ(error_of("a.stl", "solid\nendsolid\n"), "it contains no triangles");
}

}  // namespace
}  // namespace fathom::test
