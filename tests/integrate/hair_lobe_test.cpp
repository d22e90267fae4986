// SPDX-License-Identifier: Apache-2.0
#include "curve_scenes.h"

// Tests of round glass curves: closed solids with an inside and an outside.
namespace fathom {
namespace {

using namespace test;

Curves bent(CurveBasis basis)
{
    Curves curves;
    curves.basis = basis;
    for (int i = 0; i < 7; ++i) {
        const float a = 0.8f * float(i);
        curves.points.push_back({std::cos(a), 0.3f * float(i) - 0.9f, std::sin(a)});
        curves.radii.push_back(0.15f * (1 + 0.4f * float(i % 2)));
    }
    curves.counts = {7};
    return curves;
}

Material glass(float ior)
{
    Material m;
    m.kind = MaterialKind::glass;
    m.ior = ior;
    return m;
}

/// Clear glass loses and gains nothing.
TEST(HairLobes, ClearGlassInAWhiteSky)
{
    for (const CurveBasis basis : curve_bases)
        for (int form = 0; form < 4; ++form) {
            const bool placed = form & 1, moving = form & 2;
            Curves curves = bent(basis);
            if (moving) shear_in_time(curves);
            expect_invisible(curves, glass(1.5f), placed, 1000);
        }
}

/// Distance of a ray inside the spheres swept along a chain of points, by small steps.
double distance_inside(const Curves& chain, Vec3d o, Vec3d d)
{
    const auto is_within = [&](Vec3d p) {
        for (std::size_t i = 0; i + 1 < chain.points.size(); ++i) {
            const auto wide = [](Vec3f v) { return Vec3d{v.x, v.y, v.z}; };
            const Vec3d a = wide(chain.points[i]), e = wide(chain.points[i + 1]) - a, q = p - a;
            const double ra = chain.radii[i], g = chain.radii[i + 1] - ra;
            const double w = std::clamp((dot(q, e) + g * ra) / (dot(e, e) - g * g), 0.0, 1.0);
            if (length(q - e * w) < ra + w * g) return true;
        }
        return false;
    };
    constexpr double step = 1e-3;
    double way = 0;
    for (double t = step / 2; t < 10; t += step) way += is_within(o + d * t) ? step : 0;
    return way;
}

/// Glass of index 1 does not refract: transmission follows the Beer-Lambert law by the total distance inside all
/// pieces, for cameras outside and inside.
TEST(HairLobes, AbsorbByThePathLengthThroughAllSegments)
{
    const Curves chain = bent(CurveBasis::linear);
    Material clear = glass(1);
    clear.interior.attenuation_color = {0.3f, 0.3f, 0.3f};
    clear.interior.attenuation_distance = 0.2;
    int thick = 0;
    for (int i = 0; i < 60; ++i) {
        const Vec3d at{std::sin(1.7 * i) * 1.1, 0.03 * i - 0.9, std::cos(2.3 * i) * 1.1};
        const Vec3d on_axis{chain.points[std::size_t(i % 7)].x, chain.points[std::size_t(i % 7)].y,
                            chain.points[std::size_t(i % 7)].z};
        const Vec3d from = i % 3 == 0 ? on_axis + Vec3d{0.03, 0.02, 0.05} : at + Vec3d{0.5, 0.4, 4};
        const Vec3d to = i % 3 == 0 ? from + at : i % 3 == 1 ? on_axis + Vec3d{0.02, 0.03, 0} : at;
        const Vec3d d = normalize(to - from);
        SceneBuilder s;
        s.scene.environment.kind = EnvironmentKind::constant;
        s.scene.curves.push_back(chain);
        s.add(CurvesInstance{0}, s.material(clear));
        s.camera(from, from + d, 1e-3);
        const double way = distance_inside(chain, from, d);
        thick += way > 0.1;
        EXPECT_NEAR(mean_of(render_film(s.scene, small_image_settings(4, 4), 4)).value[0], std::pow(0.3, way / 0.2),
                    0.02)
            << i << ": " << way;
    }
    EXPECT_GT(thick, 25);
}

/// A straight glass curve renders like a fine cylinder of triangles.
TEST(HairLobes, MatchGlassCylinders)
{
    Mean mean[2];
    for (const bool mesh : {false, true}) {
        SceneBuilder s;
        s.scene.environment.kind = EnvironmentKind::gradient;
        s.scene.environment.bottom = {0, 0, 0}, s.scene.environment.top = {1, 1, 1};
        const int material = s.material(glass(1.5f));
        if (mesh) {
            Mesh m;
            constexpr std::uint32_t n = 512;
            for (std::uint32_t i = 0; i < n; ++i)
                for (const float x : {-20.f, 20.f}) {
                    const float a = float(2 * std::numbers::pi) * float(i) / n;
                    m.positions.push_back({x, std::cos(a), std::sin(a)});
                    m.normals.push_back({0, std::cos(a), std::sin(a)});
                }
            for (std::uint32_t i = 0; i < n; ++i) {
                const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % n);
                for (const std::uint32_t v : {a, b + 1, a + 1, a, b, b + 1}) m.indices.push_back(v);
            }
            s.scene.meshes.push_back(m);
            s.add(MeshInstance{0}, material);
        } else {
            Curves rod;
            rod.basis = CurveBasis::linear;
            rod.points = {{-20, 0, 0}, {-3, 0, 0}, {2, 0, 0}, {20, 0, 0}};
            rod.radii.assign(4, 1.f);
            rod.counts = {4};
            s.scene.curves.push_back(rod);
            s.add(CurvesInstance{0}, material);
        }
        s.camera({0.5, 1, 5}, {0, 0.3, 0}, 30);
        mean[mesh] = mean_of(render_film(s.scene, small_image_settings(), 1024));
    }
    EXPECT_NEAR(mean[0].value[0], mean[1].value[0],
                4 * std::hypot(mean[0].error[0], mean[1].error[0]) + 1e-3 * mean[1].value[0]);
}

}  // namespace
}  // namespace fathom
