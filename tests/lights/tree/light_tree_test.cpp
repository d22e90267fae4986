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

template <class Own>
LightRecord edges_light(Vec3d corner, Vec3d u, Vec3d v)
{
    Own own;
    put(own.corner, corner), put(own.edge_u, u), put(own.edge_v, v), put(own.flat.normal, normalize(cross(u, v)));
    own.flat.area = float(length(cross(u, v)) * (std::is_same_v<Own, TriangleLightRecord> ? 0.5 : 1));
    LightRecord l;
    l.set(own);
    return l;
}

double area_of(const LightRecord& l)
{
    return double(l.is<SphereLightRecord>() ? l.get<SphereLightRecord>().area : l.get<FlatLightRecord>().area);
}

/// Sets the record of a random kind, at p and with its normal along n if it has one.
void set_random_kind(LightRecord& l, RandomNumbers& chance, Vec3d p, Vec3d n, double size)
{
    const Vec3d u = normalize(cross(n, chance.direction())), v = cross(n, u);
    const double a = size * chance(0.2, 1), b = size * chance(0.2, 1), slant = chance(-0.5, 0.5);
    switch (LightRecordKind(l.kind)) {
        case LightRecordKind::rectangle: {
            RectangleLightRecord r;
            put(r.corner, p), put(r.u, u), put(r.v, v), put(r.flat.normal, n);
            r.length_u = float(a), r.length_v = float(b), r.flat.area = float(a * b);
            r.diagonal = float(std::hypot(a, b));
            put(r.center, p + (u * a + v * b) * 0.5);
            return l.set(r);
        }
        case LightRecordKind::parallelogram:
        case LightRecordKind::triangle: {
            const Vec3d w = v * b + u * (b * slant);
            const bool triangle = l.is<TriangleLightRecord>();
            l.own = (triangle ? edges_light<TriangleLightRecord>(p, u * a, w)
                              : edges_light<ParallelogramLightRecord>(p, u * a, w))
                        .own;
            return;
        }
        case LightRecordKind::sphere: {
            SphereLightRecord s;
            put(s.center, p);
            s.radius = float(l.flags || chance.flip() ? a : -a);
            s.area = float(4 * std::numbers::pi * a * a);
            put(s.velocity, chance.flip() ? chance.direction() * size * 4 : Vec3d{});
            return l.set(s);
        }
        case LightRecordKind::disk: {
            DiskLightRecord d;
            put(d.center, p), put(d.flat.normal, n);
            d.radius = float(a), d.flat.area = float(std::numbers::pi * a * a);
            return l.set(d);
        }
        case LightRecordKind::point: {
            PointLightRecord point;
            put(point.position, p);
            l.flags = 1;
            return l.set(point);
        }
        default: {
            SpotLightRecord spot;
            put(spot.position, p), put(spot.axis, n);
            const double outer = chance(0.05, 2.5);
            spot.outer = float(1 - std::cos(outer));
            spot.falloff = float(spot.outer * float(chance(0, 1)));
            l.flags = 1;
            return l.set(spot);
        }
    }
}

/// A point of the light and its normal or axis, if it has one.
struct Place {
    Vec3d at, normal;
};
Place place_of(const LightRecord& l)
{
    const auto vector = [](const float* v) { return Vec3d{double(v[0]), double(v[1]), double(v[2])}; };
    const Vec3d normal = vector(l.get<FlatLightRecord>().normal);
    switch (LightRecordKind(l.kind)) {
        case LightRecordKind::sphere:
            return {vector(l.get<SphereLightRecord>().center), {}};
        case LightRecordKind::point:
            return {vector(l.get<PointLightRecord>().position), {}};
        case LightRecordKind::spot:
            return {vector(l.get<SpotLightRecord>().position), vector(l.get<SpotLightRecord>().axis)};
        case LightRecordKind::disk:
            return {vector(l.get<DiskLightRecord>().center), normal};
        default:  // flat kinds with a corner
            return {vector(l.get<TriangleLightRecord>().corner), normal};
    }
}

/// A light of any kind, with its power as estimated by the light compiler.
LightRecord random_light(RandomNumbers& chance, double room, double size, double& power)
{
    constexpr double pi = std::numbers::pi;
    LightRecord l;
    l.kind = std::uint32_t(chance(0, 7));
    l.flags = chance.flip();
    for (float& r : l.radiance) r = float(chance(0.5, 2));
    const Vec3d p = chance.point(room), n = chance.direction();
    set_random_kind(l, chance, p, n, size);
    const bool has_area = !l.is<PointLightRecord>() && !l.is<SpotLightRecord>();
    power = double(l.radiance[0]) * pi * (has_area ? area_of(l) * (l.flags ? 2 : 1) : 4);
    return l;
}

struct Lamps {
    LightTables tables;
    double room;

    /// `placed` lights with a position, in a room of the given extent around the origin, and some directional lights.
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

/// The sizes are numbers of lights below and above a node's capacity, and for trees of several levels.
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
            const Vec3d corner = RandomNumbers(unsigned(&l - lamps.tables.lights.data())).point(1);
            l = edges_light<TriangleLightRecord>(corner, {0.1, 0, 0}, {0, 0.1, 0});
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

/// By brute force: every light that a sample finds emitting has a positive selection probability. Points are in the
/// room, near lights, and in planes of flat lights.
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
                    const auto [at, normal] = place_of(l);
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
        if (!l.is<SphereLightRecord>()) continue;
        const auto sphere = l.get<SphereLightRecord>();
        const LightNode& n = lamps.tables.light_tree[l.tree_place / LightNode::width];
        const std::size_t slot = l.tree_place % LightNode::width;
        for (const double time : {0.0, 0.2, close_time}) {
            const auto away = [&](int i, const LightNode::Column& middle) {
                return double(sphere.center[i]) + double(sphere.velocity[i]) * time - double(middle[slot]);
            };
            EXPECT_LE(std::hypot(away(0, n.x), away(1, n.y), away(2, n.z)) + std::abs(double(sphere.radius)),
                      double(n.radius[slot]));
        }
    }
}

/// Irradiance of a surface point from the center of a one-sided triangle.
double irradiance(const LightRecord& light, Vec3d p, Vec3d n)
{
    const auto l = light.get<TriangleLightRecord>();
    const auto vector = [](const float* v) { return Vec3d{double(v[0]), double(v[1]), double(v[2])}; };
    const Vec3d d = vector(l.corner) + (vector(l.edge_u) + vector(l.edge_v)) * (1.0 / 3) - p;
    const double distance2 = dot(d, d);
    const double cosines = std::max(dot(d, n), 0.0) * std::max(-dot(d, vector(l.flat.normal)), 0.0) / distance2;
    return double(l.flat.area) * cosines / distance2;
}

/// Triangles of random sizes in a room, as in bench/many_lights.py.
Lamps triangles(unsigned seed, std::uint32_t n)
{
    Lamps lamps(seed, n, 1);
    RandomNumbers chance(seed);
    std::vector<double> powers(n);
    double sum = 0, running = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
        const Vec3d m = chance.direction(), u = normalize(cross(m, chance.direction()));
        const double size = 0.1 * std::pow(100, chance(-1, 0));
        const Vec3d corner{chance(-5, 5), chance(0.1, 4), chance(-5, 5)};
        lamps.tables.lights[i] = edges_light<TriangleLightRecord>(corner, u * size, cross(m, u) * size);
        sum += powers[i] = area_of(lamps.tables.lights[i]);
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        running += powers[i];
        lamps.tables.light_cdf[i + 1] = float(running / sum);
        lamps.tables.lights[i].pmf = float(powers[i] / sum);
    }
    build_light_tree(lamps.tables, powers, 0, 0);
    return lamps;
}

/// Strong lights are children of the root and need no traversal; half of the root's children remain for other lights.
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

/// In a scene of parallel beams, a point inside one of them never selects the others, even if they are near.
TEST(LightTree, NarrowLightsAreChosenWhereTheyReach)
{
    for (const std::uint32_t n : {9u, 40u}) {
        LightTables tables;
        const std::vector<double> powers(n, 1);
        for (std::uint32_t i = 0; i < n; ++i) {
            LightRecord& l = tables.lights.emplace_back();
            BeamLightRecord beam;
            put(beam.center, {1.5 * i, 0, 0});
            put(beam.half_u, {0.25, 0, 0}), put(beam.half_v, {0, 0, 0.25}), put(beam.axis, {0, 1, 0});
            beam.area = 0.25f;
            l.set(beam);
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

/// The exact variance of direct light from 10,000 lights, by summing over all lights, is far below that of sampling by
/// power: a twentieth, as measured.
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
