// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "formats/import_test_helpers.h"
#include "scene/motion.h"

namespace fathom::test {
namespace {

class FathomJsonMotion : public ImportTest {
protected:
    std::string error_in_node(const std::string& node) { return error_of("scene.json", "{\"scene\": [" + node + "]}"); }
};

TEST_F(FathomJsonMotion, Nodes)
{
    const SceneDescription scene = load("scene.json", R"({"scene": [{"sphere": {}, "motion": [
        {"time": 0.5}, {"time": 1, "transform": {"translate": [1, 2, 3]}}]}]})");
    const Node& node = scene.nodes[std::size_t(scene.roots[0])];
    ASSERT_EQ(node.motion.size(), 2u);
    EXPECT_EQ(node.motion[0].time, 0.5);
    expect_near(transform_at(node, 0).point({0, 0, 0}), {0, 0, 0});
    expect_near(transform_at(node, 0.75).point({0, 0, 0}), {0.5, 1, 1.5});
    expect_near(transform_at(node, 7).point({0, 0, 0}), {1, 2, 3});
    EXPECT_TRUE(moves(node, 0, 1));
    EXPECT_FALSE(moves(node, 0, 0.5));
    EXPECT_FALSE(moves(node, 1, 2));
    EXPECT_FALSE(moves(node, 0.75, 0.75));
}

TEST_F(FathomJsonMotion, Meshes)
{
    const SceneDescription scene = load("scene.json", R"({"scene": [{"mesh": {
        "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "normals": [[0, 0, 1], [0, 0, 1], [0, 0, 1]],
        "motion": [{"time": 0}, {"time": 2, "positions": [[0, 0, 1], [1, 0, 1], [0, 1, 2]],
                                 "normals": [[0, 1, 0], [0, 1, 0], [0, 1, 0]]}]}}]})");
    const MeshKey key = vertices_at(scene.meshes[0], 0.5);
    EXPECT_EQ(key.positions[2].z, 0.5f);
    EXPECT_EQ(key.normals[2].y, 0.25f);
    EXPECT_EQ(key.normals[2].z, 0.75f);
}

TEST_F(FathomJsonMotion, Errors)
{
    EXPECT_EQ(error_in_node(R"({"motion": [{"time": 0}]})"), "/scene/0/motion: expected at least 2 elements, found 1");
    EXPECT_EQ(error_in_node(R"({"motion": [{"time": 0}, {}]})"), "/scene/0/motion/1: key 'time' is missing");
    EXPECT_EQ(error_in_node(R"({"motion": [{"time": 1}, {"time": 1}]})"),
              "/scene/0/motion/1/time: times must increase");
    EXPECT_EQ(
        error_in_node(R"({"transform": {}, "motion": [{"time": 0}, {"time": 1}]})"),
        "/scene/0/motion: a moving node can't have a 'transform' beside its 'motion'; give the transforms in its keys");
    EXPECT_EQ(error_in_node(R"({"motion": [{"time": 0}, {"time": 1, "transform": {"scale": [1, -1, 1]}}]})"),
              "/scene/0/motion/1: only one of this key and the first key mirrors: in between, the node would be flat");
    EXPECT_EQ(error_in_node(R"({"mesh": {"positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "motion": [{"time": 0},
                                {"time": 1, "positions": [[0, 0, 0]]}]}})"),
              "/scene/0/mesh/motion/1/positions: expected 3 elements, one for each of 'positions', found 1");
    EXPECT_EQ(error_in_node(R"({"mesh": {"positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
                                "normals": [[0, 0, 1], [0, 0, 1], [0, 0, 1]], "motion": [{"time": 0},
                                {"time": 1, "positions": [[0, 0, 0], [1, 0, 0], [0, 2, 0]]}]}})"),
              "/scene/0/mesh/motion/1: needs 'normals', since the mesh has them");
}

/// Decomposing and recomposing a transform restores it, also if it mirrors or shears.
TEST(Pose, OfTransforms)
{
    for (int i = 0; i < 1000; ++i) {
        int k = 0;
        const auto number = [&] {
            ++k;
            return std::sin(12.9 * i + 78.2 * k + 0.3 * i * k);
        };
        Transform t = Transform::rotate({number(), number(), number()}, 4 * number());
        for (auto& row : t.m)
            for (double& x : row) x += 0.6 * number();
        if (std::abs(t.determinant()) < 1e-3) continue;
        const Pose pose = pose_of(t);
        const Transform again = pose.transform();
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(again.m[r][c], t.m[r][c], 1e-10);
    }
}

TEST(Pose, RotatesUniformlyAlongTheShorterArc)
{
    const Pose a = pose_of(Transform::rotate({0, 0, 1}, 3)), b = pose_of(Transform::rotate({0, 0, 1}, -3));
    for (double f : {0.0, 0.25, 0.5, 1.0}) {
        // The rotation goes the short way, from 3 through pi to 2 pi - 3.
        const double angle = 3 + f * (2 * std::numbers::pi - 6);
        expect_near(interpolate(a, b, f).transform().point({1, 0, 0}), {std::cos(angle), std::sin(angle), 0});
    }
}

class FathomJsonCurves : public FathomJsonMotion {};

TEST_F(FathomJsonCurves, CurvesAndPoints)
{
    const SceneDescription scene = load("scene.json", R"({"scene": [
        {"curves": {"basis": "linear", "style": "ribbon", "radius": 0.5, "curves": [[[0, 0, 0], [1, 0, 0, 2]], [[0, 1, 0], [0, 2, 0], [0, 3, 0]]]}},
        {"points": {"points": [[1, 2, 3], [4, 5, 6, 0.25]]}}, {"points": {"points": []}}, {"curves": {"curves": []}}]})");
    ASSERT_EQ(scene.curves.size(), 2u);
    EXPECT_EQ(scene.curves[0].counts, (std::vector<std::uint32_t>{2, 3}));
    EXPECT_EQ(scene.curves[0].radii, (std::vector<float>{0.5f, 2, 0.5f, 0.5f, 0.5f}));
    EXPECT_TRUE(scene.curves[0].ribbons);
    EXPECT_EQ(scene.points[0].radii, (std::vector<float>{0.01f, 0.25f}));
    const Bounds bounds = world_bounds(scene);
    EXPECT_EQ(bounds.min.x, -1);
    EXPECT_EQ(bounds.max.z, 6.25);
}

TEST_F(FathomJsonCurves, PointsMove)
{
    const SceneDescription scene = load("scene.json", R"({"scene": [
        {"curves": {"basis": "linear", "radius": 0.5, "curves": [[[0, 0, 0], [1, 0, 0, 2]], [[0, 1, 0], [0, 2, 0]]],
         "motion": [{"time": 0}, {"time": 2, "curves": [[[0, 0, 4], [1, 0, 0]], [[0, 1, 0, 1.5], [0, 2, 8]]]}]}}]})");
    const CurvesKey key = points_at(scene.curves[0], 1);
    EXPECT_EQ(key.points[0].z, 2);
    EXPECT_EQ(key.points[3].z, 4);
    // Keys without radii keep the radii of the curve.
    EXPECT_EQ(key.radii, (std::vector<float>{0.5f, 2, 1, 0.5f}));
}

TEST_F(FathomJsonCurves, ErrorsOfMotion)
{
    const auto error_in_key = [&](const std::string& key) {
        return error_in_node(
            R"({"curves": {"basis": "linear", "curves": [[[0, 0, 0], [1, 0, 0]]], "motion": [{"time": 0}, )" + key +
            "]}}");
    };
    EXPECT_EQ(error_in_key(R"({"time": 0})"), "/scene/0/curves/motion/1/time: times must increase");
    EXPECT_EQ(error_in_key(R"({"time": 1, "curves": []})"),
              "/scene/0/curves/motion/1/curves: has 0 curves, but there are 1");
    EXPECT_EQ(error_in_key(R"({"time": 1, "curves": [[[0, 0, 0], [1, 0, 0], [2, 0, 0]]]})"),
              "/scene/0/curves/motion/1/curves/0: has 3 points, but the curve has 2");
    EXPECT_EQ(error_in_key(R"({"time": 1, "curves": [[[0, 0, 0], [1, 0, 0, -1]]]})"),
              "/scene/0/curves/motion/1/curves/0/1/3: a radius must not be negative");
}

TEST_F(FathomJsonCurves, Errors)
{
    EXPECT_EQ(error_in_node(R"({"curves": {"curves": [[[0, 0, 0], [1, 0, 0], [2, 0, 0]]]}})"),
              "/scene/0/curves/curves/0: expected at least 4 elements, found 3");
    EXPECT_EQ(
        error_in_node(
            R"({"curves": {"basis": "bezier", "curves": [[[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [4, 0, 0]]]}})"),
        "/scene/0/curves/curves/0: expected 4, 7, 10, ... points, found 5");
    EXPECT_EQ(error_in_node(R"({"curves": {"basis": "linear", "curves": [[[0, 0, 0], [1, 0, 0, -1]]]}})"),
              "/scene/0/curves/curves/0/1/3: a radius must not be negative");
    EXPECT_EQ(error_in_node(R"({"points": {"points": [[0, 0, 0, 0]]}})"),
              "/scene/0/points/points/0/3: a radius must be greater than 0");
    EXPECT_EQ(error_in_node(R"({"points": {"radius": 0, "points": []}})"),
              "/scene/0/points/radius: must be greater than 0");
    EXPECT_EQ(error_in_node(R"({"points": {"points": [[0, 0]]}})").substr(0, 25), "/scene/0/points/points/0:");
}

}  // namespace
}  // namespace fathom::test
