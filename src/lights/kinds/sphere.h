// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/kind.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// 1 - cos of the half angle that a sphere subtends, from sin^2 = r^2 / d^2 without cancellation for small spheres.
inline Float one_minus_cos_of(Float sin2)
{
    return sin2 / (Float(1) + sqrt(max(Float(1) - sin2, Float(0))));
}

/// Sphere light, sampled by the solid angle of the cone that it subtends; from inside, uniformly over all directions.
struct SphereLight {
    using Record = SphereLightRecord;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float time, Sample2 random, Mask)
    {
        const Vec3 to_center = fma(light.get(&Record::velocity), time, light.get(&Record::center)) - p;
        const Float radius = light.get(&Record::radius), r = abs(radius), sin2 = r * r / dot(to_center, to_center);
        const Mask outside = sin2 < Float(1);
        const Float spread = cone(sin2);
        const Vec3 wi = Frame(normalize(to_center)).to_world(sample_cone(random, spread));
        // Distance to the sphere along wi.
        const Float b = dot(to_center, wi);
        const Vec3 foot = to_center - wi * b;
        const Float root = sqrt(max(fma(r, r, -dot(foot, foot)), Float(0)));
        // The normal points outwards if the radius is positive, so that seen from outside it faces the shading point.
        const Float side = select(outside, Float(1), Float(-1));
        return {
            wi,         select(outside, b - root, b + root), Float(2 * pi) * spread, flip_sign(side, radius), Float(1),
            Mask(false)};
    }
    template <class Light>
    static EmittedRay emit(const Light& light, Float time, Sample2 position, Sample2 direction)
    {
        const Vec3 outwards = sample_sphere(position);
        const Float radius = light.get(&Record::radius);
        const Vec3 center = fma(light.get(&Record::velocity), time, light.get(&Record::center));
        return emit_from_surface(fma(outwards, abs(radius), center), flip_sign(outwards, radius), area(radius),
                                 light.has(LightRecord::two_sided), direction);
    }
    template <class Light>
    static void aim(const Light& light, EmittedRay& ray, const Vec3& d)
    {
        aim_from_surface(ray, d, light.has(LightRecord::two_sided));
    }
    template <class Light>
    static EmissionDensity emission_density(const Light& light, const Vec3&, Float)
    {
        return surface_emission_density(area(light.get(&Record::radius)), light.has(LightRecord::two_sided),
                                        Float(mean_cosine));
    }
    template <class Light>
    static Mask by_solid_angle(const Light&, Vec3)
    {
        return Mask(true);
    }
    template <class Light>
    static Float pdf(const Light& light, Vec3 p, Float time, Float)
    {
        const Vec3 to_center = fma(light.get(&Record::velocity), time, light.get(&Record::center)) - p;
        const Float r = light.get(&Record::radius);
        return Float(0.5f * inv_pi) / cone(r * r / dot(to_center, to_center));
    }

    /// Spheres are lights only under similarities, which keep their shape.
    template <class Moving>
    static void place(Moving& light, const LightPlace& at, Mask m)
    {
        const Vec3 x{at.to_render.row[0].x, at.to_render.row[1].x, at.to_render.row[2].x};
        const Vec3 now = fma(light.get(&Record::velocity), at.time, light.get(&Record::center));
        light.set(&Record::center, at.to_render.point(now), m);
        light.set(&Record::radius, light.get(&Record::radius) * sqrt(dot(x, x)), m);
        light.set(&Record::velocity, Vec3(Float(0), Float(0), Float(0)), m);
    }

private:
    static Float area(Float radius) { return radius * radius * Float(4 * pi); }
    /// 1 - cos of the half angle of the sampled cone.
    static Float cone(Float sin2) { return select(sin2 < Float(1), one_minus_cos_of(min(sin2, Float(1))), Float(2)); }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
