// SPDX-License-Identifier: Apache-2.0
#include "scene/motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/near.h"

namespace fathom {
namespace {

using test::expect_near;

/// Rotation, scale and translation are interpolated separately and composed in that order.
TEST(NodeMotion, PartsMoveIndependently)
{
    Node node;
    const Vec3d axis{1, -2, 0.5};
    node.motion = {{1, Transform::translate({1, 2, 3}) * Transform::rotate(axis, 0.5) * Transform::scale({1, 2, 3})},
                   {3, Transform::translate({5, 0, 3}) * Transform::rotate(axis, 2.5) * Transform::scale({3, 2, 1})},
                   {4, Transform::translate({5, 0, 9})}};
    for (double f : {0.0, 0.2, 0.5, 0.9}) {
        const Transform expected = Transform::translate({1 + 4 * f, 2 - 2 * f, 3}) *
                                   Transform::rotate(axis, 0.5 + 2 * f) * Transform::scale({1 + 2 * f, 2, 3 - 2 * f});
        for (const Vec3d& p : {Vec3d{0, 0, 0}, {1, 2, 3}, {-1, 0.5, 0}})
            expect_near(transform_at(node, 1 + 2 * f).point(p), expected.point(p), 1e-9);
    }
    expect_near(transform_at(node, 0).point({1, 1, 1}), node.motion[0].parent_from_node.point({1, 1, 1}), 1e-9);
    expect_near(transform_at(node, 3).point({1, 1, 1}), node.motion[1].parent_from_node.point({1, 1, 1}), 1e-9);
    expect_near(transform_at(node, 9).point({1, 1, 1}), {6, 1, 10}, 1e-9);
    // The rest transform is ignored while keys exist.
    node.parent_from_node = Transform::scale({7, 7, 7});
    expect_near(transform_at(node, 9).point({1, 1, 1}), {6, 1, 10}, 1e-9);
    node.motion.clear();
    expect_near(transform_at(node, 9).point({1, 1, 1}), {7, 7, 7}, 1e-9);
}

TEST(MeshMotion, VerticesGoStraightBetweenTheirKeys)
{
    Mesh mesh;
    mesh.positions = {{9, 9, 9}};
    mesh.normals = {{9, 9, 9}};
    mesh.motion = {{0, {{0, 0, 0}}, {{1, 0, 0}}}, {2, {{4, 8, 0}}, {{0, 1, 0}}}, {3, {{4, 8, 6}}, {{0, 0, 1}}}};
    struct Case {
        double time;
        Vec3f p, n;
    };
    for (const Case& c : {Case{-1, {0, 0, 0}, {1, 0, 0}},
                          {0.5, {1, 2, 0}, {0.75f, 0.25f, 0}},
                          {2, {4, 8, 0}, {0, 1, 0}},
                          {2.5, {4, 8, 3}, {0, 0.5f, 0.5f}},
                          {7, {4, 8, 6}, {0, 0, 1}}}) {
        const MeshKey key = vertices_at(mesh, c.time);
        EXPECT_FLOAT_EQ(key.positions[0].x, c.p.x) << c.time;
        EXPECT_FLOAT_EQ(key.positions[0].y, c.p.y) << c.time;
        EXPECT_FLOAT_EQ(key.positions[0].z, c.p.z) << c.time;
        EXPECT_FLOAT_EQ(key.normals[0].x, c.n.x) << c.time;
        EXPECT_FLOAT_EQ(key.normals[0].y, c.n.y) << c.time;
        EXPECT_FLOAT_EQ(key.normals[0].z, c.n.z) << c.time;
    }
    EXPECT_TRUE(moves(mesh, 0.5, 0.6));
    EXPECT_FALSE(moves(mesh, 3, 4));
    EXPECT_FALSE(moves(mesh, -2, 0));
    mesh.motion[2].positions = mesh.motion[1].positions;
    EXPECT_TRUE(moves(mesh, 2.1, 2.9));  // the mesh's normals change
    mesh.motion[2].normals = mesh.motion[1].normals;
    EXPECT_FALSE(moves(mesh, 2.1, 2.9));
}

TEST(CurvesMotion, PointsAndRadiiGoStraightBetweenTheirKeys)
{
    Curves curves;
    curves.points = {{9, 9, 9}};
    curves.radii = {9};
    curves.motion = {{0, {{0, 0, 0}}, {1}}, {2, {{4, 8, 0}}, {3}}, {3, {{4, 8, 0}}, {0}}};
    struct Case {
        double time;
        Vec3f p;
        float radius;
    };
    for (const Case& c : {Case{-1, {0, 0, 0}, 1},
                          {0.5, {1, 2, 0}, 1.5f},
                          {2, {4, 8, 0}, 3},
                          {2.5, {4, 8, 0}, 1.5f},
                          {7, {4, 8, 0}, 0}}) {
        const CurvesKey key = points_at(curves, c.time);
        EXPECT_FLOAT_EQ(key.points[0].x, c.p.x) << c.time;
        EXPECT_FLOAT_EQ(key.points[0].y, c.p.y) << c.time;
        EXPECT_FLOAT_EQ(key.points[0].z, c.p.z) << c.time;
        EXPECT_FLOAT_EQ(key.radii[0], c.radius) << c.time;
    }
    EXPECT_TRUE(moves(curves, 0.5, 0.6));
    EXPECT_TRUE(moves(curves, 2.1, 2.9));  // the curves' radii change
    EXPECT_FALSE(moves(curves, 3, 4));
    EXPECT_FALSE(moves(curves, 1, 1));
    curves.motion[2].radii = curves.motion[1].radii;
    EXPECT_FALSE(moves(curves, 2.1, 2.9));
}

}  // namespace
}  // namespace fathom
