// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "curve_scenes.h"

namespace fathom {
namespace {

using namespace test;

/// The helix that moves to a thicker one.
Curves winding(CurveBasis basis, bool ribbons, int points, float r)
{
    Curves curves = helix(basis, ribbons, points, r);
    curves.motion = {{0, curves.points, curves.radii}, {1, curves.points, curves.radii}};
    for (Vec3f& p : curves.motion[1].points) p = {p.x + 0.3f * p.y, 0.8f * p.y, p.z - 0.4f * p.x};
    for (float& radius : curves.motion[1].radii) radius *= 1.5f;
    return curves;
}

/// White curves in a white environment are invisible: no energy is lost or gained and no ray hits its own surface.
/// Grazing light counts most, so any gap would show.
TEST(CurveImages, furnace)
{
    Material white;
    white.base_color.value = {1, 1, 1};
    for (const CurveBasis basis : curve_bases)
        for (bool ribbons : {false, true})
            for (int form = 0; form < 4; ++form) {
                const bool placed = form & 1, moving = form & 2;
                expect_invisible((moving ? winding : helix)(basis, ribbons, 13, 0.12f), white, placed, 200);
            }
}

TEST(CurveImages, balls)
{
    SceneBuilder s;
    s.scene.environment.kind = EnvironmentKind::constant;
    Points points;
    for (int i = 0; i < 200; ++i) {
        const float a = 2.4f * float(i), y = 1 - float(i) / 100, r = std::sqrt(1 - y * y);
        points.centers.push_back({r * std::cos(a), y, r * std::sin(a)});
        points.radii.push_back(0.08f);
    }
    s.scene.points.push_back(points);
    s.add(PointsInstance{0}, s.diffuse(1));
    s.camera({0, 0, 4}, {0, 0, 0});
    RenderSettings settings = small_image_settings();
    settings.max_depth = 200;
    settings.roulette_depth = 200;
    expect_mean(render_film(s.scene, settings, 64), 1, 1e-3);
}

/// Points of a point cloud render like spheres up to the random order of lights, emissive or not.
TEST(CurveImages, balls_are_spheres)
{
    for (bool glow : {false, true}) {
        std::vector<Film> films;
        for (int kind = 0; kind < 2; ++kind) {
            SceneBuilder s;
            s.scene.environment.kind = EnvironmentKind::gradient;
            const int material = s.diffuse(0.5f, glow ? Color{2, 2, 2} : Color{});
            Points points;
            for (int i = 0; i < 100; ++i) {
                const Vec3d p{0.3 * (i % 10) - 1.4, 0.2 * (i / 10) - 0.9, 0.1 * (i % 3)};
                points.centers.push_back({float(p.x), float(p.y), float(p.z)});
                points.radii.push_back(0.08f);
                if (kind == 0)
                    s.add(Sphere{{points.centers.back().x, points.centers.back().y, points.centers.back().z},
                                 double(0.08f),
                                 {}},
                          material);
            }
            s.scene.points.push_back(points);
            if (kind == 1) s.add(PointsInstance{0}, material);
            s.add(Rectangle{{-3, -1.2, 3}, {6, 0, 0}, {0, 0, -6}}, s.diffuse(0.6f));
            s.camera({0, 1, 5}, {0, 0, 0});
            films.push_back(render_film(s.scene, small_image_settings(), 16));
        }
        const Mean a = mean_of(films[0]), b = mean_of(films[1]);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(a.value[c], b.value[c], 1e-6 * a.value[c]);
    }
}

/// Curves of each basis coincide with a fine polyline of the basis' curve.
TEST(CurveImages, bases_are_what_they_say)
{
    const auto covered = [](const Curves& curves) {
        SceneBuilder s;
        s.scene.environment.kind = EnvironmentKind::constant;
        s.scene.curves.push_back(curves);
        Material black;
        black.kind = MaterialKind::none;
        s.add(CurvesInstance{0}, s.material(black));
        s.camera({0, 0.5, 5}, {0, 0, 0});
        return render_film(s.scene, small_image_settings(64, 48), 64).image(false, false).layers[0].pixels;
    };
    for (CurveBasis basis : {CurveBasis::bezier, CurveBasis::bspline, CurveBasis::catmull_rom}) {
        const Curves curves = helix(basis, false, 13, 0.1f);
        Curves fine;
        fine.basis = CurveBasis::linear;
        const auto weights = [&](double t, double w[4]) {
            const double s = 1 - t;
            if (basis == CurveBasis::bezier) {
                w[0] = s * s * s, w[1] = 3 * s * s * t, w[2] = 3 * s * t * t, w[3] = t * t * t;
            } else if (basis == CurveBasis::bspline) {
                w[0] = s * s * s / 6, w[1] = (3 * t * t * t - 6 * t * t + 4) / 6;
                w[2] = (3 * s * s * s - 6 * s * s + 4) / 6, w[3] = t * t * t / 6;
            } else {
                w[0] = (-t + 2 * t * t - t * t * t) / 2, w[1] = (2 - 5 * t * t + 3 * t * t * t) / 2;
                w[2] = (t + 4 * t * t - 3 * t * t * t) / 2, w[3] = (t * t * t - t * t) / 2;
            }
        };
        const std::size_t step = basis == CurveBasis::bezier ? 3 : 1;
        for (std::size_t i = 0; i + 4 <= 13; i += step)
            for (int k = 0; k <= 64; ++k) {
                double w[4], p[4] = {};
                weights(k / 64.0, w);
                for (std::size_t j = 0; j < 4; ++j) {
                    const Vec3f q = curves.points[i + j];
                    const double from[4] = {q.x, q.y, q.z, curves.radii[i + j]};
                    for (int c = 0; c < 4; ++c) p[c] += w[j] * from[c];
                }
                fine.points.push_back({float(p[0]), float(p[1]), float(p[2])});
                fine.radii.push_back(float(p[3]));
            }
        fine.counts = {std::uint32_t(fine.points.size())};
        const auto a = covered(curves), b = covered(fine);
        double difference = 0;
        for (std::size_t i = 0; i < a.size(); ++i) difference += std::abs(a[i] - b[i]) / double(a.size());
        EXPECT_LT(difference, 0.003) << int(basis);
    }
}

}  // namespace
}  // namespace fathom
