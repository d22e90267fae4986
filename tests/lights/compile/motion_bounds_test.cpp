// SPDX-License-Identifier: Apache-2.0
#include "lights/compile/motion_bounds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/compile/poses.h"
#include "scene/motion.h"

namespace fathom {
namespace {

class Chance {
public:
    explicit Chance(unsigned seed) : engine_(seed) {}
    double operator()(double lo, double hi) { return lo + (hi - lo) * double(engine_() >> 8) * 0x1p-24; }
    Vec3d vector(double size) { return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)}; }

private:
    std::mt19937 engine_;
};

std::vector<NodeKey> random_motion(Chance& chance, bool keeps_shape)
{
    std::vector<NodeKey> keys;
    for (int i = 0; i < 4; ++i) {
        const double s = chance(0.3, 3);
        keys.push_back(
            {0.3 * i, Transform::translate(chance.vector(10)) * Transform::rotate(chance.vector(1), chance(-3, 3)) *
                          Transform::scale(keeps_shape ? Vec3d{s, s, s} : Vec3d{s, chance(0.3, 3), -1})});
    }
    return keys;
}

Transform place_at(const std::vector<NodeKey>& keys, double time)
{
    std::size_t i = 0;
    while (i + 2 < keys.size() && keys[i + 1].time <= time) ++i;
    return interpolate(pose_of(keys[i].parent_from_node), pose_of(keys[i + 1].parent_from_node),
                       (time - keys[i].time) / (keys[i + 1].time - keys[i].time))
        .transform();
}

/// By brute force over times: geometry carried by a motion never leaves its bounds.
TEST(LightMotionBounds, HoldsWhatItCarries)
{
    int narrow = 0;
    for (unsigned seed = 1; seed <= 60; ++seed) {
        Chance chance(seed);
        const bool keeps_shape = seed % 3 != 0;
        std::vector<NodeKey> keys = random_motion(chance, keeps_shape);
        // Some motions rotate only slightly.
        if (seed % 2 && keeps_shape)
            for (NodeKey& key : keys)
                key.parent_from_node = Transform::translate(chance.vector(5)) *
                                       Transform::rotate({1, 2, 3}, chance(-0.4, 0.4)) * Transform::scale({2, 2, 2});
        const std::vector<PoseRecord> poses = pose_tables(keys);
        const LightMotionBounds path(poses);
        EXPECT_EQ(path.keeps_shape(), keeps_shape);
        const Vec3d center = chance.vector(3), normal = normalize(chance.vector(1));
        const double radius = chance(0, 1);
        LightExtent ball{};
        path.set_bounding_ball(center, radius, ball);
        const NormalCone cone = path.cone(normal);
        narrow += cone.cosine > 0;
        for (int i = 0; i <= 5000; ++i) {
            const Transform now = place_at(keys, 0.9 * i / 5000);
            const Vec3d edge = center + normalize(chance.vector(1)) * radius;
            EXPECT_LE(length(now.point(edge) - ball.center), ball.radius * (1 + 1e-5) + 1e-5);
            if (cone.cosine > -1) EXPECT_GE(dot(normalize(now.vector(normal)), cone.axis), cone.cosine - 1e-6);
        }
        // The bounds are not much larger than the path.
        double farthest = 0;
        for (int i = 0; i <= 200; ++i)
            farthest = std::max(farthest, length(place_at(keys, 0.9 * i / 200).point(center) - ball.center));
        EXPECT_LE(ball.radius, 2 * farthest + 6 * radius);
    }
    EXPECT_GT(narrow, 15);
}

TEST(LightMotionBounds, ConesHoldSumsOfTheirDirections)
{
    Chance chance(1);
    for (int n = 0; n < 200; ++n) {
        std::vector<Vec3d> directions;
        for (int i = 0; i < 5; ++i) directions.push_back(Vec3d{0, 0, 1} + chance.vector(n % 2 ? 0.4 : 1.2));
        const NormalCone cone = cone_around(directions);
        if (cone.cosine <= 0) continue;
        for (int k = 0; k < 50; ++k) {
            Vec3d sum;
            for (const Vec3d& d : directions) sum = sum + d * chance(0, 1);
            EXPECT_GE(dot(normalize(sum), cone.axis), cone.cosine - 1e-9);
        }
    }
    EXPECT_EQ(cone_around({{0, 0, 1}, {0, 0, -1}}).cosine, -1);
    EXPECT_EQ(cone_around({}).cosine, -1);
}

}  // namespace
}  // namespace fathom
