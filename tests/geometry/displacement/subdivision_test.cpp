// SPDX-License-Identifier: Apache-2.0
#include "geometry/displacement/subdivision.h"

#include <gtest/gtest.h>

#include "geometry/displacement/displace.h"
#include "geometry/displacement/displacement_scenes.h"
#include "geometry/displacement/texture_detail.h"

// Number and shape of the parts that triangles are cut into.
namespace fathom {
namespace {

using namespace test;

/// Subdivision is that for a 64 x 32 texture that is mapped by position, in a texture space of half the size.
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

}  // namespace
}  // namespace fathom
