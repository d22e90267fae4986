// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/spot.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// A point light whose intensity is multiplied by an image, within a cone that contains or cuts the image.
/// light_picture() evaluates the image.
struct PicturedLight {
    using Record = PicturedLightRecord;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float time, Sample2 random, Mask active)
    {
        return SpotLight::sample(light, p, time, random, active);
    }

    template <class Light>
    static EmittedRay emit(const Light& light, Float time, Sample2 position, Sample2 direction)
    {
        return SpotLight::emit(light, time, position, direction);
    }
    template <class Light>
    static Float sample_pdf(const Light&, const Vec3&, const Vec3&)
    {
        return Float(1);
    }
    template <class Light>
    static void aim(const Light& light, EmittedRay& ray, const Vec3& d)
    {
        SpotLight::aim(light, ray, d);
    }
    template <class Light>
    static EmissionDensity emission_density(const Light& light, const Vec3& wi, Float distance)
    {
        return SpotLight::emission_density(light, wi, distance);
    }

    /// Rotates the axes of the image, and keeps them orthogonal.
    template <class Moving>
    static void place(Moving& light, const LightPlace& at, Mask m)
    {
        SpotLight::place(light, at, m);
        const Vec3 axis = light.get(&SpotLightRecord::axis);
        const Vec3 right = at.to_render.vector(light.get(&Record::right)),
                   up = at.to_render.vector(light.get(&Record::top));
        const Vec3 across = unit_or_zero(right - axis * dot(right, axis)), top = cross(across, axis);
        light.set(&Record::right, across, m);
        light.set(&Record::top, flip_sign(top, dot(top, up)), m);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
