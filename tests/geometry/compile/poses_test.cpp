// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>

#include "geometry/bvh/rays_and_scenes.h"
#include "geometry/motion.h"

// Tests of interpolated poses at any time against plain arithmetic in double precision.
namespace fathom {
namespace {

/// A random translation and rotation, and a stretch along rotated axes.
PoseRecord random_pose(Random& random, float time)
{
    PoseRecord pose = random_placement(random, time);
    for (int k : {0, 3, 5}) pose.stretch[k] = random.uniform(5, 20);
    for (int k : {1, 2, 4}) pose.stretch[k] = random.uniform(-1, 1);
    return pose;
}

/// Interpolated poses agree with slerp in double precision: stretch, then rotation by the quaternion's sandwich
/// product, then translation.
TEST(Poses, InDouble)
{
    struct Quaternion {
        double x, y, z, w;
    };
    const auto turned = [](Quaternion q, Vec3d v) {
        // This is v + 2 u x (u x v + w v) with the vector part u (Rodrigues).
        const Vec3d u{q.x, q.y, q.z};
        return v + 2 * cross(u, cross(u, v) + q.w * v);
    };
    Random random(11);
    for (int i = 0; i < 200; ++i) {
        const int count = 2 + int(random.below(3));
        std::vector<PoseRecord> poses;
        std::vector<Quaternion> rotations;
        for (int k = 0; k < count; ++k) {
            PoseRecord pose = random_pose(random, 0.25f + float(k * k) * 0.125f);
            Quaternion q{pose.rotation[0], pose.rotation[1], pose.rotation[2], pose.rotation[3]};
            if (k > 0) {
                const Quaternion& p = rotations.back();
                double cosine = p.x * q.x + p.y * q.y + p.z * q.z + p.w * q.w;
                if (cosine < 0) {
                    q = {-q.x, -q.y, -q.z, -q.w}, cosine = -cosine;
                    for (float& x : pose.rotation) x = -x;
                }
                const double angle = std::acos(std::min(1.0, cosine));
                poses.back().turns = float(angle / (2 * std::numbers::pi));
                poses.back().inverse_sine = float(1 / std::sin(angle));
            }
            poses.push_back(pose), rotations.push_back(q);
        }
        for (const float time : {0.0f, 0.25f, 0.3f, 0.37f, 0.5f, 0.7f, 1.0f, 2.0f}) {
            int k = 0;
            while (k + 1 < count && poses[std::size_t(k) + 1].time <= time) ++k;
            const int next = std::min(k + 1, count - 1);
            const PoseRecord &a = poses[std::size_t(k)], &b = poses[std::size_t(next)];
            const double f =
                next > k ? std::max(0.0, (double(time) - double(a.time)) / (double(b.time) - double(a.time))) : 0;
            const Quaternion &p = rotations[std::size_t(k)], &q = rotations[std::size_t(next)];
            const double angle = std::acos(std::min(1.0, p.x * q.x + p.y * q.y + p.z * q.z + p.w * q.w));
            const double wa = angle > 1e-6 ? std::sin((1 - f) * angle) / std::sin(angle) : 1,
                         wb = angle > 1e-6 ? std::sin(f * angle) / std::sin(angle) : 0;
            const Quaternion r{wa * p.x + wb * q.x, wa * p.y + wb * q.y, wa * p.z + wb * q.z, wa * p.w + wb * q.w};
            const auto between = [&](float x, float y) { return double(x) + f * (double(y) - double(x)); };
            double s[6];
            for (int j = 0; j < 6; ++j) s[j] = between(a.stretch[j], b.stretch[j]);
            const auto expected = [&](Vec3d v) {
                const Vec3d stretched{s[0] * v.x + s[1] * v.y + s[2] * v.z, s[1] * v.x + s[3] * v.y + s[4] * v.z,
                                      s[2] * v.x + s[4] * v.y + s[5] * v.z};
                return turned(r, stretched) + Vec3d{between(a.translation[0], b.translation[0]),
                                                    between(a.translation[1], b.translation[1]),
                                                    between(a.translation[2], b.translation[2])};
            };
            const float* numbers = &poses[0].time;
            const auto number = [&](UInt pose, int field) { return gather(numbers + field, pose << 4); };
            const Affine map = pose_at(number, UInt(std::uint32_t(count)), Float(time));
            const Affine back = map.inverse();
            for (const Vec3f& v : {Vec3f{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5f, -2, 1}}) {
                const Vec3d e = expected({v.x, v.y, v.z});
                const Vec3 got = map.point(Vec3(v)), again = back.point(got);
                float x[6][lanes];
                store(x[0], got.x), store(x[1], got.y), store(x[2], got.z);
                store(x[3], again.x), store(x[4], again.y), store(x[5], again.z);
                const double tolerance = 2e-3;  // absolute tolerance, for values of a few hundred
                EXPECT_NEAR(x[0][0], e.x, tolerance) << i << " at " << time;
                EXPECT_NEAR(x[1][0], e.y, tolerance) << i << " at " << time;
                EXPECT_NEAR(x[2][0], e.z, tolerance) << i << " at " << time;
                EXPECT_NEAR(x[3][0], v.x, tolerance);
                EXPECT_NEAR(x[4][0], v.y, tolerance);
                EXPECT_NEAR(x[5][0], v.z, tolerance);
            }
        }
    }
}

/// A time is mapped to the last key before it, and to the fraction of the interval to the next key.
TEST(Poses, KeysOfVertices)
{
    GeometryTables tables;
    tables.vertex_times = {0.5f, 1, 3, 4};
    struct Case {
        float time;
        std::uint32_t key;
        float fraction;
    };
    for (const Case& c : {Case{0, 0, 0},
                          {0.5f, 0, 0},
                          {0.75f, 0, 0.5f},
                          {1, 1, 0},
                          {1.5f, 1, 0.25f},
                          {2.5f, 1, 0.75f},
                          {3, 2, 0},
                          {3.75f, 2, 0.75f},
                          {4, 2, 1},
                          {9, 2, 1}}) {
        const KeyTime k = vertex_key(tables, Float(c.time));
        std::uint32_t key[lanes];
        float fraction[lanes];
        store(key, k.key), store(fraction, k.fraction);
        EXPECT_EQ(key[0], c.key) << c.time;
        EXPECT_NEAR(fraction[0], c.fraction, 1e-6) << c.time;
    }
}

}  // namespace
}  // namespace fathom
