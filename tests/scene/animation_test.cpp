// SPDX-License-Identifier: Apache-2.0
#include "fathom/animation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "fathom/error.h"
#include "scene/animation.h"
#include "scene/motion.h"

namespace fathom {
namespace {

AnimationChannel channel(AnimatedProperty value, Interpolation interpolation, std::vector<float> times,
                         std::vector<float> values)
{
    return {value, 0, interpolation, std::move(times), std::move(values)};
}

/// Hermite splines reproduce cubic polynomials from their values and slopes.
TEST(AnimationValues, SplinesGiveBackCubicPolynomials)
{
    const auto p = [](double t) { return 2 * t * t * t - t * t + 3 * t + 1; };
    const auto slope = [](double t) { return 6 * t * t - 2 * t + 3; };
    AnimationChannel c = channel(AnimatedProperty::translation, Interpolation::cubic, {-1, 0.5f, 2}, {});
    for (const float t : c.times)
        for (const bool is_value : {false, true, false})
            for (const double factor : {1.0, -2.0, 0.5})
                c.values.push_back(float(factor * (is_value ? p(t) : slope(t))));
    ASSERT_EQ(problem_of(c), "");
    ASSERT_EQ(components(c), 3u);
    for (int i = 0; i <= 16; ++i) {
        const double t = -1 + 0.1875 * i;
        const std::vector<double> v = value_at(c, t);
        EXPECT_NEAR(v[0], p(t), 1e-5) << t;
        EXPECT_NEAR(v[1], -2 * p(t), 1e-5) << t;
        EXPECT_NEAR(v[2], 0.5 * p(t), 1e-5) << t;
    }
}

TEST(AnimationValues, StepsLinesAndEnds)
{
    for (const Interpolation interpolation : {Interpolation::step, Interpolation::linear}) {
        const AnimationChannel c = channel(AnimatedProperty::weights, interpolation, {1, 2, 4}, {10, 1, 20, 2, 60, 3});
        const auto at = [&](double t) { return value_at(c, t); };
        const bool steps = interpolation == Interpolation::step;
        using Values = std::vector<double>;
        EXPECT_EQ(at(0), (Values{10, 1}));
        EXPECT_EQ(at(1), (Values{10, 1}));
        EXPECT_EQ(at(1.75), steps ? (Values{10, 1}) : (Values{17.5, 1.75}));
        EXPECT_EQ(at(2), (Values{20, 2}));
        EXPECT_EQ(at(3), steps ? (Values{20, 2}) : (Values{40, 2.5}));
        EXPECT_EQ(at(4), (Values{60, 3}));
        EXPECT_EQ(at(1e9), (Values{60, 3}));
        EXPECT_EQ(at(-1e9), (Values{10, 1}));
    }
    // A single key applies at all times.
    EXPECT_EQ(value_at(channel(AnimatedProperty::roughness, Interpolation::linear, {3}, {0.5f}), 1),
              (std::vector<double>{0.5}));
}

/// Rotations turn by a fraction of the angle, always the short way, whatever sign a key's quaternion has.
TEST(AnimationValues, RotationsTurnSteadily)
{
    const double angle = 2.5;
    const float s = float(std::sin(angle / 2)), c = float(std::cos(angle / 2));
    for (const float sign : {1.0f, -1.0f}) {
        const AnimationChannel turning =
            channel(AnimatedProperty::rotation, Interpolation::linear, {0, 2}, {0, 0, 0, 1, 0, sign * s, 0, sign * c});
        for (int step = 0; step <= 8; ++step) {
            const double t = 0.25 * step;
            const std::vector<double> q = value_at(turning, t);
            const Transform r = Transform::rotate_quaternion(q[0], q[1], q[2], q[3]);
            const Transform expected = Transform::rotate({0, 1, 0}, angle * t / 2);
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(r.m[i][k], expected.m[i][k], 2e-7) << t;
        }
    }
    // Splines of quaternions are normalized to rotations.
    AnimationChannel spline =
        channel(AnimatedProperty::rotation, Interpolation::cubic, {0, 1}, std::vector<float>(24, 0.0f));
    spline.values[7] = 1, spline.values[17] = 1;  // slopes of a rotation from identity to half a turn about y
    const std::vector<double> q = value_at(spline, 0.5);
    EXPECT_NEAR(q[1], std::sqrt(0.5), 1e-12);
    EXPECT_NEAR(q[3], std::sqrt(0.5), 1e-12);
}

TEST(AnimationValues, WhatIsWrongWithKeys)
{
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
    const auto problem = [](std::vector<float> times, std::vector<float> values,
                            Interpolation i = Interpolation::linear,
                            AnimatedProperty value = AnimatedProperty::translation) {
        return problem_of(channel(value, i, std::move(times), std::move(values)));
    };
    EXPECT_EQ(problem({0}, {1, 2, 3}), "");
    EXPECT_EQ(problem({}, {}), "there are no keys");
    EXPECT_EQ(problem({1, 1}, {1, 2, 3, 4, 5, 6}), "times must be finite and increase: 1 is the time of key 1");
    EXPECT_EQ(problem({1, 0.5f}, {1, 2, 3, 4, 5, 6}), "times must be finite and increase: 0.5 is the time of key 1");
    EXPECT_NE(problem({nan}, {1, 2, 3}), "");
    EXPECT_NE(problem({0, infinite}, {1, 2, 3, 4, 5, 6}), "");
    EXPECT_EQ(problem({0}, {1, nan, 3}), "a value is not finite");
    EXPECT_EQ(problem({0}, {1, 2}), "2 numbers are not 3 for each of 1 keys");
    EXPECT_EQ(problem({0}, {1, 2, 3}, Interpolation::cubic), "3 numbers are not 9 for each of 1 keys");
    EXPECT_EQ(problem({0, 1}, {1, 2, 3}, Interpolation::step, AnimatedProperty::weights),
              "3 numbers are not as many for each of 2 keys");
}

/// A model of a strip of two triangles with two joints of a chain, and a morph target.
class Player : public ::testing::Test {
protected:
    SceneDescription scene;
    AnimationRig rig;

    void SetUp() override
    {
        scene.file = "strip";
        scene.nodes.resize(4);
        scene.nodes[0].children = {1};
        scene.nodes[1].children = {2};
        scene.nodes[1].parent_from_node = Transform::translate({1, 0, 0});
        scene.nodes[3].shapes.push_back({MeshInstance{0}, -1, ""});
        scene.roots = {0, 3};
        Mesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 0, 0}};
        mesh.normals.assign(4, {0, 0, 1});
        mesh.indices = {0, 1, 2, 1, 3, 2};
        scene.meshes = {mesh};
        rig.nodes.resize(4);
        rig.nodes[1].translation = {1, 0, 0};
        rig.parents = {-1, 0, 1, -1};
        rig.skins.push_back({{0, 2}, {Transform(), Transform::translate({-1, 0, 0})}});
        DeformedMesh d;
        d.mesh = 0;
        d.rest = mesh;
        d.targets.resize(1);
        d.targets[0].positions = {{0, 0, 0}, {0, 0, 0}, {0, 2, 0}, {0, 0, 0}};
        d.node = 3;
        d.skin = 0;
        d.joints = {0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0};
        d.joint_weights = {1, 0, 0, 0, 1, 1, 0, 0, 0.75f, 0.25f, 0, 0, 1, 0, 0, 0};
        rig.meshes = {d};
        Animation& animation = rig.animations.emplace_back();
        animation.name = "bend";
        const float h = float(std::sqrt(0.5));
        animation.channels.push_back(
            channel(AnimatedProperty::rotation, Interpolation::linear, {0, 1}, {0, 0, 0, 1, 0, 0, h, h}));
        animation.channels.back().target = 1;
        animation.channels.push_back(channel(AnimatedProperty::weights, Interpolation::linear, {0, 2}, {0, 1}));
        animation.channels.back().target = 3;
    }
    std::string error()
    {
        try {
            AnimationPlayer(scene, rig, 0);
        } catch (const Error& e) {
            return e.place() + ": " + e.message();
        }
        return "plays";
    }
};

/// Skinned points agree with explicit sums of their joints' transforms.
TEST_F(Player, SkinsBendAndTargetsMorph)
{
    EXPECT_EQ(rig.animations[0].duration(), 2);
    const AnimationPlayer player(scene, rig, 0);
    EXPECT_TRUE(scene.meshes[0].movable);
    EXPECT_TRUE(scene.nodes[1].movable);
    EXPECT_FALSE(scene.nodes[0].movable);
    for (const double t : {0.0, 0.25, 1.0, 1.5, 5.0}) {
        set_pose(scene, player.pose(t));
        const double angle = std::min(t, 1.0) * std::numbers::pi / 2, weight = std::min(t / 2, 1.0);
        // The second joint, node 2, rotates with node 1 about (1, 0, 0).
        const auto turned = [&](Vec3d p) {
            const double x = p.x - 1;
            return Vec3d{1 + x * std::cos(angle) - p.y * std::sin(angle), x * std::sin(angle) + p.y * std::cos(angle),
                         p.z};
        };
        const double share[] = {0, 0.5, 0.25, 1};
        const Vec3d rest[] = {{0, 0, 0}, {1, 0, 0}, {1, 1 + 2 * weight, 0}, {2, 0, 0}};
        for (std::size_t i = 0; i < 4; ++i) {
            const Vec3d expected = rest[i] * (1 - share[i]) + turned(rest[i]) * share[i];
            const Vec3f p = scene.meshes[0].positions[i];
            EXPECT_NEAR(p.x, expected.x, 1e-6) << t << ' ' << i;
            EXPECT_NEAR(p.y, expected.y, 1e-6) << t << ' ' << i;
            EXPECT_NEAR(scene.meshes[0].normals[i].z, 1, 1e-6);
        }
    }
}

TEST_F(Player, RejectsDegeneratePoses)
{
    // All weight is on a joint that flattens everything.
    rig.animations[0].channels[0] = channel(AnimatedProperty::scale, Interpolation::step, {0}, {0, 0, 0});
    rig.animations[0].channels[0].target = 1;
    const AnimationPlayer player(scene, rig, 0);
    set_pose(scene, player.pose(0));
    EXPECT_EQ(scene.meshes[0].normals[3].z, 1);
}

/// With motion blur, the scene at each time equals that time's pose: nodes exactly, vertices within the height of a
/// chord.
TEST_F(Player, ShuttersSeeThePosesOfTheirTimes)
{
    const AnimationPlayer player(scene, rig, 0);
    constexpr double begin = 0.25, open = 0.5;
    SceneDescription blurred = scene;
    set_pose(blurred, player.pose(begin, open));
    ASSERT_GE(blurred.nodes[1].motion.size(), 2u);
    ASSERT_GE(blurred.meshes[0].motion.size(), 2u);
    EXPECT_EQ(blurred.meshes[0].motion.back().time, open);
    // The vertex moves on a radius of 2 plus the morph target's offset, in four pieces of an eighth of 90 degrees.
    const double chord = 3 * (1 - std::cos(open * std::numbers::pi / 2 / 8)) + 1e-6;
    for (int step = 0; step <= 16; ++step) {
        const double after = open * step / 16;
        set_pose(scene, player.pose(begin + after));
        const Transform t = transform_at(blurred.nodes[1], after), exact = scene.nodes[1].parent_from_node;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(t.m[i][k], exact.m[i][k], 1e-9) << after;
        const MeshKey vertices = vertices_at(blurred.meshes[0], after);
        for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_NEAR(vertices.positions[i].x, scene.meshes[0].positions[i].x, chord) << after;
            EXPECT_NEAR(vertices.positions[i].y, scene.meshes[0].positions[i].y, chord) << after;
        }
    }
    // Nodes that stand still, or pass through a singular transform, have no motion keys.
    set_pose(blurred, player.pose(7, open));
    EXPECT_TRUE(blurred.nodes[1].motion.empty());
    EXPECT_TRUE(blurred.meshes[0].motion.empty());
    rig.animations[0].channels[0] =
        channel(AnimatedProperty::scale, Interpolation::linear, {0, 1}, {1, 1, 1, -1, 1, 1});
    rig.animations[0].channels[0].target = 1;
    set_pose(blurred, AnimationPlayer(scene, rig, 0).pose(begin, open));
    EXPECT_TRUE(blurred.nodes[1].motion.empty());
}

TEST_F(Player, BrokenRigsAreRefused)
{
    const AnimationRig good = rig;
    const auto error_with = [&](auto spoil) {
        rig = good;
        spoil(rig);
        return error();
    };
    EXPECT_EQ(error_with([](AnimationRig&) {}), "plays");
    EXPECT_EQ(error_with([](AnimationRig& r) { r.animations[0].channels[0].target = 4; }),
              "animation 'bend': channel 0: there is no target 4");
    EXPECT_EQ(error_with([](AnimationRig& r) { r.animations[0].channels[0].target = -1; }),
              "animation 'bend': channel 0: there is no target -1");
    EXPECT_EQ(error_with([](AnimationRig& r) { r.animations[0].channels[1].values.clear(); }),
              "animation 'bend': channel 1: 0 numbers are not as many for each of 2 keys");
    EXPECT_EQ(error_with([](AnimationRig& r) { r.animations[0].problem = "broken"; }),
              "animation 'bend': can't be played: broken");
    EXPECT_EQ(error_with([](AnimationRig& r) { r.meshes[0].joints[0] = 2; }),
              "animation 'bend': a vertex refers to joint 2, there are 2");
    EXPECT_NE(error_with([](AnimationRig& r) { r.skins[0].joints[1] = 9; }), "plays");
    EXPECT_NE(error_with([](AnimationRig& r) { r.meshes[0].joints.pop_back(); }), "plays");
    EXPECT_NE(error_with([](AnimationRig& r) { r.meshes[0].mesh = 1; }), "plays");
    EXPECT_NE(error_with([](AnimationRig& r) { r.parents.pop_back(); }), "plays");
}

}  // namespace
}  // namespace fathom
