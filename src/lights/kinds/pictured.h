// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/spot.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// A point light whose intensity is multiplied by an image, within a cone that contains or cuts the image.
/// light_picture() evaluates the image.
struct PicturedLight {
    static constexpr LightRecordKind kind = LightRecordKind::pictured;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float time, Sample2 random, Mask active)
    {
        return SpotLight::sample(light, p, time, random, active);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
