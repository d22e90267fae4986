// SPDX-License-Identifier: Apache-2.0
/// Compilation of lights that shine from a point: point lights, spots, and lights with an image.
#include <algorithm>
#include <numbers>

#include "lights/compile/kind.h"
#include "math/luminance.h"

namespace fathom {

namespace {

using std::numbers::pi;

void set_falloff(SpotLightRecord& spot, const Light& light)
{
    const double outer = one_minus_cos(light.outer_angle);
    spot.outer = float(outer);
    spot.falloff = float(outer - one_minus_cos(std::min(light.inner_angle, light.outer_angle)));
    if (light.kind != LightKind::spot) return;
    // Equal inner and outer angles leave no falloff range, and the divisor would be 0.
    const double way = light.outer_angle - light.inner_angle;
    if (light.falloff == SpotFalloff::smooth) spot.is_smooth = 1;
    if (light.falloff == SpotFalloff::linear && way > 1e-6 * light.outer_angle)
        spot.linear_from = float(light.outer_angle), spot.linear_per_radian = float(1 / way);
}

void store_position(float* to, const PlacedLight& at)
{
    store(to, at.render_from_node.point({0, 0, 0}));
}

}  // namespace

bool PointLightRecord::is_for(const Light& light)
{
    return light.kind == LightKind::point;
}
std::optional<double> PointLightRecord::compile(const PlacedLight& at, LightRecord& light)
{
    PointLightRecord point;
    store_position(point.position, at);
    scale_intensity(at, light);
    light.set(point);
    return power_of_intensity(light);
}
void PointLightRecord::add_places(std::vector<Vec3f>& to) const
{
    to.push_back(to_place(position));
}
LightBall PointLightRecord::ball(const Shutter&) const
{
    return {to_vector(position)};
}
void PointLightRecord::set_emission(LightBounds& to, const LightRecord&, double power) const
{
    to.intensity = power / (4 * pi);
}

bool SpotLightRecord::is_for(const Light& light)
{
    return light.kind == LightKind::spot && !is_pictured(light);
}
std::optional<double> SpotLightRecord::compile(const PlacedLight& at, LightRecord& light)
{
    SpotLightRecord spot;
    store_position(spot.position, at);
    spot.set_axes(at.light, at.render_from_node);
    set_falloff(spot, at.light);
    scale_intensity(at, light);
    light.set(spot);
    return power_of_intensity(light);
}
void SpotLightRecord::set_axes(const Light&, const Transform& render_from_node)
{
    store(axis, normalize(render_from_node.vector({0, 0, -1})));
}
void SpotLightRecord::add_places(std::vector<Vec3f>& to) const
{
    to.push_back(to_place(position));
}
LightBall SpotLightRecord::ball(const Shutter&) const
{
    return {to_vector(position)};
}
/// A spot's directions are the normals of its cone, with no emission beyond.
void SpotLightRecord::set_emission(LightBounds& to, const LightRecord&, double power) const
{
    to.axis = to_vector(axis);
    to.cos_normals = 1 - double(outer);
    to.cos_emission = 1 - cosine_slack;
    to.intensity = power / (4 * pi);
}

bool is_pictured(const Light& light)
{
    return light.kind == LightKind::projector || light.kind == LightKind::goniometric ||
           (light.kind == LightKind::spot && light.picture.image >= 0);
}

bool PicturedLightRecord::is_for(const Light& light)
{
    return is_pictured(light);
}
std::optional<double> PicturedLightRecord::compile(const PlacedLight& at, LightRecord& light)
{
    scale_intensity(at, light);
    PicturedLightRecord pictured;
    store_position(pictured.spot.position, at);
    pictured.set_axes(at.light, at.render_from_node);
    set_falloff(pictured.spot, at.light);
    const PicturedIntensity intensity = at.add_picture();
    for (float& r : light.radiance) r = float(double(r) * intensity.factor);
    pictured.picture = intensity.picture;
    if (at.light.kind != LightKind::spot) pictured.spot.outer = float(intensity.outer), pictured.spot.falloff = 0;
    light.set(pictured);
    return intensity.typical * at.render_scale * at.render_scale * 4 * pi;
}
/// The axes of the image stay orthogonal under stretching, and follow the node's mirroring.
void PicturedLightRecord::set_axes(const Light& light, const Transform& t)
{
    spot.set_axes(light, t);
    const Vec3d along = normalize(t.vector({0, 0, -1})), across = t.vector({1, 0, 0});
    const Vec3d to_right = normalize(across - along * dot(across, along)), up = cross(to_right, along);
    store(right, to_right);
    store(top, dot(up, t.vector({0, 1, 0})) < 0 ? -up : up);
}
void PicturedLightRecord::add_places(std::vector<Vec3f>& to) const
{
    spot.add_places(to);
}
LightBall PicturedLightRecord::ball(const Shutter& shutter) const
{
    return spot.ball(shutter);
}
void PicturedLightRecord::set_emission(LightBounds& to, const LightRecord& light, double power) const
{
    spot.set_emission(to, light, power);
    // An image may cover all directions.
    if (spot.outer >= 2) to.axis = {}, to.cos_normals = -1, to.cos_emission = 0;
}

void scale_intensity(const PlacedLight& at, LightRecord& light)
{
    for (float& r : light.radiance) r = float(r * at.render_scale * at.render_scale);
}
double power_of_intensity(const LightRecord& light)
{
    return luminance(light.radiance) * 4 * pi;
}

}  // namespace fathom
