// SPDX-License-Identifier: Apache-2.0
#include "formats/import_test_helpers.h"

namespace fathom::test {
namespace {

class CompleteScene : public ImportTest {};

/// Position in the image; -1 to 1 is inside.
std::pair<double, double> in_picture(const Camera& camera, double aspect, Vec3d p)
{
    const Vec3d forward = normalize(camera.look_at - camera.position);
    const Vec3d right = normalize(cross(forward, camera.up)), up = cross(right, forward);
    const Vec3d d = p - camera.position;
    const double tan_y = std::tan(camera.fov_y / 2);
    return {dot(d, right) / dot(d, forward) / tan_y / aspect, dot(d, up) / dot(d, forward) / tan_y};
}

TEST_F(CompleteScene, BoundsOfRoundThingsAreExact)
{
    const auto bounds_of = [&](const std::string& node) {
        return world_bounds(load("a.json", R"({"scene": [{)" + node + "}]}"));
    };
    const Bounds sphere = bounds_of(R"("sphere": {"center": [1, 0, 0], "radius": -2}, "transform":
        {"rotate": {"axis": [1, 2, 3], "angle_deg": 50}, "translate": [0, 5, 0]})");
    const Vec3d middle = (sphere.min + sphere.max) * 0.5;
    expect_near(sphere.max - middle, {2, 2, 2});
    EXPECT_NEAR(length(middle - Vec3d{0, 5, 0}), 1, 1e-12);
    const Bounds disk = bounds_of(R"("disk": {"normal": [0, 3, 0], "radius": 4}, "transform": {"scale": [2, 1, 1]})");
    expect_near(disk.min, {-8, 0, -4});
    expect_near(disk.max, {8, 0, 4});
}

TEST_F(CompleteScene, FramesFromEveryDirection)
{
    for (double azimuth : {0., 30., 90., 200., -45.})
        for (double elevation : {-90., -20., 0., 20., 89., 90.}) {
            SceneDescription scene =
                load("s.json",
                     R"({"scene": [{"box": {"min": [-1, 5, 2], "max": [7, 6, 3]}, "transform": {"scale": 1000}}]})");
            FramingOptions options;
            options.azimuth_deg = azimuth;
            options.elevation_deg = elevation;
            options.aspect = 16.0 / 9;
            EXPECT_TRUE(add_default_camera(scene, options));
            ASSERT_EQ(scene.cameras.size(), 1u);
            double widest = 0;
            for (int i = 0; i < 8; ++i) {
                const Vec3d corner{i & 1 ? 7000. : -1000., i & 2 ? 6000. : 5000., i & 4 ? 3000. : 2000.};
                const auto [x, y] = in_picture(scene.cameras[0], options.aspect, corner);
                widest = std::max({widest, std::abs(x), std::abs(y)});
            }
            EXPECT_LT(widest, 1);
            EXPECT_GT(widest, 0.7) << azimuth << ' ' << elevation;
        }
}

/// The silhouette touches the margin on two opposite sides, so no camera in that direction is closer. This holds for
/// shapes that do not fill their bounding box, and under motion and rotation.
TEST_F(CompleteScene, TheSilhouetteFillsThePicture)
{
    int at_tip = 0;
    for (double azimuth : {0., 30., 137., 250.})
        for (double elevation : {-90., -25., 0., 20., 90.})
            for (double aspect : {0.5, 4.0 / 3, 3.0}) {
                SceneDescription scene;
                Mesh mesh;
                // A cone fills its bounding box badly.
                mesh.positions.push_back({0, 4, 0});
                for (int i = 0; i < 64; ++i)
                    mesh.positions.push_back({std::cos(float(i) * 0.1f), 0, std::sin(float(i) * 0.1f)});
                for (std::uint32_t i = 1; i < 64; ++i) mesh.indices.insert(mesh.indices.end(), {0, i, i + 1});
                scene.meshes.push_back(mesh);
                Node node;
                node.parent_from_node = Transform::translate({20, -3, 5}) * Transform::rotate({1, 2, 0.5}, 0.7) *
                                        Transform::scale({1, 2, 1});
                node.shapes.push_back({MeshInstance{0}, -1, ""});
                node.shapes.push_back({Sphere{{0, 1, 0}, 1.2, {}}, -1, ""});
                scene.nodes.push_back(node);
                scene.roots.push_back(0);
                FramingOptions options;
                options.azimuth_deg = azimuth, options.elevation_deg = elevation, options.aspect = aspect;
                add_default_camera(scene, options);
                double left = 1, right = -1, below = 1, above = -1, nearest = 1e9, farthest = 0;
                const auto add = [&](Vec3d p) {
                    const auto [x, y] = in_picture(scene.cameras[0], aspect, node.parent_from_node.point(p));
                    left = std::min(left, x), right = std::max(right, x);
                    below = std::min(below, y), above = std::max(above, y);
                    const Camera& c = scene.cameras[0];
                    const double z =
                        dot(node.parent_from_node.point(p) - c.position, normalize(c.look_at - c.position));
                    nearest = std::min(nearest, z), farthest = std::max(farthest, z);
                };
                for (const Vec3f p : mesh.positions) add({p.x, p.y, p.z});
                for (int i = 0; i < 400; ++i)
                    for (int j = 0; j <= 200; ++j) {
                        const double phi = i * 0.005 * std::numbers::pi, theta = j * 0.005 * std::numbers::pi;
                        add(Vec3d{0, 1, 0} + 1.2 * Vec3d{std::sin(theta) * std::cos(phi), std::cos(theta),
                                                         std::sin(theta) * std::sin(phi)});
                    }
                const std::string place = std::to_string(azimuth) + " " + std::to_string(elevation);
                const double edge = 1 / 1.08;
                EXPECT_LE(std::max({right, -left, above, -below}), edge + 1e-9) << place;
                const bool by_width = std::min(right, -left) > std::min(above, -below);
                // In front of a long cone's tip the distance is at least a tenth of the cone's depth.
                const bool is_at_tip = std::abs(nearest - 0.1 * (farthest - nearest)) < 1e-3;
                at_tip += int(is_at_tip);
                if (is_at_tip) continue;
                EXPECT_NEAR(by_width ? right : above, edge, 1e-3) << place;
                EXPECT_NEAR(by_width ? -left : -below, edge, 1e-3) << place;
            }
    EXPECT_LE(at_tip, 6);
}

/// A turntable camera sees the whole scene from every azimuth at the smallest such distance: at one azimuth something
/// touches the margin. The axis is in the image's center.
TEST_F(CompleteScene, TurnsAboutTheSceneWithAllInView)
{
    for (double elevation : {-30., 0., 20., 90.})
        for (double aspect : {0.5, 4.0 / 3, 3.0}) {
            SceneDescription scene = load("s.json", R"({"scene": [{"box": {"min": [-1, 5, 2], "max": [7, 6, 3]}},
                                             {"box": {"min": [0, 5, 2], "max": [1, 9, 3]}}]})");
            FramingOptions options;
            options.azimuth_deg = 77, options.elevation_deg = elevation, options.aspect = aspect;
            options.orbit_center = Vec3d{2.7, 7, 2.3};
            add_default_camera(scene, options);
            const Camera first = scene.cameras[0];
            double widest = 0;
            for (int turn = 0; turn < 360; ++turn) {
                const Transform turned = Transform::translate(*options.orbit_center) *
                                         Transform::rotate({0, 1, 0}, turn * std::numbers::pi / 180) *
                                         Transform::translate(-*options.orbit_center);
                Camera camera = first;
                camera.position = turned.point(first.position), camera.look_at = turned.point(first.look_at);
                camera.up = turned.vector(first.up);
                EXPECT_NEAR(in_picture(camera, aspect, *options.orbit_center).first, 0, 1e-12);
                for (int i = 0; i < 16; ++i) {
                    const bool low = i < 8;
                    const auto [x, y] = in_picture(
                        camera, aspect,
                        {i & 1 ? (low ? 7. : 1.) : (low ? -1. : 0.), i & 2 ? (low ? 6. : 9.) : 5., i & 4 ? 3. : 2.});
                    widest = std::max({widest, std::abs(x), std::abs(y)});
                }
            }
            EXPECT_NEAR(widest, 1 / 1.08, 0.006) << elevation << ' ' << aspect;
        }
}

/// Geometry without extent across the view keeps the camera at a distance.
TEST_F(CompleteScene, ViewsThinScenesFromTheFront)
{
    SceneDescription scene;
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 0, -5}, {0, 0, 2}};
    mesh.indices = {0, 1, 2};
    scene.meshes.push_back(mesh);
    Node node;
    node.shapes.push_back({MeshInstance{0}, -1, ""});
    scene.nodes.push_back(node);
    scene.roots.push_back(0);
    FramingOptions options;
    options.azimuth_deg = options.elevation_deg = 0;
    add_default_camera(scene, options);
    EXPECT_NEAR(scene.cameras[0].position.z, 2.7, 1e-9);
    EXPECT_NEAR(scene.cameras[0].look_at.z, -1.5, 1e-9);
}

TEST_F(CompleteScene, AddsOnlyWhatIsMissing)
{
    SceneDescription none = load("a.json", R"({"scene": [{"sphere": {}}]})");
    EXPECT_TRUE(add_default_camera(none, {}));
    EXPECT_EQ(none.cameras.size(), 1u);
    SceneDescription one = load("b.json", R"({"camera": {}, "scene": [{"sphere": {}}]})");
    EXPECT_FALSE(add_default_camera(one, {}));
    EXPECT_EQ(one.cameras.size(), 1u);
}

TEST_F(CompleteScene, ForcedCameraComesFirst)
{
    SceneDescription scene = load("a.json", R"({"cameras": {"one": {}, "two": {}}, "scene": [{"sphere": {}}]})");
    FramingOptions options;
    options.force_camera = true;
    EXPECT_TRUE(add_default_camera(scene, options));
    ASSERT_EQ(scene.cameras.size(), 3u);
    EXPECT_EQ(scene.cameras[1].name, "one");
    for (const Node& node : scene.nodes) {
        if (node.name == "two") {
            EXPECT_EQ(scene.cameras[node.camera].name, "two");
        }
    }
    EXPECT_EQ(scene.nodes[scene.roots.back()].camera, 0);
}

TEST_F(CompleteScene, EmptySceneGetsACamera)
{
    SceneDescription empty = load("a.json", "{}");
    add_default_camera(empty, {});
    ASSERT_EQ(empty.cameras.size(), 1u);
    EXPECT_GT(length(empty.cameras[0].position - empty.cameras[0].look_at), 0);
}

std::string check_error(const SceneDescription& scene)
{
    SceneDescription copy = scene;
    try {
        add_default_camera(copy, {});
    } catch (const Error& e) {
        return e.what();
    }
    return "good";
}

TEST_F(CompleteScene, RefusesScenesThatCantBe)
{
    SceneDescription scene = load("a.json", R"({"scene": [{"sphere": {}}, {"sphere": {}}]})");
    scene.file = "s";
    EXPECT_EQ(check_error(scene), "good");
    SceneDescription bad = scene;
    bad.nodes[0].children = {1};
    bad.nodes[1].children = {0};
    EXPECT_EQ(check_error(bad), "s: nodes[1].children[0]: a node can't contain itself");
    bad = scene;
    bad.nodes[0].children = {7};
    EXPECT_EQ(check_error(bad), "s: nodes[0].children[0]: there is no node 7, only 2");
    bad = scene;
    bad.nodes[0].shapes[0].material = 0;
    EXPECT_EQ(check_error(bad), "s: nodes[0].shapes[0].material: there is no material 0, only 0");
    bad = scene;
    bad.nodes[1].parent_from_node.m[0][0] = NAN;
    EXPECT_EQ(check_error(bad), "s: nodes[1].parent_from_node: the transform is not finite");
    bad = scene;
    bad.meshes.resize(1);
    bad.meshes[0].positions = {{0, 0, 0}, {1, 0, 0}, {0, NAN, 0}};
    EXPECT_EQ(check_error(bad), "s: meshes[0].positions[2]: is not finite");
    bad.meshes[0].positions[2] = {0, 1, 0};
    bad.meshes[0].indices = {0, 1, 3};
    EXPECT_EQ(check_error(bad), "s: meshes[0].indices[2]: there is no vertex 3, only 3");

    bad = scene;
    bad.curves.push_back({"", CurveBasis::linear, false, {{0, 0, 0}, {1, 0, 0}}, {1, 1}, {2}, {}});
    bad.curves[0].motion = {{0, {{0, 0, 0}, {1, 0, 0}}, {1, 1}}};
    EXPECT_EQ(check_error(bad), "s: curves[0].motion: has one key; motion needs at least two");
    bad.curves[0].motion.push_back(bad.curves[0].motion[0]);
    EXPECT_EQ(check_error(bad), "s: curves[0].motion[1].time: times must be finite and increase");
    bad.curves[0].motion[1].time = 1;
    EXPECT_EQ(check_error(bad), "good");
    bad.curves[0].motion[1].radii[1] = -1;
    EXPECT_EQ(check_error(bad), "s: curves[0].motion[1].radii[1]: must be finite and not negative");
    bad.curves[0].motion[1].radii = {1};
    EXPECT_EQ(check_error(bad), "s: curves[0].motion[1]: has 1 radii for 2 points");
    bad.curves[0].motion[1].points = {{0, 0, 0}};
    EXPECT_EQ(check_error(bad), "s: curves[0].motion[1]: has 1 points, but the curves have 2");

    // The scene has 2^40 spheres in 41 nodes, and as many nodes without shapes.
    bad = scene;
    bad.nodes.resize(42);
    for (int i = 2; i < 42; ++i) bad.nodes[i].children = {i - 1, i - 1};
    bad.roots = {41};
    EXPECT_NE(check_error(bad).find("instances expand to more than 100 million"), std::string::npos);
    for (Node& node : bad.nodes) node.shapes.clear();
    EXPECT_NE(check_error(bad).find("instances expand to more than 100 million"), std::string::npos);
}

}  // namespace
}  // namespace fathom::test
