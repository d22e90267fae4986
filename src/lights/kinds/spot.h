// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/point.h"
#include "math/elementary.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// A point light whose intensity falls off from the inner to the outer cone.
struct SpotLight {
    static constexpr LightRecordKind kind = LightRecordKind::spot;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float time, Sample2 random, Mask active)
    {
        LightPoint s = PointLight::sample(light, p, time, random, active);
        // The default falloff is the square of a linear function of the cosine, as KHR_lights_punctual suggests. 1 -
        // cos is half the squared chord, which is accurate where the cosine is close to 1.
        const Vec3 chord = s.wi + light.edge_u();
        const Float chord2 = dot(chord, chord);
        const Float inside = fma(chord2, Float(-0.5f), light.outer());
        const Float x = clamp(inside / max(light.falloff(), Float(1e-30f)), Float(0), Float(1));
        // With length_u = 1 it is a smoothstep, x^2 (3 - 2 x).
        Float strength = s.strength * x * x * fma(light.length_u(), fma(x, Float(-2), Float(2)), Float(1));
        const Float outer_angle = light.radius();
        const Mask by_solid_angle = outer_angle > Float(0);
        if (any(by_solid_angle)) {
            const Float sine = sqrt(max(chord2 * fma(chord2, Float(-0.25f), Float(1)), Float(0)));
            const Float angle = atan2(sine, fma(chord2, Float(-0.5f), Float(1)));
            const Float linear = clamp((outer_angle - angle) * light.area(), Float(0), Float(1));
            strength = select(by_solid_angle, s.strength * linear, strength);
        }
        s.strength = strength;
        return s;
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
