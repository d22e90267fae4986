// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/kind.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Light from infinity, from one direction or a disk of directions; rays can't hit it. The record's radius is 1 - cos
/// of the disk's half angle, 0 for a delta light; its radiance member is the disk's radiance, or the delta light's
/// irradiance.
struct DirectionalLight {
    static constexpr LightRecordKind kind = LightRecordKind::directional;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3, Float, Sample2 random, Mask)
    {
        const Float spread = light.radius();
        const Vec3 wi = Frame(-light.edge_u()).to_world(sample_cone(random, spread));
        return {wi,       Float(infinity), select(spread <= Float(0), Float(1), Float(2 * pi) * spread),
                Float(1), Float(1),        Mask(true)};
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
