// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numbers>

#include "lights/compile/kind.h"
#include "math/luminance.h"

namespace fathom {

namespace {

using std::numbers::pi;
/// Narrower disks of directions are delta lights: float directions are too coarse for them.
constexpr double min_angle = 1e-6;

}  // namespace

bool DirectionalLightRecord::is_for(const Light& light)
{
    return light.kind == LightKind::directional;
}
std::optional<double> DirectionalLightRecord::compile(const PlacedLight& at, LightRecord& light)
{
    const double power = luminance(light.radiance) * pi * at.scene_radius * at.scene_radius;
    DirectionalLightRecord directional;
    directional.set_axes(at.light, at.render_from_node);
    if (at.light.angle > min_angle) {
        // Irradiance E of a disk of half angle a at normal incidence is its radiance times pi sin^2 a.
        const double half = std::min(at.light.angle / 2, pi / 2), s = std::sin(half);
        directional.one_minus_cos = float(fathom::one_minus_cos(half));
        for (float& r : light.radiance) r = float(r / (std::numbers::pi * s * s));
    }
    light.set(directional);
    return power;
}
void DirectionalLightRecord::set_axes(const Light&, const Transform& render_from_node)
{
    store(axis, normalize(render_from_node.vector({0, 0, -1})));
}
/// Directional lights are not in the light tree.
LightBall DirectionalLightRecord::ball(const Shutter&) const
{
    return {};
}
void DirectionalLightRecord::set_emission(LightBounds& to, const LightRecord&, double power) const
{
    to.intensity = power;
}

}  // namespace fathom
