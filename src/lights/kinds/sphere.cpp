// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "lights/compile/kind.h"

namespace fathom {

LightBall SphereLightRecord::ball(const Shutter& shutter) const
{
    const Vec3d motion = to_vector(velocity);
    return {to_vector(center) + motion * ((shutter.open + shutter.close) / 2),
            std::abs(double(radius)) + length(motion) * (shutter.close - shutter.open) / 2};
}
void SphereLightRecord::set_emission(LightBounds& to, const LightRecord& light, double power) const
{
    to.intensity = power / ((light.flags & LightRecord::two_sided ? 8 : 4) * std::numbers::pi);
}

/// The bounds of curves depend on tables; the compiler sets them (LightExtent).
LightBall CurveLightRecord::ball(const Shutter&) const
{
    return {};
}
void CurveLightRecord::set_emission(LightBounds& to, const LightRecord&, double power) const
{
    to.intensity = power / (4 * std::numbers::pi);
}

}  // namespace fathom
