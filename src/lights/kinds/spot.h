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
        s.strength = with_falloff(light, s.wi, s.strength);
        return s;
    }
    /// Samples the cone uniformly.
    template <class Light>
    static EmittedRay emit(const Light& light, Float, Sample2, Sample2 direction)
    {
        EmittedRay ray;
        ray.o = light.get(&Record::position);
        ray.n = Vec3(Float(0), Float(0), Float(0));
        aim(light, ray, Frame(light.get(&Record::axis)).to_world(sample_cone(direction, cone(light))));
        return ray;
    }
    template <class Light>
    static void aim(const Light& light, EmittedRay& ray, const Vec3& d)
    {
        ray.d = d;
        ray.scale = with_falloff(light, -d, Float(2 * pi) * cone(light));
        ray.pdf = Float(0.5f * inv_pi) / cone(light);
    }
    template <class Light>
    static Float sample_pdf(const Light&, const Vec3&, const Vec3&)
    {
        return Float(1);
    }
    template <class Light>
    static EmissionDensity emission_density(const Light& light, const Vec3& wi, Float distance)
    {
        const Mask inside = Float(1) + dot(wi, light.get(&Record::axis)) < cone(light);
        const Float pdf = Float(0.5f * inv_pi) / cone(light);
        return {select(inside, pdf / (distance * distance), Float(0)), pdf};
    }

    /// Strength multiplied by the falloff for light that travels along -wi.
    template <class Light>
    static Float with_falloff(const Light& light, const Vec3& wi, Float strength)
    {
        // The default falloff is the square of a linear function of the cosine, as KHR_lights_punctual suggests. 1 -
        // cos is half the squared chord, which is accurate where the cosine is close to 1.
        const Vec3 chord = wi + light.get(&Record::axis);
        const Float chord2 = dot(chord, chord);
        const Float inside = fma(chord2, Float(-0.5f), light.get(&Record::outer));
        const Float x = clamp(inside / max(light.get(&Record::falloff), Float(1e-30f)), Float(0), Float(1));
        // A smoothstep is x^2 (3 - 2 x).
        const Float is_smooth = light.get(&Record::is_smooth);
        const Float by_cosine = strength * x * x * fma(is_smooth, fma(x, Float(-2), Float(2)), Float(1));
        const Float outer_angle = light.get(&Record::linear_from);
        const Mask by_solid_angle = outer_angle > Float(0);
        if (none(by_solid_angle)) return by_cosine;
        const Float sine = sqrt(max(chord2 * fma(chord2, Float(-0.25f), Float(1)), Float(0)));
        const Float angle = atan2(sine, fma(chord2, Float(-0.5f), Float(1)));
        const Float per_radian = light.get(&Record::linear_per_radian);
        const Float linear = clamp((outer_angle - angle) * per_radian, Float(0), Float(1));
        return select(by_solid_angle, strength * linear, by_cosine);
    }

    template <class Moving>
    static void place(Moving& light, const LightPlace& at, Mask m)
    {
        light.set(&Record::position, at.to_render.shift, m);
        light.set(&Record::axis, normalize(at.to_render.vector(light.get(&Record::axis))), m);
    }

private:
    /// 1 - cos of the angle between the axis and the edge of the light.
    template <class Light>
    static Float cone(const Light& light)
    {
        return min(light.get(&Record::outer), Float(2));
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
