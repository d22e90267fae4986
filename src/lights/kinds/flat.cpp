// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numbers>

#include "lights/compile/kind.h"

namespace fathom {

namespace {

using std::numbers::pi;

LightBall parallelogram_ball(Vec3d corner, Vec3d a, Vec3d b)
{
    return {corner + (a + b) * 0.5, std::max(length(a + b), length(a - b)) / 2};
}

}  // namespace

void FlatLightRecord::set_emission(LightBounds& to, const LightRecord& light, double power) const
{
    to.axis = to_vector(normal);
    to.cos_normals = 1;
    to.emits_back = (light.flags & LightRecord::two_sided) != 0;
    to.intensity = power / (light.flags & LightRecord::two_sided ? 2 * pi : pi);
}

LightBall RectangleLightRecord::ball(const Shutter&) const
{
    return parallelogram_ball(to_vector(corner), to_vector(u) * double(length_u), to_vector(v) * double(length_v));
}
void RectangleLightRecord::set_emission(LightBounds& to, const LightRecord& light, double power) const
{
    flat.set_emission(to, light, power);
}

LightBall ParallelogramLightRecord::ball(const Shutter&) const
{
    return parallelogram_ball(to_vector(corner), to_vector(edge_u), to_vector(edge_v));
}
void ParallelogramLightRecord::set_emission(LightBounds& to, const LightRecord& light, double power) const
{
    flat.set_emission(to, light, power);
}

LightBall TriangleLightRecord::ball(const Shutter&) const
{
    const Vec3d p = to_vector(corner), u = to_vector(edge_u), v = to_vector(edge_v), a = p + u, b = p + v;
    const auto middle = [](double x, double y, double z) { return (std::min({x, y, z}) + std::max({x, y, z})) / 2; };
    const Vec3d c{middle(p.x, a.x, b.x), middle(p.y, a.y, b.y), middle(p.z, a.z, b.z)};
    return {c, std::max({length(p - c), length(a - c), length(b - c)})};
}
void TriangleLightRecord::set_emission(LightBounds& to, const LightRecord& light, double power) const
{
    flat.set_emission(to, light, power);
}

LightBall DiskLightRecord::ball(const Shutter&) const
{
    return {to_vector(center), double(radius)};
}
void DiskLightRecord::set_emission(LightBounds& to, const LightRecord& light, double power) const
{
    flat.set_emission(to, light, power);
}

}  // namespace fathom
