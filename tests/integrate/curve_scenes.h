// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "picture_helpers.h"

namespace fathom::test {

inline constexpr CurveBasis curve_bases[] = {CurveBasis::linear, CurveBasis::bezier, CurveBasis::bspline,
                                             CurveBasis::catmull_rom};

/// Control points on a helix, with radius r.
inline Curves helix(CurveBasis basis, bool ribbons, int points, float r)
{
    Curves curves;
    curves.basis = basis;
    curves.ribbons = ribbons;
    for (int i = 0; i < points; ++i) {
        const float a = 0.7f * float(i);
        curves.points.push_back({std::cos(a), 0.15f * float(i) - 1, std::sin(a)});
        curves.radii.push_back(r * (1 + 0.3f * float(i % 3)));
    }
    curves.counts = {std::uint32_t(points)};
    return curves;
}

/// Moves curves to a sheared form while the shutter is open.
inline void shear_in_time(Curves& curves)
{
    curves.motion = {{0, curves.points, curves.radii}, {1, curves.points, curves.radii}};
    for (Vec3f& p : curves.motion[1].points) p = {p.x - 0.2f * p.z, p.y, p.z + 0.3f * p.y};
}

/// Curves that lose and gain no light are invisible in a white environment, under any transform.
inline void expect_invisible(const Curves& curves, const Material& white, bool placed, int max_depth)
{
    SceneBuilder s;
    s.scene.environment = uniform_sky();
    s.scene.curves.push_back(curves);
    s.add(CurvesInstance{0}, s.material(white));
    if (placed) s.scene.nodes[0].parent_from_node = Transform::scale({1, -0.7, 1.3});
    s.camera({0, 0.5, 5}, {0, 0, 0});
    s.scene.cameras[0].shutter_close = 1;
    RenderSettings settings = small_image_settings();
    settings.max_depth = settings.roulette_depth = max_depth;
    SCOPED_TRACE(testing::Message() << int(curves.basis) << curves.ribbons << placed << !curves.motion.empty());
    expect_mean(render_film(s.scene, settings, 64), 1, 1e-3);
}

}  // namespace fathom::test
