// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/kind.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Isotropic point light: a delta light whose radiance falls off with the squared distance.
struct PointLight {
    static constexpr LightRecordKind kind = LightRecordKind::point;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2, Mask)
    {
        const Vec3 to = light.position() - p;
        const Float distance2 = dot(to, to), distance = sqrt(distance2);
        return {to * (Float(1) / distance), distance, Float(1), Float(1), Float(1) / distance2, Mask(true)};
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
