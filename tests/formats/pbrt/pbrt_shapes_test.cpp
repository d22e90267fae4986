// SPDX-License-Identifier: Apache-2.0
// Tests of textures and shapes in pbrt files.
#include <fmt/format.h>
#include <cmath>

#include "pbrt_fixture.h"

namespace fathom::test {
namespace {

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
    // v grows downwards in Fathom, so the offset follows from 1 - (3 (1 - v) + 0.25).
    EXPECT_EQ(t.uv_offset.y, -2.25f);
    // A textured sphere becomes a mesh with pbrt's texture coordinates.
    EXPECT_FALSE(scene.meshes.empty());
}

/// Only sRGB and linear encodings are exact; for a gamma encoding the warning reports the error against sRGB.
TEST_F(Pbrt, EncodingsOfPictures)
{
    const auto space = [&](const std::string& encoding) {
        const SceneDescription scene =
            world(R"(Texture "t" "spectrum" "imagemap" "string filename" "a.png" "string encoding" ")" + encoding +
                  R"(" Material "diffuse" "texture reflectance" "t" Shape "sphere")");
        return scene.textures.at(std::size_t(material_of(scene).base_color.texture)).color_space;
    };
    EXPECT_EQ(space("sRGB"), ColorSpace::srgb);
    EXPECT_EQ(space("gamma 1"), ColorSpace::linear);
    EXPECT_FALSE(has_warning("encoding"));
    EXPECT_EQ(space("gamma 2.2"), ColorSpace::srgb);
    EXPECT_TRUE(has_warning("'gamma 2.2' is approximated by 'sRGB': the error is up to 0.009"));
    space("gamma 1.8");
    EXPECT_TRUE(has_warning("'gamma 1.8' is approximated by 'sRGB': the error is up to 0.08"));
    EXPECT_NE(
        error_of("a.pbrt",
                 R"(WorldBegin Texture "t" "spectrum" "imagemap" "string filename" "a.png" "string encoding" "gamma x"
Material "diffuse" "texture reflectance" "t" Shape "sphere")")
            .find("'gamma' with a number, found 'gamma x'"),
        std::string::npos);
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

/// A world with a pbrt texture as reflectance, and the imported texture.
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
        EXPECT_EQ(has_warning("Texture '"), type == "ptex") << type;
        return t;
    };
    // Reflectance textures that may leave [0, 1] are clamped.
    const auto limited = [](const Textured& t) -> const Texture& {
        EXPECT_EQ(t.base().kind, TextureKind::clamp);
        return t.of(t.base().color_a.texture);
    };
    const Textured fbm = read("fbm", "\"integer octaves\" 3 \"float roughness\" 0.75");
    EXPECT_EQ(limited(fbm).kind, TextureKind::fbm);
    EXPECT_EQ(limited(fbm).octaves, 3);
    EXPECT_EQ(limited(fbm).gain, 0.75f);
    // The texture depends on position only, so the sphere needs no texture coordinates of pbrt's.
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
    // pbrt-v4 swaps the inside and outside textures of dots.
    expect_color(dots.base().color_a.value, 1, 0, 0);
    expect_color(dots.base().color_b.value, 0, 1, 0);
    EXPECT_EQ(dots.base().uv_scale.x, 3);
    const Textured mix = read("directionmix", "\"vector dir\" [ 3 0 4 ] \"rgb tex1\" [ 1 0 0 ]");
    EXPECT_EQ(mix.base().kind, TextureKind::facing);
    expect_color(mix.base().color_b.value, 1, 0, 0);
    EXPECT_EQ(mix.base().direction, (Vec3d{3, 0, 4}));
    read("ptex", "");
    EXPECT_TRUE(has_warning("Ptex files are not supported"));
}

/// Coordinates (s, t) of a texture's mapping at (u, v), computed from its parameters.
Vec2f mapped(const Texture& t, double u, double v)
{
    const double c = std::cos(double(t.uv_rotation)), s = std::sin(double(t.uv_rotation));
    const double x = u * double(t.uv_scale.x), y = v * double(t.uv_scale.y);
    return {float(c * x + s * y) + t.uv_offset.x, float(-s * x + c * y) + t.uv_offset.y};
}

TEST_F(Pbrt, BilerpInterpolatesCorners)
{
    const Textured t{world(R"(Texture "t" "spectrum" "bilerp" "rgb v00" [ 0.1 0 0 ] "rgb v01" [ 0.2 0 0 ]
"rgb v10" [ 0.3 0 0 ] "rgb v11" [ 0.4 0 0 ] Material "diffuse" "texture reflectance" "t" Shape "sphere")")};
    // Coordinates may leave [0, 1], so colors are extrapolated.
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
    // v of meshes grows downwards in Fathom.
    EXPECT_NEAR(mapped(place, 0.25, 0.125).y, 0.875, 1e-6);
}

TEST_F(Pbrt, MappingsByPlace)
{
    const auto read = [&](const std::string& type, const std::string& parameters) {
        // The mirrored camera flips x.
        return Textured{load("a.pbrt", fmt::format(R"(Camera "perspective" WorldBegin AttributeBegin Translate 1 2 3
Texture "t" "spectrum" "{}" {} AttributeEnd
Material "diffuse" "texture reflectance" "t" Shape "sphere")",
                                                   type, parameters))};
    };
    const std::string picture = "\"string filename\" \"a.png\" ";
    // pbrt's spherical mapping: s is the polar angle, t the azimuth, so u and v are swapped.
    const Textured ball = read("imagemap", picture + "\"string mapping\" \"spherical\"");
    EXPECT_EQ(ball.base().mapping, TextureMapping::spherical);
    const Vec2f on_ball = mapped(ball.base(), 0.125, 0.25);
    EXPECT_NEAR(on_ball.x, 0.25, 1e-6);
    EXPECT_NEAR(on_ball.y, 1 - 0.125, 1e-6);
    // The sphere needs no texture coordinates, only the frame of the texture's definition in the mirrored world.
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
    // The point has y = 2 + 3 and z = 3 + 5.
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
    EXPECT_FALSE(has_warning("the wrap"));
}

TEST_F(Pbrt, HeightsBendNormals)
{
    const char* const waves = "Texture \"t\" \"float\" \"scale\" \"texture tex\" \"w\" \"float scale\" 0.25 ";
    const std::string windy = std::string("Texture \"w\" \"float\" \"windy\" ") + waves;
    const Material water = material(windy + "Material \"dielectric\" \"texture displacement\" \"t\"");
    EXPECT_GE(water.bump.texture, 0);
    EXPECT_EQ(water.bump.value, 0.25f);
    EXPECT_TRUE(warnings_.counts().empty());
    // A normal map takes precedence over displacement.
    const Material both = material(windy +
                                   "Material \"diffuse\" \"texture displacement\" \"t\" "
                                   "\"string normalmap\" \"n.png\"");
    EXPECT_LT(both.bump.texture, 0);
    EXPECT_GE(both.normal_map.texture, 0);
    EXPECT_FALSE(both.map_tangents);
}

TEST_F(Pbrt, AlphaMakesHoles)
{
    const SceneDescription scene = world("Shape \"sphere\" \"float alpha\" 0.25 Shape \"sphere\"");
    EXPECT_EQ(material_of(scene).opacity.alpha.value, 0.25f);
    EXPECT_EQ(material_of(scene).opacity.mode, AlphaMode::blend);
    EXPECT_EQ(scene.materials.at(std::size_t(scene.nodes.at(1).shapes.at(0).material)).opacity.mode, AlphaMode::opaque);
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
            const Vec3d n = area_vector(mesh, i);
            const Vec3f normal = mesh.normals[mesh.indices[i]];
            EXPECT_GT(n.x * normal.x + n.y * normal.y + n.z * normal.z, 0);
            sum += length(n);
        }
        return sum;
    };
    constexpr double pi = std::numbers::pi;
    EXPECT_NEAR(area("\"cylinder\" \"float radius\" 2 \"float zmin\" 0 \"float zmax\" 3"), 12 * pi, 0.01);
    EXPECT_NEAR(area("\"sphere\" \"float zmin\" 0"), 2 * pi, 0.01);
    EXPECT_NEAR(area("\"disk\" \"float innerradius\" 0.5 \"float phimax\" 180"), 0.375 * pi, 0.001);
    EXPECT_NEAR(area("\"bilinearmesh\" \"point3 P\" [ 0 0 0 2 0 0 0 3 0 2 3 0 ]"), 6, 1e-6);
}

/// pbrt's default texture coordinates (Triangle, BilinearPatch): (0, 0), (1, 0), (1, 1) at each triangle's corners, the
/// unit square for quads. v grows downwards in Fathom.
TEST_F(Pbrt, DefaultTextureCoordinates)
{
    const std::string textured =
        R"(Texture "t" "spectrum" "checkerboard" Material "diffuse" "texture reflectance" "t" )";
    const auto expect_corners = [](const Mesh& mesh, const std::vector<std::pair<Vec3f, Vec2f>>& expected) {
        ASSERT_EQ(mesh.indices.size(), expected.size());
        ASSERT_EQ(mesh.uvs[0].size(), mesh.positions.size());
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const auto& [p, uv] = expected[i];
            const Vec3f& at = mesh.positions[mesh.indices[i]];
            EXPECT_NEAR(std::hypot(at.x - p.x, at.y - p.y, at.z - p.z), 0, 1e-6) << i;
            EXPECT_EQ(mesh.uvs[0][mesh.indices[i]].x, uv.x) << i;
            EXPECT_EQ(mesh.uvs[0][mesh.indices[i]].y, uv.y) << i;
        }
    };
    const Vec3f a{0, 0, 0}, b{1, 0, 0}, c{1, 1, 0}, d{0, 1, 0};
    const std::string corners = R"( "point3 P" [ 0 0 0 1 0 0 1 1 0 0 1 0 ] "integer indices" [ 0 1 2 0 2 3 ] )";
    const Vec2f first{0, 1}, second{1, 1}, third{1, 0}, fourth{0, 0};
    expect_corners(mesh_of(world(textured + R"(Shape "trianglemesh")" + corners)),
                   {{a, first}, {b, second}, {c, third}, {a, first}, {c, second}, {d, third}});
    // Corners keep their coordinates when the triangle is reversed.
    expect_corners(mesh_of(world(textured + R"(ReverseOrientation Shape "trianglemesh")" + corners)),
                   {{a, first}, {c, third}, {b, second}, {a, first}, {d, third}, {c, second}});
    EXPECT_EQ(mesh_of(world(textured + R"(Shape "loopsubdiv" "integer levels" 1)" + corners)).uvs[0].size(), 24u);
    // Without a texture vertices stay shared.
    EXPECT_EQ(mesh_of(world(R"(Shape "trianglemesh")" + corners)).positions.size(), 4u);
    EXPECT_TRUE(mesh_of(world(R"(Shape "trianglemesh")" + corners)).uvs[0].empty());
    const std::string header =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
    const std::string points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    const auto ply = [&](const std::string& count, const std::string& faces) {
        write("a.ply", header + "element face " + count + "\nproperty list uchar int vertex_indices\nend_header\n" +
                           points + faces);
        return mesh_of(world(textured + R"(Shape "plymesh" "string filename" "a.ply")"));
    };
    expect_corners(ply("2", "3 0 1 2\n3 0 2 3\n"),
                   {{a, first}, {b, second}, {c, third}, {a, first}, {c, second}, {d, third}});
    expect_corners(ply("1", "4 0 1 2 3\n"), {{a, first}, {b, second}, {c, third}, {a, first}, {c, third}, {d, fourth}});
    expect_corners(ply("2", "3 3 0 1\n4 0 1 2 3\n"), {{d, first},
                                                      {a, second},
                                                      {b, third},
                                                      {a, first},
                                                      {b, second},
                                                      {c, third},
                                                      {a, first},
                                                      {c, third},
                                                      {d, fourth}});
    // A file used with and without a texture gives two meshes.
    const SceneDescription both = world(R"(Shape "plymesh" "string filename" "a.ply" )" + textured +
                                        R"(Shape "plymesh" "string filename" "a.ply")");
    ASSERT_EQ(both.meshes.size(), 2u);
    EXPECT_TRUE(both.meshes[0].uvs[0].empty());
    EXPECT_FALSE(both.meshes[1].uvs[0].empty());
    // An alpha texture also needs texture coordinates.
    EXPECT_FALSE(
        mesh_of(world(R"(Texture "t" "float" "checkerboard" Shape "trianglemesh" "texture alpha" "t")" + corners))
            .uvs[0]
            .empty());
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
    // A quadratic B-spline starts and ends at midpoints of its control polygon's sides, and touches the others there.
    const SceneDescription quadratic = world(
        R"(Shape "curve" "integer degree" 2 "string basis" "bspline" "point3 P" [ 0 0 0 2 4 0 4 0 0 8 2 0 ] "float width0" 0)");
    const Curves& spline = quadratic.curves.at(0);
    EXPECT_EQ(spline.basis, CurveBasis::bezier);
    ASSERT_EQ(spline.points.size(), 7u);
    EXPECT_EQ(spline.points[0].x, 1);
    EXPECT_EQ(spline.points[0].y, 2);
    EXPECT_EQ(spline.points[3].x, 3);
    EXPECT_EQ(spline.points[3].y, 2);
    EXPECT_EQ(spline.points[6].x, 6);
    EXPECT_EQ(spline.points[6].y, 1);
    // Degree elevation: the cubic point is two thirds of the way to the quadratic one.
    EXPECT_NEAR(spline.points[1].y, 2 + 2 * 2 / 3.0, 1e-6);
    EXPECT_NEAR(spline.radii[3], 0.25, 1e-6);
    // A cubic B-spline with varying width has the given widths at its ends.
    const SceneDescription cubic = world(
        R"(Shape "curve" "string basis" "bspline" "point3 P" [ 0 0 0 1 6 0 2 0 0 3 0 0 4 0 0 ] "float width0" 0 "float width1" 2)");
    const Curves& tapered = cubic.curves.at(0);
    EXPECT_EQ(tapered.basis, CurveBasis::bezier);
    ASSERT_EQ(tapered.points.size(), 7u);
    EXPECT_NEAR(tapered.points[0].x, 1, 1e-6);
    EXPECT_NEAR(tapered.points[0].y, 4, 1e-6);
    EXPECT_NEAR(tapered.points[3].y, 1, 1e-6);
    EXPECT_NEAR(tapered.points[6].x, 3, 1e-6);
    EXPECT_EQ(tapered.radii[0], 0);
    EXPECT_EQ(tapered.radii[6], 1);
    EXPECT_EQ(world(R"(Shape "curve" "string basis" "bspline" "point3 P" [ 0 0 0 1 6 0 2 0 0 3 0 0 4 0 0 ])")
                  .curves.at(0)
                  .basis,
              CurveBasis::bspline);
    // The limit surface of an octahedron is nearly a sphere and symmetric.
    const SceneDescription loop =
        world(R"(Shape "loopsubdiv" "integer levels" 3 "point3 P" [ 1 0 0 -1 0 0 0 1 0 0 -1 0 0 0 1 0 0 -1 ]
"integer indices" [ 0 2 4 2 1 4 1 3 4 3 0 4 2 0 5 1 2 5 3 1 5 0 3 5 ])");
    const Mesh& mesh = mesh_of(loop);
    EXPECT_EQ(mesh.indices.size(), 3u * 8 * 64);
    const auto radius = [&](std::size_t i) {
        return std::hypot(mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z);
    };
    // At a vertex of valence 4 the limit weight of the vertex is 1/2 because its neighbors cancel out.
    EXPECT_NEAR(radius(0), radius(4), 1e-6);
    EXPECT_GT(radius(0), 0.4);
    EXPECT_LT(radius(0), 0.8);
}

}  // namespace
}  // namespace fathom::test
