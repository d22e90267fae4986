// SPDX-License-Identifier: Apache-2.0
#include "kernel/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "kernel/camera_paths.h"
#include "support/chi_square.h"
#include "support/lane_helpers.h"

namespace fathom {
namespace {

using test::first;

/// A camera at (1, 2, 3) that looks along -x with z up: right is +y by cross(forward, up).
CameraRecord camera()
{
    CameraRecord c;
    const float position[] = {1, 2, 3}, right[] = {0, 1, 0}, up[] = {0, 0, 1}, forward[] = {-1, 0, 0};
    for (int i = 0; i < 3; ++i) {
        c.position[i] = position[i];
        c.right[i] = right[i], c.up[i] = up[i], c.forward[i] = forward[i];
    }
    c.half_width = 0.8f, c.half_height = 0.5f;
    return c;
}

struct PlainRay {
    Vec3d o, d;
    double time;
};

PlainRay ray_of(const CameraRecord& c, double x, double y, Sample2 lens = {Float(0.5f), Float(0.5f)}, double time = 0)
{
    const CameraRay r = camera_ray(c, Float(float(x)), Float(float(y)), lens, Float(float(time)));
    const auto vector = [](const Vec3& v) { return Vec3d{first(v.x), first(v.y), first(v.z)}; };
    return {vector(r.o), vector(r.d), first(r.time)};
}

void expect_near(Vec3d a, Vec3d b, double tolerance = 1e-6)
{
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

/// A shifted camera is a crop of a larger image with the same lens: points map to the same rays, also in focus.
TEST(CameraRay, Shift)
{
    const Sample2 lens{Float(0.3f), Float(0.8f)};
    for (const bool is_orthographic : {false, true})
        for (const float radius : {0.f, 0.2f}) {
            CameraRecord whole = camera(), part = camera();
            whole.orthographic = part.orthographic = is_orthographic;
            whole.lens_radius = part.lens_radius = radius;
            whole.focus_distance = part.focus_distance = 3;
            part.half_width = whole.half_width / 4, part.half_height = whole.half_height / 2;
            // The part is the last quarter of the width and the lower half of the height.
            part.shift_right = 0.75f * whole.half_width, part.shift_up = -0.5f * whole.half_height;
            for (const auto& [x, y] : {std::pair{0.5, 0.5}, {0.0, 0.25}, {1.0, 1.0}}) {
                const PlainRay a = ray_of(part, x, y, lens), b = ray_of(whole, 0.75 + x / 4, 0.5 + y / 2, lens);
                expect_near(a.o, b.o);
                expect_near(a.d, b.d);
            }
        }
}

/// x increases along `right`, y against `up`: the first pixel is at the top left.
TEST(CameraRay, PerspectiveAndOrthographic)
{
    CameraRecord c = camera();
    for (const auto& [x, y] : {std::pair{0.5, 0.5}, {0.0, 0.0}, {1.0, 0.25}, {0.3, 1.0}}) {
        const double right = 0.8 * (2 * x - 1), up = 0.5 * (1 - 2 * y);
        c.orthographic = 0;
        PlainRay ray = ray_of(c, x, y);
        expect_near(ray.o, {1, 2, 3});
        expect_near(ray.d, normalize(Vec3d{-1, right, up}));
        c.orthographic = 1;
        ray = ray_of(c, x, y);
        expect_near(ray.o, {1, 2 + right, 3 + up});
        expect_near(ray.d, {-1, 0, 0});
    }
}

/// Origins are uniform over the lens, and rays of one image point meet at the focus distance.
TEST(CameraRay, LensAndFocus)
{
    CameraRecord c = camera();
    c.lens_radius = 0.25f;
    c.focus_distance = 4;
    test::Random random;
    std::vector<double> observed(64), expected(64, 20000 / 64.0);
    for (int i = 0; i < 20000; ++i) {
        const Sample2 lens{Float(first(random.next())), Float(first(random.next()))};
        const PlainRay ray = ray_of(c, 0.9, 0.2, lens);
        ASSERT_NEAR(length(ray.d), 1, 1e-6);
        ASSERT_NEAR(ray.o.x, 1, 1e-6);
        const double y = (ray.o.y - 2) / 0.25, z = (ray.o.z - 3) / 0.25, r2 = y * y + z * z;
        ASSERT_LE(r2, 1 + 1e-5);
        ++observed[std::size_t(std::min(7, int(r2 * 8)) * 8 +
                               std::min(7, int((std::atan2(z, y) / (2 * std::numbers::pi) + 0.5) * 8)))];
        // A depth of 4 along the axis moves the point 0.64 * 4 to the right and 0.3 * 4 up.
        const double t = -4 / ray.d.x;
        expect_near(ray.o + ray.d * t, {1 - 4, 2 + 0.64 * 4, 3 + 0.3 * 4}, 2e-5);
    }
    EXPECT_EQ(test::chi_square(observed, expected), "");
}

TEST(CameraRay, TimeIsThatOfTheShutter)
{
    CameraRecord c = camera();
    c.shutter_open = 2, c.shutter_close = 5;
    EXPECT_FLOAT_EQ(float(ray_of(c, 0.5, 0.5, {Float(0), Float(0)}, 0).time), 2);
    EXPECT_FLOAT_EQ(float(ray_of(c, 0.5, 0.5, {Float(0), Float(0)}, 0.25).time), 2.75f);
    EXPECT_LT(ray_of(c, 0.5, 0.5, {Float(0), Float(0)}, 0.999).time, 5);
}

/// No two decisions of a path share random numbers: light, direction, lobe, roulette and camera, at the same bounce and
/// at different ones.
TEST(RandomNumbers, OfADecisionAreItsOwn)
{
    struct Decision {
        std::uint32_t group, pair;
    };
    std::vector<Decision> decisions = {{0, pair_film}, {0, pair_lens}, {0, pair_time}};
    for (std::uint32_t bounce : {0u, 1u, 2u})
        for (std::uint32_t pair : {pair_light, pair_bsdf, pair_choice, pair_roulette})
            decisions.push_back({bounce + 1, pair});
    constexpr std::uint32_t n = 4096;
    std::vector<std::vector<double>> numbers;
    for (const Decision& d : decisions) {
        std::vector<double> x, y;
        for (std::uint32_t i = 0; i < n; ++i) {
            const SampleKey key{hash(UInt(77u)), reverse_bits(UInt(i))};
            const Sample2 s = sample_2d(key, pair_seed(group_seed(key, UInt(d.group)), d.pair));
            x.push_back(first(s.x) - 0.5), y.push_back(first(s.y) - 0.5);
        }
        numbers.push_back(x), numbers.push_back(y);
    }
    for (std::size_t a = 0; a < numbers.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) {
            double sum = 0;
            for (std::uint32_t i = 0; i < n; ++i) sum += numbers[a][i] * numbers[b][i];
            // The limit is five standard errors of the correlation of independent numbers.
            EXPECT_LT(std::abs(12 * sum / n), 5 / std::sqrt(double(n))) << a << " " << b;
        }
}

}  // namespace
}  // namespace fathom
