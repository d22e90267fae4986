// SPDX-License-Identifier: Apache-2.0
#include "floor.h"

// Tests of emissive curves: with NEE and with BSDF sampling alone, they illuminate a floor equally except for noise.
namespace fathom {
namespace {

using namespace test;

Curves glowing(CurveBasis basis, bool ribbons, float radius)
{
    Curves curves;
    curves.basis = basis;
    curves.ribbons = ribbons;
    for (int i = 0; i < 7; ++i) {
        const float a = 0.9f * float(i);
        curves.points.push_back({0.5f * std::cos(a), 0.6f + 0.12f * float(i), 0.5f * std::sin(a)});
        curves.radii.push_back(radius * (1 + 0.5f * float(i % 3)));
    }
    curves.counts = {7};
    return curves;
}

/// Where the curves are. points: their control points move; both: their node moves as well.
enum class Place { world, placed, moving, points, both };
constexpr Place places[] = {Place::world, Place::placed, Place::moving, Place::points, Place::both};

void add_curves(SceneBuilder& b, Curves curves, Place place)
{
    if (place == Place::points || place == Place::both) {
        const auto key = [&](double time, float turn, float thick) {
            CurvesKey k{time, curves.points, curves.radii};
            for (Vec3f& p : k.points) p = {p.x + turn, p.y + 0.5f * turn * p.x, p.z - turn * p.y};
            for (float& r : k.radii) r *= thick;
            return k;
        };
        curves.motion = {key(0, 0, 1), key(0.4, 0.3f, 2), key(1, 0.2f, 0.5f)};
    }
    b.scene.curves.push_back(curves);
    const Shape shape{CurvesInstance{0}, b.diffuse(0, {3, 3, 3}), ""};
    Node node;
    node.shapes.push_back(shape);
    if (place == Place::placed)
        node.parent_from_node =
            Transform::translate({0.3, 0, 0}) * Transform::rotate({0, 1, 0.1}, 1) * Transform::scale({1.2, 1.2, 1.2});
    if (place == Place::moving || place == Place::both)
        node.motion = {{0, {}},
                       {1, Transform::translate({0.6, 0.2, 0}) * Transform::rotate({0, 1, 0.1}, 1) *
                               Transform::scale({0.8, 0.8, 0.8})}};
    // With two placements, curves become instances.
    for (int i = 0; i < (place == Place::placed ? 2 : 1); ++i) {
        b.scene.roots.push_back(int(b.scene.nodes.size()));
        b.scene.nodes.push_back(node);
        node.parent_from_node = Transform::translate({-0.4, 0.1, 0.2});
    }
}

TEST(CurveLights, SampledOrByChanceTheSameLight)
{
    for (const CurveBasis basis : {CurveBasis::linear, CurveBasis::bezier, CurveBasis::bspline})
        for (const bool ribbons : {false, true})
            for (const Place place : places)
                for (const int way : {2, 3}) {
                    Mean mean[2];
                    for (const bool light_sampling : {true, false}) {
                        Floor floor;
                        floor.shutter_close = 1;
                        floor.light_sampling = light_sampling;
                        floor.samples = light_sampling ? 256 : 2048;
                        floor.add_objects = [&](SceneBuilder& b) {
                            add_curves(b, glowing(basis, ribbons, 0.05f), place);
                        };
                        mean[light_sampling] = floor.irradiance(0.1, 0.2, way);
                    }
                    EXPECT_GT(mean[1].value[0], 0.1);
                    EXPECT_NEAR(mean[1].value[0], mean[0].value[0],
                                4.5 * std::hypot(mean[0].error[0], mean[1].error[0]))
                        << int(basis) << ribbons << int(place) << Floor::ways[way];
                }
}

/// BSDF sampling rarely hits thin curves, so NEE has much less noise.
TEST(CurveLights, HaveLessNoise)
{
    for (const bool ribbons : {false, true})
        for (const Place place : places) {
            Mean mean[2];
            for (const bool light_sampling : {true, false}) {
                Floor floor;
                floor.shutter_close = 1;
                floor.light_sampling = light_sampling;
                floor.samples = 512;
                floor.add_objects = [&](SceneBuilder& b) {
                    add_curves(b, glowing(CurveBasis::bspline, ribbons, 0.003f), place);
                };
                mean[light_sampling] = floor.irradiance(0.1, 0.2, 2);
            }
            // The variances differ by more than 10; of 32,768 samples without NEE a few hundred hit the curve.
            EXPECT_LT(std::pow(mean[1].error[0], 2), std::pow(mean[0].error[0], 2) / 10) << ribbons << int(place);
            EXPECT_NEAR(mean[1].value[0], mean[0].value[0], 4.5 * std::hypot(mean[0].error[0], mean[1].error[0]));
        }
}

/// A straight round curve emits as its cylinder and end hemispheres do, integrated over cells.
TEST(CurveLights, ARodSendsWhatACapsuleDoes)
{
    const double r = 0.1, y = 0.8, length = 1.2;
    const Vec3d p{0.3, 0, 0.1};
    double expected = 0;
    constexpr int n = 200;
    const auto add = [&](Vec3d at, Vec3d normal, double area) {
        const Vec3d to = at - p;
        const double facing = -dot(to, normal);
        if (facing > 0) expected += 3 * facing * to.y * area / std::pow(dot(to, to), 2);
    };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double a = 2 * std::numbers::pi * (j + 0.5) / n;
            const Vec3d out{0, std::cos(a), std::sin(a)};
            add(Vec3d{-length / 2 + length * (i + 0.5) / n, y, 0} + out * r, out,
                length / n * 2 * std::numbers::pi * r / n);
            // The hemisphere at each end: equal heights have equal areas.
            for (const double side : {-1.0, 1.0}) {
                const double h = (i + 0.5) / n, ring = std::sqrt(1 - h * h);
                const Vec3d normal{side * h, ring * std::cos(a), ring * std::sin(a)};
                add(Vec3d{side * length / 2, y, 0} + normal * r, normal, 2 * std::numbers::pi * r * r / n / n);
            }
        }
    Floor floor;
    floor.samples = 1024;
    floor.add_objects = [&](SceneBuilder& b) {
        Curves rod;
        rod.basis = CurveBasis::linear;
        rod.points = {{float(-length / 2), float(y), 0}, {float(length / 2), float(y), 0}};
        rod.radii = {float(r), float(r)};
        rod.counts = {2};
        b.scene.curves.push_back(rod);
        b.add(CurvesInstance{0}, b.diffuse(0, {3, 3, 3}));
    };
    floor.expect(p.x, p.z, expected, 2e-3);
}

}  // namespace
}  // namespace fathom
