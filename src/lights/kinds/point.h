// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/kind.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Isotropic point light: a delta light whose radiance falls off with the squared distance.
struct PointLight {
    using Record = PointLightRecord;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2, Mask)
    {
        return from_point(light.get(&Record::position), p);
    }
    /// Light of intensity 1 from a point.
    static LightPoint from_point(const Vec3& position, const Vec3& p)
    {
        const Vec3 to = position - p;
        const Float distance2 = dot(to, to), distance = sqrt(distance2);
        return {to * (Float(1) / distance), distance, Float(1), Float(1), Float(1) / distance2, Mask(true)};
    }

    template <class Light>
    static EmittedRay emit(const Light& light, Float, Sample2, Sample2 direction)
    {
        return {light.get(&Record::position), sample_sphere(direction), Vec3(Float(0), Float(0), Float(0)),
                Float(4 * pi), Float(0.25f * inv_pi)};
    }
    template <class Light>
    static Float sample_pdf(const Light&, const Vec3&, const Vec3&)
    {
        return Float(1);
    }
    template <class Light>
    static void aim(const Light&, EmittedRay& ray, const Vec3& d)
    {
        ray.d = d;
    }
    template <class Light>
    static EmissionDensity emission_density(const Light&, const Vec3&, Float distance)
    {
        return {Float(0.25f * inv_pi) / (distance * distance), Float(0.25f * inv_pi)};
    }

    template <class Moving>
    static void place(Moving& light, const LightPlace& at, Mask m)
    {
        light.set(&Record::position, at.to_render.shift, m);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
