// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fathom/load.h"
#include "support/near.h"

namespace fathom {
namespace {

using test::expect_near;

const Vec3d points[] = {{0, 0, 0}, {1, 2, 3}, {-4, 0.5, 2}};

TEST(Transform, ByHand)
{
    expect_near(Transform::translate({1, 2, 3}).point({10, 20, 30}), {11, 22, 33});
    expect_near(Transform::translate({1, 2, 3}).vector({10, 20, 30}), {10, 20, 30});
    expect_near(Transform::scale({1, 2, 3}).point({10, 20, 30}), {10, 40, 90});
    // Right-handed rotations take x to y to z to x.
    const double right = std::numbers::pi / 2;
    expect_near(Transform::rotate({0, 0, 5}, right).point({1, 0, 0}), {0, 1, 0});
    expect_near(Transform::rotate({5, 0, 0}, right).point({0, 1, 0}), {0, 0, 1});
    expect_near(Transform::rotate({0, 5, 0}, right).point({0, 0, 1}), {1, 0, 0});
    // A third of a turn about the diagonal permutes the axes.
    expect_near(Transform::rotate({1, 1, 1}, 2 * std::numbers::pi / 3).point({1, 2, 3}), {3, 1, 2});
    // The rotations are half a turn about x, and a unit quaternion with four distinct components, by the sandwich
    // product.
    expect_near(Transform::rotate_quaternion(2, 0, 0, 0).point({1, 2, 3}), {1, -2, -3});
    const Vec3d u{0.1, 0.5, -0.7};
    const double w = 0.5, length2 = dot(u, u) + w * w;
    for (const Vec3d& v : points) {
        const Vec3d t = cross(u, v) * 2.0;
        expect_near(Transform::rotate_quaternion(u.x, u.y, u.z, w).point(v), v + (t * w + cross(u, t)) * (1 / length2));
    }
}

Transform odd()
{
    Transform t = Transform::translate({3, -1, 2}) * Transform::rotate({1, 2, 3}, 1) * Transform::scale({2, -3, 0.5});
    t.m[0][1] += 0.7;
    return t;
}

TEST(Transform, ProductInverseAndDeterminant)
{
    const Transform a = odd(), b = Transform::rotate({0, 1, -1}, 2) * Transform::translate({5, 6, 7});
    for (const Vec3d& p : points) {
        expect_near((a * b).point(p), a.point(b.point(p)));
        expect_near((a * b).vector(p), a.vector(b.vector(p)));
        expect_near(a.inverse().point(a.point(p)), p);
        expect_near(a.point(a.inverse().point(p)), p);
    }
    EXPECT_NEAR(Transform::scale({2, -3, 0.5}).determinant(), -3, 1e-12);
    EXPECT_NEAR(dot(a.vector({1, 0, 0}), cross(a.vector({0, 1, 0}), a.vector({0, 0, 1}))), a.determinant(), 1e-12);
}

/// A camera is transformed by its node, including its lengths.
TEST(WorldCamera, TakesPlaceAndScaleOfItsNode)
{
    SceneDescription scene;
    Camera camera;
    camera.name = "second";
    camera.position = {1, 0, 0}, camera.look_at = {1, 0, -2}, camera.up = {0, 1, 0};
    camera.height = 2, camera.aperture = 0.1, camera.focus_distance = 3;
    scene.cameras = {Camera{}, camera};
    scene.nodes.resize(3);
    scene.nodes[0].parent_from_node = Transform::translate({0, 10, 0});
    scene.nodes[0].children = {1};
    scene.nodes[1].parent_from_node = Transform::rotate({0, 1, 0}, std::numbers::pi / 2) * Transform::scale({3, 3, 3});
    scene.nodes[1].camera = 1;
    scene.nodes[2].camera = 0;
    scene.roots = {2, 0};
    const Camera placed = world_camera(scene, "second");
    expect_near(placed.position, {0, 10, -3});
    expect_near(placed.look_at, {-6, 10, -3});
    EXPECT_GT(placed.up.y, 0);
    EXPECT_NEAR(placed.height, 6, 1e-12);
    EXPECT_NEAR(placed.aperture, 0.3, 1e-12);
    EXPECT_NEAR(placed.focus_distance, 9, 1e-12);
    EXPECT_EQ(world_camera(scene, "").name, "");
}

/// World bounds are those of each kind of shape.
TEST(WorldBounds, OfEachShape)
{
    struct Case {
        decltype(Shape::geometry) geometry;
        Vec3d min, max;
    };
    const Case cases[] = {{Sphere{{1, 0, 0}, -1, {}}, {10, -1, -1}, {14, 1, 1}},
                          {Sphere{{0, 0, 0}, 1, Vec3d{0, 5, 0}}, {8, -1, -1}, {12, 6, 1}},
                          {Rectangle{{0, 0, 0}, {1, 1, 0}, {-1, 1, 3}}, {8, 0, 0}, {12, 2, 3}},
                          {Box{{-1, -2, -3}, {1, 2, 3}}, {8, -2, -3}, {12, 2, 3}},
                          {Disk{{0, 0, 0}, {0, 0, 2}, 3}, {4, -3, 0}, {16, 3, 0}},
                          {MeshInstance{0}, {10, 0, 0}, {14, 3, 4}},
                          {CurvesInstance{0}, {9, -0.5, -0.5}, {13, 0.5, 0.5}},
                          {CurvesInstance{1}, {8, -1, -1}, {20, 2, 1}},
                          {PointsInstance{0}, {13, 1.5, 2.5}, {15, 2.5, 3.5}}};
    for (const Case& c : cases) {
        SceneDescription scene;
        scene.meshes.emplace_back();
        scene.meshes[0].positions = {{0, 0, 0}, {2, 0, 0}, {0, 3, 4}};
        scene.curves.emplace_back();
        scene.curves[0].points = {{0, 0, 0}, {1, 0, 0}};
        scene.curves[0].radii = {0.5f, 0.5f};
        // Bounds are those of the moving points, not of their rest positions.
        scene.curves.push_back(scene.curves[0]);
        scene.curves[1].points = {{99, 0, 0}, {99, 0, 0}};
        scene.curves[1].motion = {{0, {{0, 0, 0}, {1, 0, 0}}, {0.5f, 0.5f}}, {1, {{0, 1, 0}, {4, 0, 0}}, {1, 1}}};
        scene.points.emplace_back();
        scene.points[0].centers = {{2, 2, 3}};
        scene.points[0].radii = {0.5f};
        scene.nodes.resize(2);
        scene.nodes[0].parent_from_node = Transform::translate({10, 0, 0});
        scene.nodes[0].children = {1};
        scene.nodes[1].parent_from_node = Transform::scale({2, 1, 1});
        scene.nodes[1].shapes.push_back({c.geometry, -1, ""});
        scene.roots = {0};
        const Bounds b = world_bounds(scene);
        SCOPED_TRACE(c.geometry.index());
        ASSERT_FALSE(b.empty);
        expect_near(b.min, c.min, 1e-6);
        expect_near(b.max, c.max, 1e-6);
    }
}

}  // namespace
}  // namespace fathom
