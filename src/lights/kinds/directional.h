// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/kind.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Light from infinity, from one direction or a disk of directions; rays can't hit it.
struct DirectionalLight {
    using Record = DirectionalLightRecord;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3, Float, Sample2 random, Mask)
    {
        const Float spread = light.get(&Record::one_minus_cos);
        const Vec3 wi = Frame(-light.get(&Record::axis)).to_world(sample_cone(random, spread));
        return {wi,       Float(infinity), select(spread <= Float(0), Float(1), Float(2 * pi) * spread),
                Float(1), Float(1),        Mask(true)};
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
