// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <tuple>

#include "compile/scene_data.h"
#include "fathom/editable_scene.h"
#include "fathom/image.h"
#include "geometry/displacement/displace.h"
#include "geometry/displacement/subdivision.h"
#include "geometry/displacement/texture_detail.h"

// Displacement along normals: expected shapes, and no gaps.
namespace fathom {
namespace {

/// A one-channel image file that is removed at the end.
class HeightFile {
public:
    HeightFile(int width, int height, const std::function<double(double, double)>& value)
    {
        static int count = 0;
        path = std::filesystem::temp_directory_path() /
               ("fathom_displacement_" + std::to_string(getpid()) + "_" + std::to_string(count++) + ".exr");
        Image image;
        image.width = width;
        image.height = height;
        image.layers.push_back({"", {"Y"}, {}});
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                image.layers[0].pixels.push_back(float(value((x + 0.5) / width, (y + 0.5) / height)));
        write_image(path, image, {});
    }
    ~HeightFile() { std::filesystem::remove(path); }

    std::filesystem::path path;
};

HeightFile random_heights(int size)
{
    std::mt19937 random(7);
    return HeightFile(size, size, [&](double, double) { return std::uniform_real_distribution<double>(0, 1)(random); });
}

/// A material with a constant displacement, or a texture times a constant.
Material displacing(float height, int texture = -1)
{
    Material m;
    m.displacement.height = {height, texture, 0};
    return m;
}

struct TestScene {
    SceneDescription d;

    TestScene()
    {
        d.file = "test";
        d.nodes.emplace_back();
        d.roots = {0};
        d.cameras.emplace_back();
        d.cameras[0].position = {0.5, 0.5, 5};
        d.cameras[0].look_at = {0.5, 0.5, 0};
        d.cameras[0].fov_y = 0.05;
        d.nodes[0].camera = 0;
    }
    int add_picture(const HeightFile& file)
    {
        d.images.push_back({"heights", file.path, {}});
        Texture t;
        t.image = int(d.images.size()) - 1;
        t.wrap_u = t.wrap_v = Wrap::clamp;
        d.textures.push_back(t);
        return int(d.textures.size()) - 1;
    }
    int add_material(const Material& m)
    {
        d.materials.push_back(m);
        return int(d.materials.size()) - 1;
    }
    template <class Geometry>
    void add(const Geometry& geometry, int material)
    {
        d.nodes[0].shapes.push_back({geometry, material, ""});
    }
    void add_mesh(Mesh mesh, int material)
    {
        d.meshes.push_back(std::move(mesh));
        add(MeshInstance{int(d.meshes.size()) - 1}, material);
    }
    Scene compiled() const
    {
        Warnings warnings;
        Scene scene = Scene::compile(d, "", warnings);
        for (const auto& [what, times] : warnings.counts()) ADD_FAILURE() << what;
        return scene;
    }
};

/// World-space triangles of a compiled scene; a quad gives the two triangles it was joined from.
std::vector<std::array<Vec3d, 3>> triangles_of(const Scene& scene)
{
    const SceneTables& t = *scene.data().tables;
    const auto in_world = [&](const Vec3d& p) { return p * (1 / t.render_scale) + t.origin; };
    std::vector<std::array<Vec3d, 3>> triangles(t.triangle_count());
    for (std::size_t i = 0; i < t.triangles.size(); ++i)
        triangles[i / 3][i % 3] = in_world(to_double(t.positions[t.triangles[i]]));
    for (const QuadRecord& q : t.quads) {
        const Vec3d corner = to_double(q.corner), u = corner + to_double(q.edge_u), v = corner + to_double(q.edge_v);
        triangles.push_back({in_world(corner), in_world(u), in_world(v)});
        triangles.push_back({in_world(u), in_world(u + v - corner), in_world(v)});
    }
    return triangles;
}

/// Number of edges without a neighboring triangle that runs along them in the opposite direction.
std::size_t open_edges(const std::vector<std::array<Vec3d, 3>>& triangles)
{
    const auto key = [](Vec3d p) { return std::tuple(p.x + 0.0, p.y + 0.0, p.z + 0.0); };
    using Place = decltype(key({}));
    std::map<std::pair<Place, Place>, int> count;
    for (const auto& t : triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const Place a = key(t[k]), b = key(t[(k + 1) % 3]);
            if (a == b) continue;
            ++count[{a, b}];
            --count[{b, a}];
        }
    return std::size_t(std::count_if(count.begin(), count.end(), [](const auto& c) { return c.second > 0; }));
}

Image rendered(const Scene& scene, std::vector<Aov> aovs, int size = 3, std::uint64_t samples = 4)
{
    RenderSettings settings;
    settings.width = settings.height = size;
    settings.aovs = std::move(aovs);
    const RenderJob job(scene, settings);
    Film film(job);
    render(job, {0, samples}, film);
    return film.image(false, false);
}

/// A sphere of rings and sectors with a seam in its texture coordinates and one vertex per sector at the poles.
Mesh ball(double radius, int rings, int sectors)
{
    Mesh mesh;
    for (int j = 0; j <= rings; ++j)
        for (int i = 0; i <= sectors; ++i) {
            const double phi = 2 * std::numbers::pi * (i % sectors) / sectors, theta = std::numbers::pi * j / rings;
            // The sine is exactly 0 at the poles; otherwise their vertices would have different positions.
            const double sine = j % rings == 0 ? 0 : std::sin(theta);
            const Vec3d n{sine * std::cos(phi), std::cos(theta), -sine * std::sin(phi)};
            mesh.positions.push_back({float(radius * n.x), float(radius * n.y), float(radius * n.z)});
            mesh.normals.push_back({float(n.x), float(n.y), float(n.z)});
            mesh.uvs[0].push_back({float(i) / float(sectors), float(j) / float(rings)});
        }
    for (int j = 0; j < rings; ++j)
        for (int i = 0; i < sectors; ++i) {
            const auto a = std::uint32_t(j * (sectors + 1) + i), b = a + 1, c = a + std::uint32_t(sectors) + 1;
            if (j > 0) mesh.indices.insert(mesh.indices.end(), {a, c, b});
            if (j + 1 < rings) mesh.indices.insert(mesh.indices.end(), {b, c, c + 1});
        }
    return mesh;
}

const Rectangle unit_square{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

TEST(Displacement, ANumberLiftsAPlane)
{
    for (const float midlevel : {0.0f, 0.25f}) {
        TestScene s;
        Material m = displacing(0.5f);
        m.displacement.midlevel = midlevel;
        s.add(unit_square, s.add_material(m));
        const Image image = rendered(s.compiled(), {Aov::depth});
        const double expected = 5 - 0.5 * (1 - double(midlevel));
        // Rays of the middle pixel deviate by up to 0.01 from the axis.
        EXPECT_NEAR(image.find("depth")->pixels.at(4), expected, 3e-4);
        const Bounds bounds = world_bounds(s.d);
        EXPECT_NEAR(bounds.min.z, 5 - expected, 1e-12);
        EXPECT_NEAR(bounds.max.z, 5 - expected, 1e-12);
    }
}

TEST(Displacement, ANumberMakesABallGreater)
{
    TestScene s;
    s.add_mesh(ball(1, 12, 20), s.add_material(displacing(0.25f)));
    const Scene scene = s.compiled();
    const SceneTables& t = *scene.data().tables;
    EXPECT_EQ(t.triangle_count(), 2u * 11 * 20);
    ASSERT_EQ(t.normals.size(), t.positions.size());
    for (std::size_t i = 0; i < t.positions.size(); ++i) {
        const Vec3d p = to_double(t.positions[i]) * (1 / t.render_scale) + t.origin;
        EXPECT_NEAR(length(p), 1.25, 1e-6);
        EXPECT_NEAR(dot(normalize(p), to_double(t.normals[i])), 1, 1e-6);
    }
    EXPECT_EQ(open_edges(triangles_of(scene)), 0u);
    const Bounds bounds = world_bounds(s.d);
    EXPECT_NEAR(bounds.max.y, 1.25, 1e-6);
    TestScene round;
    round.add(Sphere{{0, 0, 0}, 1, {}}, round.add_material(displacing(0.25f)));
    EXPECT_NEAR(world_bounds(round.d).max.x, 1.25, 1e-12);
    for (const auto& triangle : triangles_of(round.compiled()))
        for (const Vec3d& p : triangle) EXPECT_NEAR(length(p), 1.25, 1e-6);
}

TEST(Displacement, ARampTiltsAPlane)
{
    const HeightFile ramp(64, 64, [](double u, double v) { return 0.75 * u + 0.25 * v; });
    for (const bool is_mesh : {false, true}) {
        TestScene s;
        const int material = s.add_material(displacing(0.5f, s.add_picture(ramp)));
        Mesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
        mesh.uvs[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
        mesh.normals.assign(4, {0, 0, 1});
        mesh.indices = {0, 1, 2, 0, 2, 3};
        if (is_mesh)
            s.add_mesh(mesh, material);
        else
            s.add(unit_square, material);
        const Scene scene = s.compiled();
        // The subdivision matches the texel size.
        EXPECT_EQ(scene.data().tables->triangle_count(), 2u * 64 * 64);
        const Image image = rendered(scene, {Aov::depth, Aov::normal}, 3, 64);
        EXPECT_NEAR(image.find("depth")->pixels.at(4), 5 - 0.5 * (0.75 * 0.5 + 0.25 * 0.5), 2e-3);
        // The sign of y is flipped because v grows downwards.
        const Vec3d n = normalize(Vec3d{-0.375, 0.125, 1});
        const std::vector<float>& normal = image.find("normal")->pixels;
        EXPECT_NEAR(normal.at(12), n.x, 1e-4);
        EXPECT_NEAR(normal.at(13), n.y, 1e-4);
        EXPECT_NEAR(normal.at(14), n.z, 1e-4);
    }
}

/// Subdivision for a 64 x 32 texture that is mapped by position, in a texture space of half the size.
TEST(Displacement, DetailFollowsMappingsByPlace)
{
    Mesh mesh;
    mesh.positions = {{0.5f, 0, 0}, {0, 0.5f, 0.375f}, {-0.5f, 0.05f, 0}, {-0.5f, -0.05f, 0}, {0, 0, 0.5f}};
    ShadingTables tables;
    tables.texture_spaces = {{{{{2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 2, 0}}}}};
    TextureRecord picture;
    picture.kind = std::uint32_t(TextureKind::image);
    picture.width = 64, picture.height = 32;
    picture.space = 0;
    const auto parts = [&](TextureMapping mapping, std::uint32_t a, std::uint32_t b) {
        picture.mapping = std::uint32_t(mapping);
        tables.textures = {picture};
        return TextureDetail(tables, 0).parts(mesh, a, b);
    };
    EXPECT_NEAR(parts(TextureMapping::planar, 0, 1), 64, 1e-6);
    EXPECT_NEAR(parts(TextureMapping::cylindrical, 0, 1), 0.75 * 32, 1e-6);
    // This edge crosses the seam of the azimuth.
    EXPECT_NEAR(parts(TextureMapping::cylindrical, 2, 3), 64 * std::atan(0.1) / std::numbers::pi, 1e-4);
    EXPECT_NEAR(parts(TextureMapping::spherical, 0, 4), 16, 1e-6);
    // A 3D texture in the smaller space needs a finer subdivision.
    TextureRecord noise;
    noise.kind = std::uint32_t(TextureKind::fbm), noise.octaves = 1;
    tables.textures = {noise};
    const double plain = TextureDetail(tables, 0).parts(mesh, 0, 1);
    tables.textures[0].space = 0;
    EXPECT_GE(TextureDetail(tables, 0).parts(mesh, 0, 1), 2 * plain * (1 - 1e-6));
}

TEST(Displacement, NoGapsAtHardEdgesAndSeams)
{
    const HeightFile heights = random_heights(16);
    TestScene s;
    const int material = s.add_material(displacing(0.05f, s.add_picture(heights)));
    s.add(Box{{0, 0, 0}, {1, 1.5, 0.5}}, material);
    const auto box = triangles_of(s.compiled());
    EXPECT_EQ(box.size(), 6u * 2 * 16 * 16);
    EXPECT_EQ(open_edges(box), 0u);

    TestScene round;
    const int rough = round.add_material(displacing(0.1f, round.add_picture(heights)));
    round.add_mesh(ball(1, 5, 7), rough);
    const auto balls = triangles_of(round.compiled());
    EXPECT_GT(balls.size(), 500u);
    EXPECT_EQ(open_edges(balls), 0u);
    TestScene sphere;
    sphere.add(Sphere{{0, 0, 0}, 1, {}}, sphere.add_material(displacing(0.1f, sphere.add_picture(heights))));
    EXPECT_EQ(open_edges(triangles_of(sphere.compiled())), 0u);
    // An open border stays one, with each part of its divided edges exactly once.
    TestScene open;
    open.add(unit_square, open.add_material(displacing(0.05f, open.add_picture(heights))));
    EXPECT_EQ(open_edges(triangles_of(open.compiled())), 4u * 16);
}

/// No light from outside enters a closed shape.
TEST(Displacement, AClosedBoxLetsNoLightIn)
{
    const HeightFile heights = random_heights(32);
    TestScene s;
    Material m = displacing(0.1f, s.add_picture(heights));
    m.kind = MaterialKind::none;
    s.add(Box{{-1, -1, -1}, {1, 1, 1}}, s.add_material(m));
    s.d.cameras[0].position = {0.1, 0.2, 0.3};
    s.d.cameras[0].look_at = {1, 1, 1};
    s.d.cameras[0].fov_y = 2.5;
    s.d.environment.kind = EnvironmentKind::constant;
    const Image image = rendered(s.compiled(), {}, 64, 16);
    for (const float value : image.layers[0].pixels) ASSERT_EQ(value, 0);
}

/// For any subdivision of the edges, the parts of a triangle lie in it, keep its orientation and cover it.
TEST(Displacement, TrianglesAreCutIntoTheirParts)
{
    std::mt19937 random(3);
    for (int run = 0; run < 300; ++run) {
        Mesh mesh;
        mesh.positions = {{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {3, 2, 0}};
        mesh.normals.assign(4, {0, 0, 1});
        mesh.indices = {0, 1, 2, 2, 1, 3};
        const WeldedMesh welded(mesh);
        ASSERT_EQ(welded.edges(), 5u);
        std::vector<std::uint8_t> exponents;
        for (int e = 0; e < 5; ++e) exponents.push_back(std::uint8_t(random() % 5));
        const Subdivision cut(mesh, welded, exponents);
        std::vector<Vec3d> places(cut.vertices());
        cut.for_each_vertex([&](std::uint32_t v, const Blend& b) {
            for (std::size_t k = 0; k < 3; ++k)
                places[v] = places[v] + to_double(mesh.positions[b.vertex[k]]) * b.weight[k];
        });
        const std::vector<std::uint32_t> indices = cut.triangles();
        double area = 0;
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
        for (std::size_t i = 0; i < indices.size(); i += 3) {
            const Vec3d a = places[indices[i]];
            const Vec3d n = cross(places[indices[i + 1]] - a, places[indices[i + 2]] - a);
            ASSERT_GT(n.z, 1e-9);
            area += n.z / 2;
            for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(indices[i + k], indices[i + (k + 1) % 3])];
        }
        EXPECT_NEAR(area, 6, 1e-9);
        EXPECT_EQ(double(indices.size() / 3), Subdivision::size(mesh, welded, exponents).triangles);
        EXPECT_EQ(double(places.size()), Subdivision::size(mesh, welded, exponents).vertices);
        // All parts of the outer edges occur exactly once.
        std::size_t once = 0, expected = 0;
        for (const auto& [edge, times] : edges) {
            ASSERT_LE(times, 2);
            once += times == 1;
        }
        for (std::size_t e = 0; e < 5; ++e)
            if (welded.halves_of(e).size() == 1) expected += cut.parts_of_edge(e);
        EXPECT_EQ(once, expected);
    }
}

/// A bent strip with smooth shading, and one with a hard edge.
TEST(Displacement, HardEdgesStayHardAndSmoothOnesSmooth)
{
    for (const bool smooth : {false, true}) {
        Mesh mesh;
        mesh.positions = {{-1, 0, 0}, {0, 0, 1}, {0, 1, 1}, {-1, 1, 0}, {1, 0, 0}, {1, 1, 0}};
        mesh.indices = {0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2};
        const float s = std::sqrt(0.5f);
        if (smooth) mesh.normals = {{-s, 0, s}, {0, 0, 1}, {0, 0, 1}, {-s, 0, s}, {s, 0, s}, {s, 0, s}};
        Displacement by;
        by.parts = [](const Mesh&, std::uint32_t, std::uint32_t) { return 4.0; };
        by.heights = [](const Mesh&, std::size_t begin, std::size_t end, float* to) {
            std::fill(to, to + (end - begin), 0.125f);
        };
        const Mesh fine = displace(mesh, by, "test", "mesh").mesh;
        int ridge = 0;
        for (std::size_t i = 0; i < fine.positions.size(); ++i) {
            const Vec3d p = to_double(fine.positions[i]), n = to_double(fine.normals[i]);
            EXPECT_NEAR(length(n), 1, 1e-6);
            if (std::abs(p.x) > 1e-6) continue;
            ++ridge;
            // The whole ridge moves along its mean normal; with a hard edge, shading normals are those of the adjacent
            // slopes.
            EXPECT_NEAR(p.z, 1.125, 1e-6);
            // At the ends of the ridge one side has more triangles, which don't all move equally.
            if (smooth)
                EXPECT_NEAR(n.z, 1, 1e-3);
            else
                EXPECT_GT(std::abs(n.x), 0.6);
        }
        EXPECT_GE(ridge, 5);
    }
}

/// If only one of two slopes is displaced, the normals of the other stay unchanged up to a hard ridge.
TEST(Displacement, WhatIsBeyondAHardEdgeIsNotBent)
{
    Mesh mesh;
    mesh.positions = {{-1, 0, 0}, {0, 0, 1}, {0, 1, 1}, {-1, 1, 0}, {1, 0, 0}, {1, 1, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2};
    Displacement by;
    by.parts = [](const Mesh&, std::uint32_t, std::uint32_t) { return 4.0; };
    by.heights = [](const Mesh& m, std::size_t begin, std::size_t end, float* to) {
        for (std::size_t i = begin; i < end; ++i) to[i - begin] = 0.5f * std::max(m.positions[i].x, 0.0f);
    };
    const Mesh fine = displace(mesh, by, "test", "mesh").mesh;
    const double s = std::sqrt(0.5);
    int left = 0, right = 0;
    for (std::size_t i = 0; i < fine.positions.size(); ++i) {
        const Vec3d p = to_double(fine.positions[i]), n = to_double(fine.normals[i]);
        if (std::abs(p.x) > 1e-6) continue;
        // The right slope descends by 1 over a distance of sqrt(2), along which the displacement rises by 1/2.
        const double turn = std::atan(0.5 * s);
        const bool is_left = n.x < 0;
        const double angle = is_left ? 0.75 * std::numbers::pi : 0.25 * std::numbers::pi + turn;
        EXPECT_NEAR(n.x, std::cos(angle), 1e-6);
        EXPECT_NEAR(n.z, std::sin(angle), 1e-6);
        ++(is_left ? left : right);
    }
    EXPECT_GE(left, 5);
    EXPECT_GE(right, 5);
}

/// Bounds assume that a texture may have any value from 0 to 1.
TEST(Displacement, BoundsHoldWhatPicturesMayMove)
{
    Material m = displacing(0.5f, 0);
    m.displacement.midlevel = 0.25f;
    Mesh flat;
    flat.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    flat.indices = {0, 1, 2};
    Mesh with_normals = flat;
    with_normals.normals.assign(3, {0, 0, 2});
    TestScene a, b, c, e;
    a.add_mesh(flat, a.add_material(m));
    b.add_mesh(with_normals, b.add_material(m));
    c.add(unit_square, c.add_material(m));
    e.add(Disk{{0.5, 0.5, 0}, {0, 0, 3}, 0.5}, e.add_material(m));
    for (const TestScene* s : {&a, &b, &c, &e}) {
        const Bounds bounds = world_bounds(s->d);
        EXPECT_NEAR(bounds.min.z, -0.125, 1e-7);
        EXPECT_NEAR(bounds.max.z, 0.375, 1e-7);
        EXPECT_NEAR(bounds.max.x, 1, 1e-7);
    }
    TestScene ball, hollow, box;
    ball.add(Sphere{{0, 0, 0}, 1, {}}, ball.add_material(m));
    hollow.add(Sphere{{0, 0, 0}, -1, {}}, hollow.add_material(m));
    box.add(Box{{-1, -1, -1}, {1, 1, 1}}, box.add_material(m));
    EXPECT_NEAR(world_bounds(ball.d).max.x, 1.375, 1e-7);
    EXPECT_NEAR(world_bounds(hollow.d).max.x, 1.125, 1e-7);
    EXPECT_NEAR(world_bounds(box.d).max.x, 1.375, 1e-7);
}

TEST(Displacement, TheEdgeLengthIsKept)
{
    TestScene s;
    Material m = displacing(0.1f);
    m.displacement.edge_length = 0.3;
    s.add(unit_square, s.add_material(m));
    // Edges get 4 parts, the diagonal 8 because it is longer than 4 times the edge length.
    const auto triangles = triangles_of(s.compiled());
    double longest = 0;
    for (const auto& t : triangles)
        for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, length(t[(k + 1) % 3] - t[k]));
    EXPECT_LE(longest, 0.3 + 1e-6);
    EXPECT_EQ(triangles.size(), 2u * (8 * 8 - 4 - 4));
}

TEST(Displacement, ReportsReducedTriangles)
{
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.indices = {0, 1, 2};
    Displacement by;
    by.may_be_coarser = true;
    by.parts = [](const Mesh&, std::uint32_t, std::uint32_t) { return 4096.0; };
    by.heights = [](const Mesh&, std::size_t begin, std::size_t end, float* to) {
        std::fill(to, to + (end - begin), 0.0f);
    };
    const Displaced displaced = displace(mesh, by, "test", "mesh");
    EXPECT_EQ(displaced.wanted_triangles, 4096.0 * 4096);
    EXPECT_EQ(displaced.mesh.indices.size() / 3, 2048u * 2048);
}

/// A mesh with two materials gets the displacement of each, as if it were alone.
TEST(Displacement, InstancesHaveWhatTheirMaterialsSay)
{
    TestScene s;
    const int plain = s.add_material({}), lifted = s.add_material(displacing(0.5f)),
              more = s.add_material(displacing(1));
    Mesh mesh;
    const int parts = 48;
    for (int j = 0; j <= parts; ++j)
        for (int i = 0; i <= parts; ++i) mesh.positions.push_back({float(i) / parts, float(j) / parts, 0});
    for (std::uint32_t j = 0; j < parts; ++j)
        for (std::uint32_t i = 0; i < parts; ++i) {
            const std::uint32_t a = j * (parts + 1) + i, b = a + parts + 1;
            mesh.indices.insert(mesh.indices.end(), {a, a + 1, b, b, a + 1, b + 1});
        }
    s.d.meshes.push_back(mesh);
    const int materials[] = {plain, lifted, more, lifted};
    const double heights[] = {0, 0.5, 1, 0.5};
    for (int i = 0; i < 4; ++i) {
        Node node;
        node.parent_from_node = Transform::translate({2.0 * i, 0, 0});
        node.shapes.push_back({MeshInstance{0}, materials[i], ""});
        s.d.roots.push_back(int(s.d.nodes.size()));
        s.d.nodes.push_back(node);
    }
    for (int i = 0; i < 4; ++i) {
        s.d.cameras[0].position = {2.0 * i + 0.51, 0.51, 5};
        s.d.cameras[0].look_at = {2.0 * i + 0.51, 0.51, 0};
        const Scene scene = s.compiled();
        EXPECT_EQ(scene.data().tables->instances.size(), 2u);
        EXPECT_NEAR(rendered(scene, {Aov::depth}).find("depth")->pixels.at(4), 5 - heights[i], 3e-4) << i;
    }
}

TEST(Displacement, MovingVerticesAreMovedAtEachKey)
{
    TestScene s;
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals.assign(3, {0, 0, 1});
    mesh.indices = {0, 1, 2};
    mesh.motion.push_back({0, mesh.positions, mesh.normals});
    // At the second key the triangle is rotated to face +x.
    mesh.motion.push_back({1, {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}, std::vector<Vec3f>(3, {1, 0, 0})});
    s.d.cameras[0].shutter_close = 1;
    s.add_mesh(mesh, s.add_material(displacing(0.5f)));
    const Scene scene = s.compiled();
    const SceneTables& t = *scene.data().tables;
    ASSERT_EQ(t.positions.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
        const Vec3d p = to_double(t.positions[i]) * (1 / t.render_scale) + t.origin;
        EXPECT_NEAR(i < 3 ? p.z : p.x, 0.5, 1e-6) << i;
        EXPECT_NEAR(i < 3 ? t.normals[i].z : t.normals[i].x, 1, 1e-6) << i;
    }
}

/// An emissive surface tilted by displacement illuminates like one that was built tilted.
TEST(Displacement, LampsShineFromWhereTheyAre)
{
    const HeightFile ramp(16, 16, [](double u, double) { return u; });
    const auto mean = [&](bool displaced, double& variance) {
        TestScene s;
        Material lamp;
        lamp.kind = MaterialKind::none;
        lamp.emission.radiance.value = {5, 5, 5};
        if (displaced) lamp.displacement.height = {0.5f, s.add_picture(ramp), 0};
        const int shining = s.add_material(lamp);
        // The image is constant before the center of the first texel and after that of the last.
        const auto height = [](int i) { return 1 - 0.5 * std::clamp(i / 16.0, 1 / 32.0, 31 / 32.0); };
        if (displaced) s.add(Rectangle{{-1, -1, 1}, {0, 2, 0}, {2, 0, 0}}, shining);
        for (int i = 0; !displaced && i < 16; ++i)
            s.add(Rectangle{{-1, i / 8.0 - 1, height(i)}, {0, 1 / 8.0, height(i + 1) - height(i)}, {2, 0, 0}}, shining);
        s.add(Rectangle{{-9, -9, 0}, {18, 0, 0}, {0, 18, 0}}, s.add_material({}));
        s.d.cameras[0].position = {3, 0.5, 0.4};
        s.d.cameras[0].look_at = {1.5, 0.5, 0};
        RenderSettings settings;
        settings.width = settings.height = 8;
        settings.max_depth = 1;
        settings.seed = displaced ? 1 : 2;
        const RenderJob job(s.compiled(), settings);
        Film film(job);
        render(job, {0, 1024}, film);
        const Image image = film.image(false, true);
        const Image::Layer* noise = image.find("variance");
        double sum = 0;
        variance = 0;
        for (std::size_t i = 0; i < 64; ++i) {
            sum += double(image.layers[0].pixels[3 * i]) / 64;
            if (noise) variance += double(noise->pixels[3 * i]) / (64 * 64);
        }
        return sum;
    };
    double v1, v2;
    const double by_map = mean(true, v1), by_hand = mean(false, v2);
    EXPECT_GT(by_hand, 0.01);
    ASSERT_GT(v1 + v2, 0);
    EXPECT_LT(std::abs(by_map - by_hand), 4 * std::sqrt(v1 + v2));
}

TEST(Displacement, TheBitsAreThoseOfOneThread)
{
    const HeightFile heights = random_heights(64);
    TestScene s;
    const int material = s.add_material(displacing(0.1f, s.add_picture(heights)));
    s.add_mesh(ball(1, 6, 9), material);
    s.add(Box{{2, 0, 0}, {3, 1, 1}}, material);
    const std::uint64_t many = s.compiled().fingerprint();
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(s.compiled().fingerprint(), many);
}

TEST(Displacement, EditsAreThoseOfTheSceneMadeAnew)
{
    const HeightFile heights = random_heights(16);
    TestScene s;
    const int texture = s.add_picture(heights), material = s.add_material(displacing(0.1f, texture));
    Mesh soft = ball(1, 6, 9);
    soft.movable = true;
    s.add_mesh(soft, material);
    Node node;
    node.movable = true;
    node.shapes.push_back({Sphere{{0, 0, 0}, 0.5, {}}, material, ""});
    s.d.roots.push_back(1);
    s.d.nodes.push_back(node);
    EditableScene edit(s.d);
    const auto expect_same = [&](bool anew) {
        Warnings warnings;
        const std::uint64_t edited = edit.compile(warnings).fingerprint();
        EXPECT_EQ(edited, Scene::compile(edit.description(), "", warnings).fingerprint());
        EXPECT_EQ(edit.recompiled(), anew);
        return edited;
    };
    const std::uint64_t first = expect_same(true);
    edit.set_transform(1, Transform::translate({0.25, 0.5, 0.125}));
    const std::uint64_t elsewhere = expect_same(false);
    EXPECT_NE(elsewhere, first);
    Material colored = s.d.materials[0];
    colored.base_color.value = {0.1f, 0.2f, 0.3f};
    edit.set_material(material, colored);
    expect_same(false);
    Material higher = colored;
    higher.displacement.height.value = 0.2f;
    edit.set_material(material, higher);
    const std::uint64_t high = expect_same(true);
    higher.displacement.midlevel = 0.5f;
    edit.set_material(material, higher);
    EXPECT_NE(expect_same(true), high);
    std::vector<Vec3f> positions = soft.positions;
    for (Vec3f& p : positions) p.x *= 1.5f;
    edit.set_vertices(0, positions, soft.normals);
    expect_same(true);
    higher.displacement.height.value = 0;
    edit.set_material(material, higher);
    expect_same(true);
}

TEST(Displacement, ReportsUnsupportedDisplacement)
{
    TestScene s;
    const int material = s.add_material(displacing(0.1f));
    s.add(Sphere{{0, 0, 0}, 1, Vec3d{1, 0, 0}}, material);
    Warnings warnings;
    const Scene scene = Scene::compile(s.d, "", warnings);
    ASSERT_EQ(warnings.counts().size(), 1u);
    EXPECT_NE(warnings.counts().begin()->first.find("center_end"), std::string::npos);
    EXPECT_EQ(scene.data().tables->spheres.size(), 1u);
}

}  // namespace
}  // namespace fathom
