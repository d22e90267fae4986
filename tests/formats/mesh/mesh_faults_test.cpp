// SPDX-License-Identifier: Apache-2.0
#include "formats/mesh/mesh_faults.h"

#include "formats/import_test_helpers.h"

namespace fathom::test {
namespace {

class MeshFaultsTest : public ImportTest {
protected:
    /// Warnings, one per line, without the folder's name.
    std::string warnings_of(const std::filesystem::path& file)
    {
        warnings_ = {};
        load_scene(file, {}, warnings_);
        std::string text;
        for (const auto& [message, times] : warnings_.counts()) {
            EXPECT_EQ(times, 1u) << message;
            text += message + '\n';
        }
        for (std::size_t at; (at = text.find(folder_.string() + '/')) != std::string::npos;)
            text.erase(at, folder_.string().size() + 1);
        return text;
    }
};

TEST_F(MeshFaultsTest, FormatsLargeNumbers)
{
    EXPECT_EQ(thousands_separated(0), "0");
    EXPECT_EQ(thousands_separated(999), "999");
    EXPECT_EQ(thousands_separated(1204), "1,204");
    EXPECT_EQ(thousands_separated(1234567), "1,234,567");
}

/// One warning for each kind of fault per file, including the files that a scene refers to.
TEST_F(MeshFaultsTest, OneLinePerKindAndFile)
{
    const std::string flat = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\n", faces = "f 1 2 3\nf 1 2 4\nf 1 1 2\n";
    const std::string faulty = flat + "o a\n" + faces + "o b\n" + faces;
    EXPECT_EQ(warnings_of(write("a.obj", faulty)), "a.obj: 2 meshes contain degenerate triangles, 4 in all; ignored\n");
    EXPECT_EQ(warnings_of(write("b.obj", flat + "vn 0 0 0\nf 1//1 2//1 4//1\nf 1//1 2//1 3//1\n")),
              "b.obj: 1 mesh contains degenerate triangles, 1 in all; ignored\n"
              "b.obj: 1 mesh contains normals of zero length or not finite, 3 in all; replaced by normals of the "
              "adjacent faces\n");
    const auto ply = [](int degenerate) {
        std::string text =
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "element face " +
            std::to_string(degenerate + 1) +
            "\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        for (int i = 0; i < degenerate; ++i) text += "3 0 1 1\n";
        return text;
    };
    write("one.ply", ply(1200));
    write("two.ply", ply(34));
    write("good.ply", ply(0));
    std::string shapes, xml = "<scene version=\"3.0.0\">";
    for (const char* const name : {"one.ply", "two.ply", "good.ply"}) {
        shapes += std::string("Shape \"plymesh\" \"string filename\" \"") + name + "\"\n";
        xml += std::string("<shape type=\"ply\"><string name=\"filename\" value=\"") + name + "\"/></shape>";
    }
    EXPECT_EQ(warnings_of(write("a.pbrt", "WorldBegin\n" + shapes)),
              "a.pbrt: 2 meshes of 2 files contain degenerate triangles, 1,234 in all; ignored\n");
    EXPECT_EQ(warnings_of(write("a.xml", xml + "</scene>")),
              "a.xml: 2 meshes of 2 files contain degenerate triangles, 1,234 in all; ignored\n");
    EXPECT_EQ(
        warnings_of(write("a.json", R"({"fathom": 1, "nodes": {"a": {"model": "one.ply"}, "b": {"model": "a.obj"}}})")),
        "a.json: 3 meshes of 2 files contain degenerate triangles, 1,204 in all; ignored\n");
    EXPECT_EQ(warnings_of(write("b.pbrt",
                                "WorldBegin\nShape \"trianglemesh\" \"integer indices\" [0 1 2 0 0 1]\n"
                                "\"point3 P\" [0 0 0 2 0 0 0 3 1]\n")),
              "b.pbrt: 1 mesh contains degenerate triangles, 1 in all; ignored\n");
}

/// Missing materials and unsupported elements also give one warning for each kind.
TEST_F(MeshFaultsTest, OneLinePerKindOfMaterial)
{
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl x\nf 1 2 3\n";
    EXPECT_EQ(warnings_of(write("a.obj", triangle + triangle)),
              "a.obj: there is no material named 'x': gray is used\n");
    EXPECT_EQ(warnings_of(write("b.obj", triangle + "usemtl y\nf 1 2 3\nusemtl z\nf 1 2 3\nusemtl y\nf 1 2 3\n")),
              "b.obj: 3 materials are not defined, the first is 'x': gray is used\n");
    std::string xml = "<scene version=\"3.0.0\">";
    for (const char* const id : {"one", "two", "three"})
        xml += std::string("<shape type=\"ellipsoids\" id=\"") + id + "\"/>";
    warnings_ = {};
    load_scene(write("a.xml", xml + "</scene>"), {}, warnings_);
    ASSERT_EQ(warnings_.counts().size(), 1u);
    EXPECT_EQ(warnings_.counts().begin()->second, 3u);
    EXPECT_NE(warnings_.counts().begin()->first.find("shape 'ellipsoids' ('one' and 2 more): "), std::string::npos)
        << warnings_.counts().begin()->first;
}

/// Tessellated quadrics contain no degenerate triangles for any parameters.
TEST_F(MeshFaultsTest, NoneOfQuadricsThatAreTessellated)
{
    const std::string texture =
        "Texture \"t\" \"spectrum\" \"checkerboard\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n";
    for (const char* const shape :
         {"\"sphere\"", "\"disk\"", "\"cylinder\"", "\"sphere\" \"float zmin\" 0",
          "\"sphere\" \"float zmax\" 0.5 \"float phimax\" 90", "\"disk\" \"float innerradius\" 0.5"}) {
        const auto file = write("a.pbrt", "WorldBegin\n" + texture + "Shape " + shape + "\n");
        EXPECT_EQ(warnings_of(file), "") << shape;
        for (const Mesh& mesh : load_scene(file, {}, warnings_).meshes)
            for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
                const auto at = [&](std::size_t k) {
                    const Vec3f p = mesh.positions[mesh.indices[i + k]];
                    return Vec3d{p.x, p.y, p.z};
                };
                ASSERT_GT(length(cross(at(1) - at(0), at(2) - at(0))), 1e-9) << shape << i;
            }
    }
}

}  // namespace
}  // namespace fathom::test
