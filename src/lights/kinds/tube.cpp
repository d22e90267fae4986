// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "lights/compile/kind.h"
#include "math/luminance.h"

namespace fathom {

namespace {

using std::numbers::pi;

}  // namespace

bool TubeLightRecord::is_for(const Light& light)
{
    return light.kind == LightKind::tube;
}
std::optional<double> TubeLightRecord::compile(const PlacedLight& at, LightRecord& light)
{
    TubeLightRecord tube;
    store(tube.center, at.render_from_node.point({0, 0, 0}));
    tube.set_axes(at.light, at.render_from_node);
    const double area = 2 * pi * double(tube.radius) * 2 * length(to_vector(tube.half_axis));
    if (!(area > 0)) return {};
    // Converts the flux, which refers to areas in world units, to radiance.
    const double factor = at.render_scale * at.render_scale / (pi * area);
    if (at.light.intensity_is_flux)
        for (float& r : light.radiance) r = float(double(r) * factor);
    light.set(tube);
    return luminance(light.radiance) * pi * area;
}
void TubeLightRecord::set_axes(const Light& light, const Transform& t)
{
    const Vec3d unit = t.vector({0, 0, 1});
    store(half_axis, unit * (light.length / 2));
    // The determinant is the change of lengths along the axis times that of areas across it.
    radius = length(unit) > 0 ? float(light.radius * std::sqrt(std::abs(t.determinant()) / length(unit))) : 0;
}
double TubeLightRecord::node_radius(const Light& light)
{
    return std::hypot(light.length / 2, light.radius);
}
void TubeLightRecord::add_places(std::vector<Vec3f>& to) const
{
    for (const float end : {-1.f, 1.f})
        for (int corner = 0; corner < 8; ++corner) {
            const auto place = [&](int axis) {
                return center[axis] + end * half_axis[axis] + (corner >> axis & 1 ? radius : -radius);
            };
            to.push_back({place(0), place(1), place(2)});
        }
}
LightBall TubeLightRecord::ball(const Shutter&) const
{
    return {to_vector(center), std::hypot(length(to_vector(half_axis)), double(radius))};
}
/// Intensity is highest across the axis: radiance times the area of the silhouette, 1 / pi of that of the side.
void TubeLightRecord::set_emission(LightBounds& to, const LightRecord&, double power) const
{
    to.intensity = power / (pi * pi);
}

}  // namespace fathom
