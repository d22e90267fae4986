// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lights/compile/kind.h"
#include "math/luminance.h"

namespace fathom {

bool BeamLightRecord::is_for(const Light& light)
{
    return light.kind == LightKind::beam;
}
std::optional<double> BeamLightRecord::compile(const PlacedLight& at, LightRecord& light)
{
    const Light& l = at.light;
    const Transform& t = at.render_from_node;
    const Vec3d u = t.vector({l.width / 2, 0, 0}), v = t.vector({0, l.height / 2, 0});
    const double area = length(cross(u, v)) * (l.round ? std::numbers::pi : 4);
    if (!(area > 0)) return {};
    BeamLightRecord beam;
    beam.is_round = l.round;
    beam.area = float(area);
    store(beam.center, t.point({0, 0, 0}));
    beam.set_axes(l, t);
    light.set(beam);
    return luminance(light.radiance) * area;
}
void BeamLightRecord::set_axes(const Light& light, const Transform& t)
{
    const Vec3d u = t.vector({light.width / 2, 0, 0}), v = t.vector({0, light.height / 2, 0}), n = cross(u, v);
    store(half_u, u), store(half_v, v);
    store(axis, normalize(dot(n, t.vector({0, 0, -1})) < 0 ? -n : n));
}
double BeamLightRecord::node_radius(const Light& light)
{
    return std::hypot(light.width, light.height) / 2;
}
void BeamLightRecord::add_places(std::vector<Vec3f>& to) const
{
    for (const float i : {-1.f, 1.f})
        for (const float j : {-1.f, 1.f}) {
            const auto corner = [&](int k) { return center[k] + i * half_u[k] + j * half_v[k]; };
            to.push_back({corner(0), corner(1), corner(2)});
        }
}
LightBall BeamLightRecord::ball(const Shutter&) const
{
    const Vec3d u = to_vector(half_u), v = to_vector(half_v);
    return {to_vector(center),
            is_round > 0 ? std::hypot(length(u), length(v)) : std::max(length(u + v), length(u - v))};
}
void BeamLightRecord::set_emission(LightBounds& to, const LightRecord&, double power) const
{
    // Distance at which a beam's irradiance defines its intensity for importance, which falls off with the squared
    // distance although the beam does not. It is a quarter to half of the scene's radius (512 to 1024 in render space).
    constexpr double typical_distance = 256;
    to.axis = to_vector(axis);
    to.cos_normals = 1;
    to.cos_emission = 1 - cosine_slack;
    to.intensity = power / double(area) * typical_distance * typical_distance;
}

}  // namespace fathom
