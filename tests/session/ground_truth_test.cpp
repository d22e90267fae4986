// SPDX-License-Identifier: Apache-2.0
#include "fathom/ground_truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fathom/editable_scene.h"
#include "fathom/error.h"

namespace fathom {
namespace {

constexpr int width = 64, height = 48;

/// Adds a node at the root, and returns its index.
int add_node(SceneDescription& d, Node node)
{
    d.roots.push_back(int(d.nodes.size()));
    d.nodes.push_back(std::move(node));
    return d.roots.back();
}

int add_shape(SceneDescription& d, const char* name, Vec3d place, Shape shape)
{
    Node node;
    node.name = name;
    node.parent_from_node = Transform::translate(place);
    node.shapes.push_back(std::move(shape));
    return add_node(d, std::move(node));
}

/// A camera at (0, 0, 5) that looks along -z.
SceneDescription with_camera()
{
    SceneDescription d;
    Node node;
    node.camera = 0;
    add_node(d, node);
    Camera camera;
    camera.position = {0, 0, 5};
    d.cameras.push_back(camera);
    d.environment.kind = EnvironmentKind::gradient;
    return d;
}

SceneDescription ball(double radius = 1)
{
    SceneDescription d = with_camera();
    add_shape(d, "ball", {}, {Sphere{{}, radius, {}}, -1, ""});
    return d;
}

RenderSettings truth_settings()
{
    RenderSettings s;
    s.width = width, s.height = height;
    return s;
}

Scene compiled_scene(const SceneDescription& d)
{
    Warnings warnings;
    return Scene::compile(d, "", warnings);
}

GroundTruth truth_of(const SceneDescription& d)
{
    return trace_ground_truth(RenderJob(compiled_scene(d), truth_settings()), scene_objects(d));
}

/// Unit direction through the center of a pixel of the camera of with_camera().
Vec3d ray(int x, int y)
{
    const double half = std::tan(Camera().fov_y / 2);
    return normalize(
        Vec3d{((x + 0.5) / width * 2 - 1) * half * width / height, (1 - (y + 0.5) / height * 2) * half, -1});
}

/// Distance from (0, 0, 5) to the unit sphere, or infinity.
double distance_to_ball(Vec3d d)
{
    const double b = 5 * d.z, c = 24, root = b * b - c;
    return root > 0 ? -b - std::sqrt(root) : INFINITY;
}

TEST(GroundTruth, EqualsClosedFormOfBall)
{
    const GroundTruth t = truth_of(ball());
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const std::size_t i = std::size_t(y * width + x);
            const double distance = distance_to_ball(ray(x, y));
            ASSERT_EQ(std::isinf(t.distance[i]), std::isinf(distance)) << x << " " << y;
            EXPECT_EQ(t.instance[i], std::isinf(distance) ? 0u : 1u);
            if (std::isinf(distance)) {
                EXPECT_TRUE(std::isinf(t.depth[i]));
                EXPECT_EQ(t.material[i], 0u);
                continue;
            }
            const Vec3d p = Vec3d{0, 0, 5} + ray(x, y) * distance;
            EXPECT_NEAR(t.distance[i], distance, 1e-5);
            EXPECT_NEAR(t.depth[i], 5 - p.z, 1e-5);
            EXPECT_LT(length(to_double(t.position[i]) - p), 1e-5);
            EXPECT_LT(length(to_double(t.normal[i]) - p), 1e-5);
        }
}

TEST(GroundTruth, NormalOfTurnedCameraIsInItsSpace)
{
    SceneDescription d = ball();
    d.cameras[0].position = {5, 0, 0};
    d.cameras[0].look_at = {0, 0, 0};
    const GroundTruth t = truth_of(d);
    const std::size_t middle = std::size_t(height / 2 * width + width / 2);
    EXPECT_NEAR(t.normal[middle].x, 1, 0.01);
    EXPECT_NEAR(t.camera_normal[middle].z, 1, 0.01);
}

TEST(GroundTruth, IgnoresLensAndPixelFilter)
{
    SceneDescription d = ball();
    const std::vector<float> sharp = truth_of(d).depth;
    d.cameras[0].aperture = 1;
    EXPECT_EQ(truth_of(d).depth, sharp);
}

TEST(GroundTruth, PassesWhatCameraRaysPass)
{
    SceneDescription d = ball();
    const std::vector<float> without = truth_of(d).depth;
    d.materials.resize(2);
    d.materials[0].visibility.hidden_from_camera = true;
    d.materials[1].visibility.camera_backface_culling = true;
    add_shape(d, "hidden", {0, 0, 2}, {Sphere{{}, 0.5, {}}, 0, ""});
    add_shape(d, "back", {0, 0, 3}, {Rectangle{{-1, -1, 0}, {0, 2, 0}, {2, 0, 0}}, 1, ""});
    const std::vector<float> with = truth_of(d).depth;
    for (std::size_t i = 0; i < with.size(); ++i)
        if (with[i] != without[i]) EXPECT_NEAR(with[i], without[i], 1e-5);
    // Seen from its front, the rectangle hides the ball.
    std::swap(std::get<Rectangle>(d.nodes.back().shapes[0].geometry).edge_u,
              std::get<Rectangle>(d.nodes.back().shapes[0].geometry).edge_v);
    EXPECT_NEAR(truth_of(d).depth[std::size_t(height / 2 * width + width / 2)], 2, 1e-5);
}

TEST(GroundTruth, OpacityOfOneHalfIsHit)
{
    for (const float opacity : {0.49f, 0.5f}) {
        SceneDescription d = with_camera();
        d.materials.resize(1);
        d.materials[0].opacity.mode = AlphaMode::blend;
        d.materials[0].opacity.alpha.value = opacity;
        d.meshes.resize(1);
        d.meshes[0].positions = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
        d.meshes[0].indices = {0, 1, 2, 0, 2, 3};
        add_shape(d, "pane", {}, {MeshInstance{0}, 0, ""});
        add_shape(d, "wall", {0, 0, -2}, {MeshInstance{0}, -1, ""});
        const GroundTruth t = truth_of(d);
        const std::uint32_t hit = opacity < 0.5f ? 2 : 1;
        EXPECT_EQ(std::count(t.instance.begin(), t.instance.end(), hit), width * height) << opacity;
    }
}

TEST(GroundTruth, ShapesOfNodeAreOneInstance)
{
    SceneDescription d = with_camera();
    d.materials.resize(2);
    const int node = add_shape(d, "pair", {}, {Sphere{{-1, 0, 0}, 0.5, {}}, 0, ""});
    d.nodes[std::size_t(node)].shapes.push_back({Sphere{{1, 0, 0}, 0.5, {}}, 1, ""});
    add_shape(d, "", {0, 1, 0}, {Sphere{{}, 0.3, {}}, 1, ""});
    const std::vector<SceneObject> objects = scene_objects(d);
    ASSERT_EQ(objects.size(), 2u);
    EXPECT_EQ(objects[0].name, "pair");
    EXPECT_EQ(objects[1].name, "object 2");
    const GroundTruth t = truth_of(d);
    const std::size_t row = std::size_t(height / 2 * width);
    const auto first = t.instance.begin() + std::ptrdiff_t(row);
    EXPECT_EQ(std::count(first, first + width, 1u), std::count_if(first, first + width, [](auto i) { return i > 0; }));
    EXPECT_EQ(std::count(t.instance.begin(), t.instance.end(), 2u) > 0, true);
    const auto materials = t.material.begin() + std::ptrdiff_t(row);
    EXPECT_GT(std::count(materials, materials + width, 1u), 0);
    EXPECT_GT(std::count(materials, materials + width, 2u), 0);
}

TEST(GroundTruth, WholeMaskIsThatOfObjectAlone)
{
    // Small scenes are a flat list, and larger ones have a BVH.
    for (const int others : {0, 200}) {
        SceneDescription d = with_camera();
        add_shape(d, "far", {0.3, 0, -2}, {Sphere{{}, 1, {}}, -1, ""});
        SceneDescription alone = d;
        add_shape(d, "near", {}, {Sphere{{}, 0.5, {}}, -1, ""});
        for (int i = 0; i < others; ++i)
            add_shape(d, "other", {-3.0 + 0.03 * i, -0.7, 1}, {Sphere{{}, 0.01, {}}, -1, ""});
        const std::vector<ObjectMask> both =
            trace_masks(RenderJob(compiled_scene(d), truth_settings()), scene_objects(d));
        const std::vector<ObjectMask> one =
            trace_masks(RenderJob(compiled_scene(alone), truth_settings()), scene_objects(alone));
        ASSERT_EQ(one.size(), 1u);
        EXPECT_EQ(one[0].visible, one[0].whole);
        EXPECT_EQ(both[0].whole, one[0].whole) << others;
        EXPECT_LT(both[0].visible.size() + 50, both[0].whole.size());
        const GroundTruth t = truth_of(d);
        for (const ObjectMask& mask : both)
            EXPECT_EQ(std::ptrdiff_t(mask.visible.size()),
                      std::count(t.instance.begin(), t.instance.end(), mask.instance));
    }
}

/// Largest difference of the flow from that of a translation of what is hit.
double flow_error(const GroundTruth& t, const std::vector<Vec2f>& flow, Vec3d way)
{
    const double focal = height / 2 / std::tan(Camera().fov_y / 2);
    double largest = 0;
    for (std::size_t i = 0; i < flow.size(); ++i) {
        if (t.instance[i] == 0) {
            EXPECT_TRUE(std::isnan(flow[i].x));
            continue;
        }
        // A comparison with NaN would pass.
        if (std::isnan(flow[i].x)) return INFINITY;
        const Vec3d p = to_double(t.position[i]), q = p + way;
        const double dx = focal * (q.x / (5 - q.z) - p.x / (5 - p.z)),
                     dy = -focal * (q.y / (5 - q.z) - p.y / (5 - p.z));
        largest = std::max({largest, std::abs(flow[i].x - dx), std::abs(flow[i].y - dy)});
    }
    return largest;
}

TEST(OpticalFlow, FollowsMovedNode)
{
    const Vec3d way{0.3, -0.2, 0.4};
    const auto square = [] {
        Mesh mesh;
        mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
        mesh.indices = {0, 1, 2};
        return mesh;
    };
    for (const bool is_mesh : {false, true}) {
        SceneDescription d = with_camera();
        d.meshes.push_back(square());
        const int node = add_shape(d, "it", {}, {Sphere{{}, 1, {}}, -1, ""});
        if (is_mesh) d.nodes[std::size_t(node)].shapes[0].geometry = MeshInstance{0};
        d.nodes[std::size_t(node)].movable = true;
        Warnings warnings;
        EditableScene edit(d);
        const RenderJob before(edit.compile_bit_exact(warnings), truth_settings());
        edit.set_transform(node, Transform::translate(way));
        const RenderJob after(edit.compile_bit_exact(warnings), truth_settings());
        const GroundTruth t = trace_ground_truth(before, scene_objects(d));
        EXPECT_LT(flow_error(t, optical_flow(t, before, after), way), 1e-3) << is_mesh;
        const GroundTruth back = trace_ground_truth(after, scene_objects(d));
        EXPECT_LT(flow_error(back, optical_flow(back, after, before), -way), 1e-3) << is_mesh;
        EXPECT_LT(flow_error(t, optical_flow(t, before, before), {}), 1e-3) << is_mesh;
    }
}

TEST(OpticalFlow, FollowsCamera)
{
    const SceneDescription d = ball();
    const Scene scene = compiled_scene(d);
    Camera moved = scene.camera();
    moved.position.x -= 0.5, moved.look_at.x -= 0.5;
    const RenderJob here(scene, truth_settings()), there(scene, moved, truth_settings());
    const GroundTruth t = trace_ground_truth(here, scene_objects(d));
    EXPECT_LT(flow_error(t, optical_flow(t, here, there), {0.5, 0, 0}), 1e-3);
}

TEST(OpticalFlow, GoesTheShorterWayAroundSphericalImages)
{
    SceneDescription d = ball();
    d.cameras[0].kind = CameraKind::spherical;
    d.cameras[0].look_at = {0, 0, 10};  // the ball is behind the camera: on both sides of the seam
    const Scene scene = compiled_scene(d);
    Camera moved = scene.camera();
    moved.position.x += 0.2, moved.look_at.x += 0.2;
    const RenderJob here(scene, truth_settings()), there(scene, moved, truth_settings());
    const GroundTruth t = trace_ground_truth(here, scene_objects(d));
    int hits = 0;
    for (const Vec2f& v : optical_flow(t, here, there))
        if (!std::isnan(v.x)) {
            ++hits;
            EXPECT_LT(std::abs(v.x), 2);
        }
    EXPECT_GT(hits, 10);
    EXPECT_EQ(t.depth, t.distance);
}

TEST(OpticalFlow, NeedsTheSameShapes)
{
    SceneDescription d = ball(), more = d;
    add_shape(more, "more", {}, {Sphere{{}, 1, {}}, -1, ""});
    const RenderJob here(compiled_scene(d), truth_settings()), there(compiled_scene(more), truth_settings());
    const GroundTruth t = trace_ground_truth(here, scene_objects(d));
    EXPECT_THROW(optical_flow(t, here, there), Error);
}

TEST(SceneObjects, SplitTransforms)
{
    SceneDescription d = with_camera();
    const int node = add_shape(d, "it", {}, {Sphere{{}, 1, {}}, -1, ""});
    const Transform turn = Transform::rotate({1, 2, 3}, 0.8), place = Transform::translate({1, 2, 3});
    const Transform whole = place * turn * Transform::scale({2, 0.5, -1});
    d.nodes[std::size_t(node)].parent_from_node = whole;
    const SceneObject object = scene_objects(d)[0];
    EXPECT_NEAR(object.pose.determinant(), 1, 1e-9);
    const Transform joined = object.pose * object.stretch;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(joined.m[r][c], whole.m[r][c], 1e-9);
}

TEST(PinholeCamera, ProjectsLikeRays)
{
    SceneDescription d = ball();
    d.cameras[0].shift_x = 0.1, d.cameras[0].shift_y = -0.05;
    const RenderJob job(compiled_scene(d), truth_settings());
    const PinholeCamera c = pinhole_camera(job);
    const GroundTruth t = trace_ground_truth(job, scene_objects(d));
    for (std::size_t i = 0; i < t.position.size(); ++i) {
        if (t.instance[i] == 0) continue;
        const Vec3d p = c.world_from_camera.inverse().point(to_double(t.position[i]));
        EXPECT_NEAR(c.cx - c.fx * p.x / p.z, int(i) % width + 0.5, 1e-3);
        EXPECT_NEAR(c.cy + c.fy * p.y / p.z, int(i) / width + 0.5, 1e-3);
    }
    d.cameras[0].kind = CameraKind::orthographic;
    EXPECT_THROW(pinhole_camera(RenderJob(compiled_scene(d), truth_settings())), Error);
}

}  // namespace
}  // namespace fathom
