// SPDX-License-Identifier: Apache-2.0
// Byte order marks, line endings and comments in every text format.
#include <fmt/format.h>

#include "formats/import_test_helpers.h"
#include "formats/io/input_file.h"
#include "formats/io/text_scanner.h"

namespace fathom::test {
namespace {

class TextFiles : public ImportTest {
protected:
    /// The text with one of the styles of line endings.
    static std::string with_line_ends(std::string text, const std::string& end)
    {
        for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + end.size()))
            text.replace(at, 1, end);
        return text;
    }
    std::size_t warning_count(const std::string& words) const
    {
        std::size_t count = 0;
        for (const auto& [message, times] : warnings_.counts())
            if (message.find(words) != std::string::npos) count += times;
        return count;
    }
    /// A number that distinguishes the triangles.
    static std::string corners(const SceneDescription& scene)
    {
        std::string text;
        for (const Mesh& mesh : scene.meshes)
            for (const std::uint32_t i : mesh.indices) {
                const Vec3f p = mesh.positions[i];
                text += fmt::format("{},{},{} ", p.x, p.y, p.z);
            }
        return text;
    }
};

const std::string mark = "\xef\xbb\xbf";
const std::string triangle = "0,0,0 2,0,0 0,3,1 ";

const std::string obj = "mtllib a.mtl\nusemtl red\nv 0 0 0\nv 2 0 0\nv 0 3 \\\n1\nf 1 2 3\n";
const std::string mtl = "newmtl red\nKd 0.75 0 0\nillum 1\n";
const std::string ply =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n2 0 0\n0 3 1\n3 0 1 2\n";
const std::string stl =
    "solid a name\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 3 1\nendloop\nendfacet\n"
    "endsolid a name\n";
const std::string json =
    R"({"fathom": 1, "meshes": {"m": {"positions": [[0, 0, 0], [2, 0, 0], [0, 3, 1]]}},
"nodes": {"n": {"mesh": "m"}}})";
const std::string pbrt =
    "# a scene\nWorldBegin\nShape \"trianglemesh\" \"integer indices\" [0 1 2] # a comment\n"
    "\"point3 P\" [0 0 0 2 0 0 0 3 1]\n";
const std::string mitsuba =
    "<scene version=\"3.0.0\"><shape type=\"ply\"><string name=\"filename\" value=\"b.ply\"/></shape></scene>\n";

TEST_F(TextFiles, AMarkAndAnyEndOfLines)
{
    for (const std::string& start : {std::string(), mark})
        for (const std::string end : {"\n", "\r\n", "\r"}) {
            const auto text = [&](const std::string& of) { return start + with_line_ends(of, end); };
            write("a.mtl", text(mtl));
            const SceneDescription scene = load("a.obj", text(obj));
            EXPECT_EQ(corners(scene), triangle);
            EXPECT_EQ(scene.materials.at(std::size_t(scene.nodes.at(0).shapes.at(0).material)).base_color.value,
                      (Color{0.75f, 0, 0}));
            EXPECT_EQ(corners(load("a.ply", text(ply))), triangle);
            EXPECT_EQ(corners(load("a.stl", text(stl))), triangle);
            EXPECT_EQ(corners(load("a.json", text(json))), triangle);
            EXPECT_EQ(corners(load("a.pbrt", text(pbrt))), triangle);
            write("b.ply", text(ply));
            EXPECT_EQ(corners(load("a.xml", text(mitsuba))), triangle);
        }
    EXPECT_EQ(warning_count(""), 0u) << warnings_.counts().begin()->first;
}

/// Encodes each character as two bytes.
std::string utf16(const std::string& text, bool big, bool has_mark)
{
    std::string wide = !has_mark ? "" : big ? "\xfe\xff" : "\xff\xfe";
    for (const char c : text)
        if (big)
            wide += '\0', wide += c;
        else
            wide += c, wide += '\0';
    return wide;
}

TEST_F(TextFiles, Utf16IsRefusedByName)
{
    for (const bool big : {false, true})
        for (const bool has_mark : {false, true}) {
            const std::pair<const char*, const std::string*> files[] = {
                {"a.obj", &obj},   {"a.ply", &ply},     {"a.stl", &stl},   {"a.json", &json},
                {"a.gltf", &json}, {"a.xml", &mitsuba}, {"a.pbrt", &pbrt},
            };
            for (const auto& [name, text] : files)
                EXPECT_EQ(error_of(name, utf16(*text, big, has_mark)), "is text in UTF-16 or UTF-32: save it as UTF-8")
                    << name << big << has_mark;
        }
    const auto material = write("a.mtl", utf16(mtl, false, true));
    try {
        load("a.obj", obj);
        ADD_FAILURE() << "loaded";
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()), material.string() + ": is text in UTF-16 or UTF-32: save it as UTF-8");
    }
}

/// The byte order mark is skipped when reading windows or whole files; in binary files it is data.
TEST_F(TextFiles, MarksOfAnInputFile)
{
    const std::string text = "v 1 2 3\n" + std::string(10000, '#') + "end";
    const auto path = write("a.txt", mark + text);
    InputFile whole(path);
    whole.skip_byte_order_mark();
    EXPECT_EQ(whole.size(), text.size());
    EXPECT_EQ(whole.bytes(), text);
    InputFile pieces(path);
    pieces.skip_byte_order_mark();
    std::string read(text.size() + 5, ' ');
    const std::size_t first = pieces.read(read.data(), 6000);
    EXPECT_EQ(first, 6000u);
    EXPECT_EQ(pieces.read(read.data() + first, read.size() - first), text.size() - first);
    EXPECT_EQ(read.substr(0, text.size()), text);
    EXPECT_EQ(pieces.bytes(), text);
    EXPECT_EQ(InputFile(path).bytes(), mark + text);
}

TEST_F(TextFiles, LinesOfAScanner)
{
    const std::string file = "a";
    const std::string text = "one\rtwo \\\rgoes on\r\nthree#not\\\r\r\nfive";
    TextScanner scan(file, text, 1, '#');
    EXPECT_EQ(scan.word(), "one");
    EXPECT_EQ(scan.word(), "");
    scan.next_line();
    EXPECT_EQ(scan.line(), 2u);
    EXPECT_EQ(scan.word(), "two");
    EXPECT_EQ(scan.rest(), "goes on");
    scan.next_line();
    EXPECT_EQ(scan.line(), 4u);
    EXPECT_EQ(scan.word(), "three");
    EXPECT_FALSE(scan.line_has_more());
    scan.next_line();
    EXPECT_EQ(scan.line(), 5u);
    EXPECT_EQ(scan.word(), "");
    scan.next_line();
    EXPECT_EQ(scan.word(), "five");
    scan.next_line();
    EXPECT_TRUE(scan.at_end());
}

/// Comments start at '#' with or without a blank before it.
TEST_F(TextFiles, CommentsBehindEveryLineOfAnObj)
{
    write("a.mtl",
          "newmtl red # a name\nKd 0.75 0 0# red\nKs 0.5 # one number\nNs 98 #\nd 0.25# d\nmap_Kd wood.png # its map\n"
          "map_d no#comment.png\n# Kd 1 1 1 \\\nnewmtl Material #25\nillum 1 # matte\nKd 0 0.5 0\n");
    for (const std::string space : {"", " ", "\t"}) {
        const std::string c = space + "# 1 2 3 \\\n";
        const SceneDescription scene =
            load("a.obj", "mtllib a.mtl # library\no part # object\nusemtl red # paint\nv 0 0 0" + c + "v 2 0 0 1" + c +
                              "v 0 3 1 0.5 0.5 0.5" + c + "vt 0.5" + c + "vt 0.5 0.25" + c + "vn 0 0 1" + c + "s off" +
                              c + "g a" + c + "l 1 2" + c + "p 1" + c + "f 1/1/1 2/2/1 3/2/1" + c +
                              "usemtl Material #25\nf 1 2 3" + c);
        ASSERT_EQ(scene.meshes.size(), 2u);
        EXPECT_EQ(corners(scene), triangle + triangle);
        EXPECT_EQ(scene.points.at(0).centers.size(), 1u);
        const auto material = [&](std::size_t node) {
            return scene.materials.at(std::size_t(scene.nodes.at(node).shapes.at(0).material));
        };
        EXPECT_EQ(material(1).base_color.value, (Color{0, 0.5f, 0}));
        const Material red = material(0);
        EXPECT_EQ(red.base_color.value, (Color{0.75f, 0, 0}));
        EXPECT_EQ(red.opacity.alpha.value, 0.25f);
        const auto picture = [&](int texture) {
            return scene.images.at(std::size_t(scene.textures.at(std::size_t(texture)).image)).path.filename();
        };
        EXPECT_EQ(picture(red.base_color.texture), "wood.png");
        EXPECT_EQ(picture(red.opacity.alpha.texture), "no#comment.png");
    }
    EXPECT_EQ(warning_count("missing"), 0u);
    EXPECT_EQ(warning_count("no material"), 0u);
    EXPECT_EQ(warning_count("not recognized"), 0u);
}

}  // namespace
}  // namespace fathom::test
