// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "lights/tree/build_tree.h"
#include "lights/tree/selector.h"
#include "support/chi_square.h"
#include "support/lane_helpers.h"

namespace fathom {
namespace {

using test::first;

void put(float* to, Vec3d v)
{
    to[0] = float(v.x), to[1] = float(v.y), to[2] = float(v.z);
}

/// Independent random numbers, as plain doubles.
class RandomNumbers {
public:
    explicit RandomNumbers(unsigned seed) : engine_(seed) {}
    double operator()(double lo = 0, double hi = 1) { return lo + (hi - lo) * double(engine_() >> 8) * 0x1p-24; }
    bool flip() { return (*this)() < 0.5; }
    Vec3d point(double size) { return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)}; }
    Vec3d direction()
    {
        for (;;)
            if (const Vec3d d = point(1); dot(d, d) < 1 && dot(d, d) > 1e-2) return normalize(d);
    }

private:
    std::mt19937 engine_;
};

constexpr double close_time = 0.5;

/// A light of any kind, with its power as estimated by the light compiler.
LightRecord random_light(RandomNumbers& chance, double room, double size, double& power)
{
    constexpr double pi = std::numbers::pi;
    LightRecord l;
    const auto kind = LightRecordKind(std::uint32_t(chance(0, 7)));
    l.kind = std::uint32_t(kind);
    l.flags = chance.flip();
    for (float& r : l.radiance) r = float(chance(0.5, 2));
    put(l.position, chance.point(room));
    const Vec3d n = chance.direction(), u = normalize(cross(n, chance.direction())), v = cross(n, u);
    const double a = size * chance(0.2, 1), b = size * chance(0.2, 1), slant = chance(-0.5, 0.5);
    put(l.normal, n);
    switch (kind) {
        case LightRecordKind::rectangle:
            put(l.edge_u, u), put(l.edge_v, v);
            l.length_u = float(a), l.length_v = float(b), l.area = float(a * b), l.radius = float(std::hypot(a, b));
            for (int i = 0; i < 3; ++i)
                l.motion_or_center[i] = l.position[i] + (l.edge_u[i] * l.length_u + l.edge_v[i] * l.length_v) / 2;
            break;
        case LightRecordKind::parallelogram:
        case LightRecordKind::triangle:
            put(l.edge_u, u * a), put(l.edge_v, v * b + u * (b * slant));
            l.area = float(kind == LightRecordKind::triangle ? a * b / 2 : a * b);
            break;
        case LightRecordKind::sphere:
            l.radius = float(l.flags || chance.flip() ? a : -a);
            l.area = float(4 * pi * a * a);
            put(l.motion_or_center, chance.flip() ? chance.direction() * size * 4 : Vec3d{});
            break;
        case LightRecordKind::disk:
            l.radius = float(a), l.area = float(pi * a * a);
            break;
        default: {
            l.flags = 1;
            put(l.edge_u, n);
            const double outer = chance(0.05, 2.5);
            l.outer = float(1 - std::cos(outer));
            l.falloff = float(l.outer * float(chance(0, 1)));
            power = double(l.radiance[0]) * 4 * pi;
            return l;
        }
    }
    power = double(l.radiance[0]) * double(l.area) * pi * (l.flags ? 2 : 1);
    return l;
}

struct Lamps {
    LightTables tables;
    double room;

    /// `placed` lights in a room of the given extent around the origin, and some directional lights.
    Lamps(unsigned seed, std::uint32_t placed, double size, std::uint32_t directions = 0, double extent = 10)
        : room(extent)
    {
        RandomNumbers chance(seed);
        std::vector<double> powers(placed);
        for (double& power : powers)
            tables.lights.push_back(random_light(chance, room, size * std::pow(100, chance(-1, 0)), power));
        for (std::uint32_t i = 0; i < directions; ++i) {
            powers.push_back(powers[0]);
            tables.lights.emplace_back().kind = std::uint32_t(LightRecordKind::directional);
        }
        double sum = 0, running = 0;
        for (double p : powers) sum += p;
        tables.light_cdf.push_back(0);
        for (std::size_t i = 0; i < powers.size(); ++i) {
            running += powers[i];
            tables.light_cdf.push_back(float(running / sum));
            tables.lights[i].pmf = tables.light_cdf[i + 1] - tables.light_cdf[i];
        }
        tables.positioned_lights = placed;
        build_light_tree(tables, powers, 0, close_time);
    }
    LightReader<false> light(std::uint32_t i) const { return {tables.lights.data(), UInt(i)}; }
};

Vec3 as_lanes(Vec3d p)
{
    return Vec3(Vec3f{float(p.x), float(p.y), float(p.z)});
}

/// Numbers of lights below and above a node's capacity, and trees of several levels.
constexpr std::uint32_t sizes[] = {1, 2, 7, 16, 17, 40, 300};

/// Calls f(lamps, selector, number of lights, seed) for trees of each size, also with directional lights.
template <class F>
void for_each_size(unsigned seed, F&& f)
{
    for (const std::uint32_t n : sizes)
        for (const std::uint32_t directions : {0u, 3u}) {
            const Lamps lamps(++seed, n, 1, directions);
            f(lamps, LightSelector(lamps.tables, LightSelection::tree), n + directions, seed);
        }
}

/// Selection probability of each light.
std::vector<double> probabilities(const Lamps& lamps, const LightSelector& selector, std::uint32_t count, Vec3 p)
{
    std::vector<double> pmf;
    for (std::uint32_t i = 0; i < count; ++i) pmf.push_back(double(first(selector.pmf(lamps.light(i), p, Mask(true)))));
    return pmf;
}

TEST(LightTree, ProbabilitiesAddUpToOne)
{
    for_each_size(0, [](const Lamps& lamps, const LightSelector& selector, std::uint32_t count, unsigned seed) {
        RandomNumbers chance(seed);
        for (int k = 0; k < 20; ++k) {
            const std::vector<double> pmf =
                probabilities(lamps, selector, count, as_lanes(chance.point(k % 2 ? 10 : 30)));
            EXPECT_NEAR(std::accumulate(pmf.begin(), pmf.end(), 0.0), 1, 1e-5) << count << " lights";
        }
    });
}

/// Histogram of selected lights; select() and pmf() return the same probability.
void expect_as_often_as_probable(const Lamps& lamps, const LightSelector& selector, std::uint32_t count, Vec3 p,
                                 unsigned seed)
{
    test::Random random(seed);
    constexpr int draws = 1 << 15;
    std::vector<double> drawn(count), expected = probabilities(lamps, selector, count, p);
    for (double& number : expected) number *= draws;
    for (int k = 0; k < draws; k += lanes) {
        const Float u = random.next();
        const LightSelector::Choice c = selector.select(p, u, random.next(), Mask(true));
        std::uint32_t light[lanes];
        float pmf[lanes];
        store(light, c.light), store(pmf, c.pmf);
        for (int lane = 0; lane < lanes; ++lane) {
            ASSERT_LT(light[lane], count);
            drawn[light[lane]] += 1;
            EXPECT_NEAR(draws * double(pmf[lane]) / expected[light[lane]], 1, 1e-5);
        }
    }
    EXPECT_EQ(test::chi_square(drawn, expected), "") << count << " lights";
}

TEST(LightTree, FrequencyMatchesProbability)
{
    for_each_size(100, [](const Lamps& lamps, const LightSelector& selector, std::uint32_t count, unsigned seed) {
        expect_as_often_as_probable(lamps, selector, count, as_lanes(RandomNumbers(seed).point(10)), seed);
    });
}

/// All weights are 0 and the probabilities small, so rounding at interval ends matters.
TEST(LightTree, FrequencyMatchesProbabilityWithoutContribution)
{
    for (const std::uint32_t n : {11u, 300u}) {
        Lamps lamps(n, n, 1);
        for (LightRecord& l : lamps.tables.lights) {
            l = {};
            l.kind = std::uint32_t(LightRecordKind::triangle);
            put(l.position, RandomNumbers(unsigned(&l - lamps.tables.lights.data())).point(1));
            put(l.normal, {0, 0, 1}), put(l.edge_u, {0.1, 0, 0}), put(l.edge_v, {0, 0.1, 0});
            l.area = 0.005f;
        }
        build_light_tree(lamps.tables, std::vector<double>(n, 1), 0, 0);
        expect_as_often_as_probable(lamps, LightSelector(lamps.tables, LightSelection::tree), n, as_lanes({0, 0, -50}),
                                    n);
    }
}

/// Lanes have different points, and inactive lanes change nothing.
TEST(LightTree, EachLaneSeesItsOwnPoint)
{
    for (const std::uint32_t n : {9u, 120u}) {
        const Lamps lamps(7, n, 1, 2);
        const LightSelector selector(lamps.tables, LightSelection::tree);
        test::Random random(3);
        const auto coordinate = [&] { return (random.next() - Float(0.5f)) * Float(20); };
        const Float x = coordinate(), y = coordinate();
        const Vec3 p{x, y, coordinate()};
        const Float u = random.next(), noise = random.next();
        const LightSelector::Choice all = selector.select(p, u, noise, Mask(true));
        float px[lanes], py[lanes], pz[lanes], pu[lanes], pn[lanes], pmf[lanes];
        std::uint32_t light[lanes];
        store(px, p.x), store(py, p.y), store(pz, p.z), store(pu, u), store(pn, noise), store(pmf, all.pmf);
        store(light, all.light);
        for (int k = 0; k < lanes; ++k) {
            const Vec3 q(Vec3f{px[k], py[k], pz[k]});
            const LightSelector::Choice one = selector.select(q, Float(pu[k]), Float(pn[k]), Mask(true));
            EXPECT_EQ(first(one.light), light[k]);
            EXPECT_EQ(first(one.pmf), pmf[k]);
            float alone[lanes];
            store(alone, selector.select(p, u, noise, mask_from_bits(1u << k)).pmf);
            EXPECT_EQ(alone[k], pmf[k]);
        }
    }
}

/// If a boundary lies between two adjacent 24-bit random numbers, the additional noise bits decide.
TEST(LightTree, NoiseDecidesBetweenTwoFloats)
{
    const Lamps lamps(11, 300, 1);
    const LightSelector selector(lamps.tables, LightSelection::tree);
    const Vec3 p = as_lanes({1, 2, 3});
    const auto light = [&](std::uint32_t m, float noise) {
        return first(selector.select(p, Float(float(m) * 0x1p-24f), Float(noise), Mask(true)).light);
    };
    std::uint32_t lo = 0, hi = (1u << 24) - 1;
    const std::uint32_t below = light(lo, 0);
    ASSERT_NE(light(hi, 0), below);
    while (hi - lo > 1) {
        const std::uint32_t middle = (lo + hi) / 2;
        (light(middle, 0) == below ? lo : hi) = middle;
    }
    EXPECT_EQ(light(lo, 0), below);
    EXPECT_EQ(light(lo, 1 - 0x1p-24f), light(hi, 0));
}

/// Brute force: every light that a sample finds emitting has a positive probability. Points are in the room, near
/// lights, and in planes of flat lights.
TEST(LightTree, WhateverShinesMayBeSelected)
{
    std::size_t shining = 0, dark = 0;
    for (unsigned seed = 1; seed <= 20; ++seed)
        for (const std::uint32_t n : {12u, 150u}) {
            const Lamps lamps(seed, n, seed % 2 ? 0.1 : 3);
            const LightSelector selector(lamps.tables, LightSelection::tree);
            RandomNumbers chance(seed);
            test::Random random(seed);
            for (std::uint32_t i = 0; i < n; ++i)
                for (int k = 0; k < 8; ++k) {
                    const LightRecord& l = lamps.tables.lights[i];
                    const Vec3d at{double(l.position[0]), double(l.position[1]), double(l.position[2])},
                        normal{double(l.normal[0]), double(l.normal[1]), double(l.normal[2])};
                    Vec3d p = k < 2 ? chance.point(20) : at + chance.point(k < 5 ? 0.3 : 5);
                    // Half of the points are slightly in front of the light's plane.
                    if (k % 2) p = p - normal * (dot(p - at, normal) - 1e-4);
                    const Float time = random.next() * Float(float(close_time));
                    const LightSample s = sample_light(lamps.light(i), as_lanes(p), time, random.next2(), Mask(true));
                    const Mask shines = (s.inverse_pdf > Float(0)) & (s.radiance.c[0] > Float(0));
                    if (none(shines)) {
                        ++dark;
                        continue;
                    }
                    ++shining;
                    EXPECT_GT(first(selector.pmf(lamps.light(i), as_lanes(p), Mask(true))), 0)
                        << "kind " << l.kind << ", place " << k << ", seed " << seed;
                }
        }
    EXPECT_GT(shining, 10000u);
    EXPECT_GT(dark, 1000u);
}

/// Bounding spheres contain moving lights at all times.
TEST(LightTree, BallsHoldWhatMoves)
{
    const Lamps lamps(5, 100, 1);
    for (const LightRecord& l : lamps.tables.lights) {
        if (l.kind != std::uint32_t(LightRecordKind::sphere)) continue;
        const LightNode& n = lamps.tables.light_tree[l.tree_place / LightNode::width];
        const std::size_t slot = l.tree_place % LightNode::width;
        for (const double time : {0.0, 0.2, close_time}) {
            const auto away = [&](int i, const LightNode::Column& middle) {
                return double(l.position[i]) + double(l.motion_or_center[i]) * time - double(middle[slot]);
            };
            EXPECT_LE(std::hypot(away(0, n.x), away(1, n.y), away(2, n.z)) + std::abs(double(l.radius)),
                      double(n.radius[slot]));
        }
    }
}

/// Irradiance of a surface point from the center of a flat, one-sided light.
double irradiance(const LightRecord& l, Vec3d p, Vec3d n)
{
    const auto vector = [](const float* v) { return Vec3d{double(v[0]), double(v[1]), double(v[2])}; };
    const Vec3d d = vector(l.position) + (vector(l.edge_u) + vector(l.edge_v)) * (1.0 / 3) - p;
    const double distance2 = dot(d, d);
    const double cosines = std::max(dot(d, n), 0.0) * std::max(-dot(d, vector(l.normal)), 0.0) / distance2;
    return double(l.area) * cosines / distance2;
}

/// Triangles of random sizes in a room, as in bench/many_lights.py.
Lamps triangles(unsigned seed, std::uint32_t n)
{
    Lamps lamps(seed, n, 1);
    RandomNumbers chance(seed);
    std::vector<double> powers(n);
    double sum = 0, running = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
        LightRecord& l = lamps.tables.lights[i] = {};
        const Vec3d m = chance.direction(), u = normalize(cross(m, chance.direction()));
        const double size = 0.1 * std::pow(100, chance(-1, 0));
        l.kind = std::uint32_t(LightRecordKind::triangle);
        put(l.position, {chance(-5, 5), chance(0.1, 4), chance(-5, 5)});
        put(l.normal, m), put(l.edge_u, u * size), put(l.edge_v, cross(m, u) * size);
        l.area = float(size * size / 2);
        sum += powers[i] = double(l.area);
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        running += powers[i];
        lamps.tables.light_cdf[i + 1] = float(running / sum);
        lamps.tables.lights[i].pmf = float(powers[i] / sum);
    }
    build_light_tree(lamps.tables, powers, 0, 0);
    return lamps;
}

/// Strong lights need no traversal because they are children of the root; half of its children remain for the others.
TEST(LightTree, LightsThatAreStrongAreChildrenOfTheRoot)
{
    for (const std::uint32_t strong : {1u, 3u, 11u}) {
        Lamps lamps = triangles(4, 300);
        std::vector<double> powers(300, 1);
        for (std::uint32_t i = 0; i < strong; ++i) powers[100 + i] = 5000 - i;
        build_light_tree(lamps.tables, powers, 0, close_time);
        std::uint32_t in_root = 0, strong_in_root = 0;
        for (std::uint32_t i = 0; i < 300; ++i) {
            const bool is_in_root = lamps.tables.lights[i].tree_place < LightNode::width;
            in_root += is_in_root, strong_in_root += is_in_root && i >= 100 && i < 100 + strong;
        }
        EXPECT_EQ(strong_in_root, std::min(strong, LightNode::width / 2u)) << strong;
        EXPECT_EQ(lamps.tables.light_tree[0].count, std::uint32_t(LightNode::width));
        EXPECT_LE(in_root, LightNode::width / 2u) << strong;
    }
}

/// The mean of contribution over probability of selected lights is the total contribution.
TEST(LightTree, EstimatesTheSum)
{
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const Lamps lamps = triangles(seed, 20 * seed);
        const LightSelector selector(lamps.tables, LightSelection::tree);
        RandomNumbers chance(seed);
        test::Random random(seed);
        const Vec3d p{chance(-5, 5), 0, chance(-5, 5)}, n{0, 1, 0};
        double expected = 0, sum = 0, squares = 0;
        for (const LightRecord& l : lamps.tables.lights) expected += irradiance(l, p, n);
        constexpr int draws = 1 << 13;
        for (int k = 0; k < draws; k += lanes) {
            const Float u = random.next();
            const LightSelector::Choice c = selector.select(as_lanes(p), u, random.next(), Mask(true));
            std::uint32_t light[lanes];
            float pmf[lanes];
            store(light, c.light), store(pmf, c.pmf);
            for (int lane = 0; lane < lanes; ++lane) {
                const double x = irradiance(lamps.tables.lights[light[lane]], p, n) / double(pmf[lane]);
                sum += x, squares += x * x;
            }
        }
        const double mean = sum / draws, error = std::sqrt((squares / draws - mean * mean) / draws);
        EXPECT_NEAR(mean, expected, 4.5 * error) << "seed " << seed;
    }
}

/// Parallel beams: inside one of them, the others are never selected, even if they are near.
TEST(LightTree, NarrowLightsAreChosenWhereTheyReach)
{
    for (const std::uint32_t n : {9u, 40u}) {
        LightTables tables;
        const std::vector<double> powers(n, 1);
        for (std::uint32_t i = 0; i < n; ++i) {
            LightRecord& l = tables.lights.emplace_back();
            l.kind = std::uint32_t(LightRecordKind::beam);
            put(l.position, {1.5 * i, 0, 0});
            put(l.edge_u, {0.25, 0, 0}), put(l.edge_v, {0, 0, 0.25}), put(l.normal, {0, 1, 0});
            l.area = 0.25f;
            l.pmf = 1 / float(n);
        }
        for (std::uint32_t i = 0; i <= n; ++i) tables.light_cdf.push_back(float(i) / float(n));
        tables.positioned_lights = n;
        build_light_tree(tables, powers, 0, close_time);
        const LightSelector tree(tables, LightSelection::tree);
        for (std::uint32_t i = 0; i < n; ++i) {
            const Vec3d p{1.5 * i, 8, 0};
            EXPECT_GT(first(tree.pmf(LightReader<false>(tables.lights.data(), UInt(i)), as_lanes(p), Mask(true))), 0.99)
                << i << " of " << n;
        }
    }
}

/// 10,000 lights: exact variance of direct light by summing over all lights. Measured: a twentieth of that of power
/// sampling.
TEST(LightTree, VarianceIsFarBelowThatByPower)
{
    const Lamps lamps = triangles(1, 10000);
    const LightSelector tree(lamps.tables, LightSelection::tree);
    RandomNumbers chance(1);
    double by_tree = 0, by_power = 0;
    for (int k = 0; k < 12; ++k) {
        const Vec3d p{chance(-5, 5), 0, chance(-5, 5)}, n{0, 1, 0};
        double sum = 0, tree_squares = 0, power_squares = 0;
        for (std::uint32_t i = 0; i < lamps.tables.lights.size(); ++i) {
            const LightRecord& l = lamps.tables.lights[i];
            const double x = irradiance(l, p, n);
            if (x == 0) continue;
            sum += x;
            tree_squares += x * x / double(first(tree.pmf(lamps.light(i), as_lanes(p), Mask(true))));
            power_squares += x * x / double(l.pmf);
        }
        by_tree += tree_squares / (sum * sum) - 1;
        by_power += power_squares / (sum * sum) - 1;
    }
    EXPECT_LT(by_tree, by_power / 10);
}

}  // namespace
}  // namespace fathom
