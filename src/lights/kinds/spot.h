// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/point.h"
#include "math/elementary.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// A point light whose intensity falls off from the inner to the outer cone.
struct SpotLight {
    using Record = SpotLightRecord;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2, Mask)
    {
        LightPoint s = PointLight::from_point(light.get(&Record::position), p);
        // The default falloff is the square of a linear function of the cosine, as KHR_lights_punctual suggests. 1 -
        // cos is half the squared chord, which is accurate where the cosine is close to 1.
        const Vec3 chord = s.wi + light.get(&Record::axis);
        const Float chord2 = dot(chord, chord);
        const Float inside = fma(chord2, Float(-0.5f), light.get(&Record::outer));
        const Float x = clamp(inside / max(light.get(&Record::falloff), Float(1e-30f)), Float(0), Float(1));
        // A smoothstep is x^2 (3 - 2 x).
        const Float is_smooth = light.get(&Record::is_smooth);
        Float strength = s.strength * x * x * fma(is_smooth, fma(x, Float(-2), Float(2)), Float(1));
        const Float outer_angle = light.get(&Record::linear_from);
        const Mask by_solid_angle = outer_angle > Float(0);
        if (any(by_solid_angle)) {
            const Float sine = sqrt(max(chord2 * fma(chord2, Float(-0.25f), Float(1)), Float(0)));
            const Float angle = atan2(sine, fma(chord2, Float(-0.5f), Float(1)));
            const Float per_radian = light.get(&Record::linear_per_radian);
            const Float linear = clamp((outer_angle - angle) * per_radian, Float(0), Float(1));
            strength = select(by_solid_angle, s.strength * linear, strength);
        }
        s.strength = strength;
        return s;
    }

    template <class Moving>
    static void place(Moving& light, const LightPlace& at, Mask m)
    {
        light.set(&Record::position, at.to_render.shift, m);
        light.set(&Record::axis, normalize(at.to_render.vector(light.get(&Record::axis))), m);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
