// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include <fmt/format.h>

#include <cmath>

#include "formats/import_test_helpers.h"

namespace fathom::test {
namespace {

class Obj : public ImportTest {};

constexpr const char* square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

double area(const Mesh& mesh)
{
    double sum = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) sum += area_vector(mesh, i).z;
    return sum;
}

TEST_F(Obj, PolygonsAndIndices)
{
    const SceneDescription scene = load("a.obj", std::string(square) + "f 1 2 3 4\nf -4 -3 -2\n");
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].positions.size(), 4u);
    EXPECT_EQ(scene.meshes[0].indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 0, 1, 2}));
    EXPECT_TRUE(scene.meshes[0].normals.empty());
    EXPECT_TRUE(scene.meshes[0].uvs[0].empty());
    EXPECT_TRUE(warnings_.empty());
}

/// Negative indices count back from the last element of each kind so far.
TEST_F(Obj, IndicesFromTheEnd)
{
    const SceneDescription scene =
        load("a.obj",
             "v 9 9 9\nv 0 0 0\nv 1 0 0\nvt 0 0\nvt 0.5 0\nvt 0.25 1\nvn 1 0 0\nvn 0 0 1\nv 0 1 0\n"
             "f -3/-3/-1 -2/-2/-1 -1/-1/-2\nv 7 7 7\nvt 1 1\nvn 0 1 0\n");
    const Mesh& mesh = scene.meshes.at(0);
    ASSERT_EQ(mesh.indices.size(), 3u);
    const auto at = [&](std::size_t k) { return mesh.indices[k]; };
    EXPECT_EQ(mesh.positions[at(0)].x, 0);
    EXPECT_EQ(mesh.positions[at(1)].x, 1);
    EXPECT_EQ(mesh.positions[at(2)].y, 1);
    EXPECT_EQ(mesh.uvs[0][at(0)].x, 0);
    EXPECT_EQ(mesh.uvs[0][at(1)].x, 0.5f);
    EXPECT_EQ(mesh.uvs[0][at(2)].y, 0);  // v = 1 measured from below
    EXPECT_EQ(mesh.normals[at(0)].z, 1);
    EXPECT_EQ(mesh.normals[at(2)].x, 1);
}

TEST_F(Obj, ConcavePolygons)
{
    // The first file is an arrow head for which a fan from the first corner would be wrong; the second is the letter C.
    const SceneDescription arrow = load("a.obj", "v 0 0 0\nv 2 -1 0\nv 0 3 0\nv -2 -1 0\nf 2 3 4 1\nf 1 2 3 4\n");
    EXPECT_NEAR(area(arrow.meshes.at(0)), 2 * 6, 1e-6);
    const SceneDescription c = load("c.obj",
                                    "v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 2 0\nv 3 2 0\nv 3 3 0\nv 0 3 0\n"
                                    "f 1 2 3 4 5 6 7 8\n");
    EXPECT_NEAR(area(c.meshes.at(0)), 7, 1e-6);
    EXPECT_EQ(c.meshes[0].indices.size(), 18u);
    // No triangle covers the gap of the C.
    for (std::size_t i = 0; i < 18; i += 3) {
        double sum = 0;
        Mesh one = c.meshes[0];
        one.indices.assign(c.meshes[0].indices.begin() + long(i), c.meshes[0].indices.begin() + long(i) + 3);
        sum = area(one);
        EXPECT_GT(sum, 0);
    }
}

TEST_F(Obj, NormalsAndTextureCoordinates)
{
    const SceneDescription scene =
        load("a.obj", std::string(square) +
                          "vt 0.25 0.75\nvt 1 0\nvn 0 0 1\nvn 0 0 -1\n"
                          "f 1/1/1 2/2/1 3/1/1\nf 1/1/2 3/1/2 4/1/2\nf 1//1 2//1 3//1\nf 1/1 2/2 3/2\n");
    // Faces without normals are flat and don't share vertices.
    ASSERT_EQ(scene.meshes.size(), 2u);
    const Mesh& flat = scene.meshes[0].normals.empty() ? scene.meshes[0] : scene.meshes[1];
    const Mesh& smooth = scene.meshes[0].normals.empty() ? scene.meshes[1] : scene.meshes[0];
    EXPECT_TRUE(flat.normals.empty());
    EXPECT_EQ(smooth.normals.size(), smooth.positions.size());
    EXPECT_EQ(smooth.positions.size(), 9u);
    EXPECT_FLOAT_EQ(smooth.uvs[0][0].x, 0.25f);
    EXPECT_FLOAT_EQ(smooth.uvs[0][0].y, 0.25f);  // v grows downwards in Fathom
    EXPECT_EQ(flat.positions.size(), 3u);
}

TEST_F(Obj, LinesThatGoOnAndOtherHabits)
{
    const SceneDescription scene = load("a.obj",
                                        "# a comment \\\nv 0 0 \\\n0\r\nv +1 0 0\r\nv 1 1 0 1.0\n\tv   0 1e0 -0.0 \n\n"
                                        "g some group\ns 1\nf 1 2 \\\n 3 4 # the end\nl 1 2\np 1\ncurv 0 1\nwhat 3\n");
    EXPECT_EQ(scene.meshes.at(0).indices.size(), 6u);
    EXPECT_EQ(warning_count("line elements are ignored"), 1u);
    EXPECT_EQ(scene.points.at(0).centers.size(), 1u);
    EXPECT_EQ(warning_count("free-form"), 1u);
    EXPECT_EQ(warning_count("not recognized"), 1u);
}

/// Vertex colors are sRGB, as in Blender, Godot and MeshLab: 0.5 decodes to 0.2140.
TEST_F(Obj, VertexColors)
{
    const SceneDescription scene = load("a.obj", "v 0 0 0 1 0 0.5\nv 1 0 0 0 1 0.02\nv 0 1 0\nf 1 2 3\n");
    const std::vector<Vec4f>& colors = scene.meshes.at(0).colors;
    ASSERT_EQ(colors.size(), 3u);
    EXPECT_EQ(colors[0].x, 1);
    EXPECT_EQ(colors[0].y, 0);
    EXPECT_NEAR(colors[0].z, 0.21404114, 1e-6);
    EXPECT_NEAR(colors[1].z, 0.02 / 12.92, 1e-7);
    for (const float x : {colors[2].x, colors[2].y, colors[2].z, colors[2].w}) EXPECT_EQ(x, 1) << "has no color";
    EXPECT_TRUE(scene.materials.at(scene.nodes.at(0).shapes.at(0).material).use_vertex_color);
}

/// Some programs write colors from 0 to 255: the largest value in the file determines the range for the whole file.
TEST_F(Obj, VertexColorsOfBytes)
{
    const SceneDescription scene =
        load("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 128 51 0\nv 0 1 0 255 254 0\nv 1 1 0\nf 1 2 3 4\n");
    const std::vector<Vec4f>& colors = scene.meshes.at(0).colors;
    ASSERT_EQ(colors.size(), 4u);
    EXPECT_NEAR(colors[0].x, 1 / 255.0 / 12.92, 1e-7);
    EXPECT_NEAR(colors[1].x, 0.21586050, 1e-6);
    EXPECT_NEAR(colors[1].y, 0.03310477, 1e-6);
    EXPECT_EQ(colors[2].x, 1);
    EXPECT_EQ(colors[3].x, 1) << "has no color";
    // Values slightly above 1 from rounding don't switch to the byte range.
    const SceneDescription rounded = load("b.obj", "v 0 0 0 1.0001 0 0\nv 1 0 0 0.5 0 0\nv 0 1 0 0 0 -1e-9\nf 1 2 3\n");
    EXPECT_NEAR(rounded.meshes.at(0).colors.at(1).x, 0.21404114, 1e-6);
    EXPECT_EQ(rounded.meshes[0].colors[2].z, 0);
}

/// `d` takes precedence over `Tr` in any order; programs that write both give them the same meaning or none.
TEST_F(Obj, OpacityAndTransparency)
{
    const auto alpha = [&](const std::string& lines) {
        warnings_ = {};
        write("a.mtl", "newmtl m\nKd 0.5 0.5 0.5\n" + lines);
        return load("a.obj", std::string("mtllib a.mtl\nusemtl m\n") + square + "f 1 2 3\n")
            .materials.at(0)
            .opacity.alpha.value;
    };
    const auto contradictions = [&] { return warning_count("'d' and 'Tr' contradict each other"); };
    for (const char* lines : {"d 1\nTr 1\n", "Tr 1\nd 1\n", "d 1.0\nTr 0.25\n"}) {
        EXPECT_EQ(alpha(lines), 1) << lines;
        EXPECT_EQ(contradictions(), 1u) << lines;
    }
    EXPECT_EQ(alpha("Tr 1\nd 0.25\n"), 0.25f);
    EXPECT_EQ(contradictions(), 1u);
    EXPECT_EQ(alpha("d 0\nTr 0\n"), 0);
    EXPECT_EQ(contradictions(), 1u);
    for (const char* lines :
         {"d 0.25\nTr 0.75\n", "Tr 0.75\nd 0.25\n", "Tr 0.75\n", "d 0.25\n", "d -halo 0.25\n", "tr 0.7499\nD 0.25\n"}) {
        EXPECT_EQ(alpha(lines), 0.25f) << lines;
        EXPECT_EQ(contradictions(), 0u) << lines;
    }
    EXPECT_EQ(alpha("d 1\nTr 0\n"), 1);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(Obj, ObjectsAndMaterials)
{
    write("my colours.mtl", R"(# materials
newmtl matte
Kd 0.5 0.25 1
illum 1
newmtl shiny
Kd 0.1 0.2 0.3
Ks 0.5 0.5 0.5
Ns 98
d 0.5
newmtl veil
Kd 1 1 1
Tr 0.25
newmtl lamp
Kd 0 0 0
Ke 7 6 5
newmtl glass
illum 7
Ni 1.33
Ns 1000
newmtl mirror
Kd 0 0 0
Ks 0.9 0.8 0.7
Ns 1000
newmtl unheard of
Kd 0 0 0
Ks 0.9 0.8 0.7
Ns 1000
illum 4000000000
newmtl pbr
Kd 1 1 1
Pr 0.25
Pm 1
map_Pr rough map.png
newmtl layered
Kd 0.5 0.5 0.5
Ps 0.5
Pc 0.75
Pcr 0.25
aniso 0.4
anisor 0.125
map_Ps fibres.png
map_Pc coat.png
map_Pcr coat.png
norm bumps.png
newmtl coated
Pc 1
newmtl plain
Pc 0
Ps 0
newmtl textured
Kd 0 0 0
map_Kd -s 2 4 1 -o 0.5 0.25 -clamp on dir\wood.png
map_d dir\wood.png
map_Bump -bm 0.5 wood_normal.png
newmtl bumpy
map_bump heights.png
disp -bm 0.5 -mm -0.25 0.5 heights.png
decal heights.png
newmtl raised
disp heights.png
)");
    const SceneDescription scene =
        load("a.obj", std::string("mtllib my colours.mtl\n") + square +
                          "usemtl matte\nf 1 2 3\nusemtl shiny\nf 1 2 3\nusemtl matte\nf 1 3 4\no second\nf 1 2 3\n"
                          "usemtl gone\nf 1 2 3\n");
    EXPECT_EQ(scene.meshes.size(), 4u);
    EXPECT_EQ(warning_count("no material named 'gone'"), 1u);
    const auto material = [&](const std::string& name) {
        for (const Material& m : scene.materials)
            if (m.name == name) return m;
        ADD_FAILURE() << name;
        return Material{};
    };
    EXPECT_EQ(material("matte").kind, MaterialKind::diffuse);
    EXPECT_EQ(material("matte").base_color.value, (Color{0.5f, 0.25f, 1}));
    const Material shiny = material("shiny");
    EXPECT_EQ(shiny.kind, MaterialKind::principled);
    EXPECT_NEAR(shiny.roughness.value, std::sqrt(std::sqrt(0.02)), 1e-6);
    EXPECT_EQ(shiny.opacity.alpha.value, 0.5f);
    EXPECT_EQ(shiny.opacity.mode, AlphaMode::blend);
    EXPECT_EQ(material("veil").opacity.alpha.value, 0.75f);
    EXPECT_EQ(material("veil").opacity.mode, AlphaMode::blend);
    EXPECT_EQ(material("lamp").emission.radiance.value, (Color{7, 6, 5}));
    EXPECT_EQ(material("glass").kind, MaterialKind::glass);
    EXPECT_EQ(material("glass").ior, 1.33f);
    EXPECT_EQ(material("glass").roughness.value, 0);
    EXPECT_EQ(material("mirror").kind, MaterialKind::metal);
    EXPECT_EQ(material("mirror").base_color.value, (Color{0.9f, 0.8f, 0.7f}));
    EXPECT_EQ(material("unheard of").kind, MaterialKind::metal);
    const Material pbr = material("pbr");
    EXPECT_EQ(pbr.kind, MaterialKind::principled);
    EXPECT_EQ(pbr.roughness.value, 0.25f);
    EXPECT_EQ(pbr.metallic.value, 1);
    EXPECT_EQ(scene.images.at(scene.textures.at(pbr.roughness.texture).image).path, folder_ / "rough map.png");
    const Material layered = material("layered");
    EXPECT_EQ(layered.kind, MaterialKind::principled);
    EXPECT_EQ(layered.sheen.color.value, (Color{0.5f, 0.5f, 0.5f}));
    EXPECT_EQ(layered.coat.weight.value, 0.75f);
    EXPECT_EQ(layered.coat.roughness.value, 0.25f);
    EXPECT_EQ(layered.coat.weight.channel, 0);
    EXPECT_EQ(layered.microfacets.anisotropy.value, 0.4f);
    EXPECT_NEAR(layered.microfacets.anisotropy_rotation, std::numbers::pi / 4, 1e-12);
    const auto map_of = [&](int texture) {
        return scene.images.at(std::size_t(scene.textures.at(std::size_t(texture)).image)).path.filename();
    };
    EXPECT_EQ(map_of(layered.sheen.color.texture), "fibres.png");
    EXPECT_EQ(map_of(layered.coat.weight.texture), "coat.png");
    EXPECT_EQ(map_of(layered.coat.roughness.texture), "coat.png");
    EXPECT_EQ(map_of(layered.normal_map.texture), "bumps.png");
    // A coat without its own roughness keeps the base's roughness from the older keys.
    EXPECT_EQ(material("coated").kind, MaterialKind::principled);
    EXPECT_EQ(material("coated").coat.weight.value, 1);
    EXPECT_EQ(material("plain").kind, MaterialKind::diffuse);
    const Material textured = material("textured");
    const Texture& wood = scene.textures.at(textured.base_color.texture);
    EXPECT_EQ(textured.base_color.value, (Color{1, 1, 1}));
    EXPECT_EQ(scene.images.at(wood.image).path, folder_ / "dir/wood.png");
    EXPECT_EQ(wood.wrap_u, Wrap::clamp);
    // The file looks up (u, v) at (2u + 0.5, 4v + 0.25) with v upwards; this is the same point with v downwards.
    const float u = 0.3f, v = 0.1f;
    EXPECT_FLOAT_EQ(wood.uv_offset.x + wood.uv_scale.x * u, 2 * u + 0.5f);
    EXPECT_FLOAT_EQ(wood.uv_offset.y + wood.uv_scale.y * (1 - v), 1 - (4 * v + 0.25f));
    EXPECT_EQ(textured.opacity.alpha.channel, 3);
    EXPECT_EQ(textured.normal_map.scale, 0.5f);
    EXPECT_GE(textured.normal_map.texture, 0);
    const Texture& bumps = scene.textures.at(std::size_t(material("bumpy").normal_map.texture));
    EXPECT_EQ(bumps.height_scale, 0.01f);
    EXPECT_EQ(bumps.color_space, ColorSpace::linear);
    EXPECT_EQ(material("bumpy").normal_map.scale, 1);
    // Heights are bm * (base + gain * texture).
    const Material bumpy = material("bumpy"), raised = material("raised");
    EXPECT_EQ(bumpy.displacement.height.value, 0.25f);
    EXPECT_EQ(bumpy.displacement.midlevel, 0.5f);
    EXPECT_EQ(map_of(bumpy.displacement.height.texture), "heights.png");
    EXPECT_EQ(scene.textures.at(std::size_t(bumpy.displacement.height.texture)).height_scale, 0);
    EXPECT_EQ(raised.displacement.height.value, 1);
    EXPECT_EQ(raised.displacement.height.channel, 0);
    EXPECT_EQ(raised.displacement.midlevel, 0);
    EXPECT_EQ(warning_count("'decal'"), 1u);
}

TEST_F(Obj, IgnoresAMissingNormal)
{
    const SceneDescription scene =
        load("a.obj", std::string(square) + "vn 0.6 0 0.8\nf 1//1 2//9 3//1\nf 1//1 3//-5 4//0\n");
    ASSERT_EQ(scene.meshes.size(), 1u);
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.indices.size(), 6u);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (std::size_t i = 0; i < 6; ++i) {
        const Vec3f n = mesh.normals[mesh.indices[i]];
        const bool is_given = i == 0 || i == 2 || i == 3;
        expect_near({n.x, n.y, n.z}, is_given ? Vec3d{0.6, 0, 0.8} : Vec3d{0, 0, 1}, 1e-6);
    }
    EXPECT_EQ(warning_count("normal indices out of range"), 3u);
}

TEST_F(Obj, Points)
{
    // Without faces or points all vertices become points: 100 in a square of 9 by 9 with diagonal 12.7.
    std::string text;
    for (int i = 0; i < 100; ++i) text += fmt::format("v {} {} 5\n", i % 10, i / 10);
    const SceneDescription all = load("a.obj", text);
    ASSERT_EQ(all.points.size(), 1u);
    EXPECT_EQ(all.points[0].centers.size(), 100u);
    for (float r : all.points[0].radii) EXPECT_FLOAT_EQ(r, float(0.5 * std::sqrt(162) / 10));
    EXPECT_EQ(all.roots, (std::vector<int>{0}));
    EXPECT_TRUE(std::holds_alternative<PointsInstance>(all.nodes.at(0).shapes.at(0).geometry));
    // With `p` lines only the named vertices become points, in addition to the faces.
    const SceneDescription some = load("b.obj", std::string(square) + "v 7 8 9\np 5 1 # these\np -1\nf 1 2 3\n");
    EXPECT_EQ(some.meshes.size(), 1u);
    ASSERT_EQ(some.points.at(0).centers.size(), 3u);
    EXPECT_EQ(some.points[0].centers[2].z, 9);
    EXPECT_EQ(some.roots.size(), 2u);
    EXPECT_EQ(load("c.obj", "v 1 2 3\n").points.at(0).radii.at(0), 0.01f);
    EXPECT_EQ(error_of("d.obj", "v 1 2 3\np 2\n"), "line 2: vertex 2 is out of range: there are 1 so far");
}

TEST_F(Obj, Mistakes)
{
    EXPECT_EQ(error_of("a.obj", "v 0 0\nf 1 1 1\n"), "line 1: expected a number, found ''");
    EXPECT_EQ(error_of("a.obj", "v 0 0 x1\n"), "line 1: expected a number, found 'x1'");
    EXPECT_EQ(error_of("a.obj", "v 0 0 nan\n"), "line 1: the number 'nan' is not finite");
    EXPECT_EQ(error_of("a.obj", "v 0 0 1e999\n"), "line 1: the number '1e999' is too large");
    EXPECT_EQ(error_of("a.obj", "v 0 0 1e39\n"), "line 1: the number '1e39' is not finite");
    EXPECT_EQ(error_of("a.obj", "v 0 0 1e-999\n"), "loaded");
    EXPECT_EQ(error_of("a.obj", std::string(square) + "f 1 2 5\n"),
              "line 5: vertex 5 is out of range: there are 4 so far");
    EXPECT_EQ(error_of("a.obj", std::string(square) + "f 1 2 0\n"),
              "line 5: vertex 0 is out of range: there are 4 so far");
    EXPECT_EQ(error_of("a.obj", std::string(square) + "f 1 2 -5\n"),
              "line 5: vertex -5 is out of range: there are 4 so far");
    EXPECT_EQ(error_of("a.obj", std::string(square) + "f 1/1 2 3\n"),
              "line 5: texture coordinate 1 is out of range: there are 0 so far");
    EXPECT_EQ(error_of("a.obj", std::string(square) + "f 1 2 99999999999999999999\n"),
              "line 5: expected a whole number, found '99999999999999999999'");
    EXPECT_EQ(error_of("a.obj", "hello\nworld\n"), "it contains no vertices: is it an OBJ file?");
    warnings_ = {};
    EXPECT_EQ(error_of("a.obj", std::string(square) + "mtllib no.mtl\nf 1 2\nf 1 2 3\n"), "loaded");
    EXPECT_EQ(warning_count("'no.mtl' is missing"), 1u);
    EXPECT_EQ(warning_count("fewer than three vertices"), 1u);
}

}  // namespace
}  // namespace fathom::test
