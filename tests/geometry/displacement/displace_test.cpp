// SPDX-License-Identifier: Apache-2.0
#include "geometry/displacement/displace.h"

#include <gtest/gtest.h>

#include "geometry/displacement/displacement_scenes.h"

// Tests of displacement along normals: expected shapes, and no gaps.
namespace fathom {
namespace {

using namespace test;

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

/// A bent strip with smooth shading is compared with one that has a hard edge.
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

}  // namespace
}  // namespace fathom
