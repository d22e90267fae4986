// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/kind.h"
#include "math/elementary.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// The outside of a cylinder without ends, which rays do not hit.
///
/// Directions are sampled in cylinder coordinates about the line through the shading point that is parallel to the
/// axis: by the angle about that line, and by the sine of the elevation above the plane through the point across the
/// line. Solid angle is the product of both (Archimedes). The angle is uniform over the silhouette; the sine is uniform
/// between both ends of the line on the surface at this angle. The density thus varies only with the distance of that
/// line, and the estimate of irradiance has no singularity close to the tube.
struct TubeLight {
    using Record = TubeLightRecord;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2 random, Mask)
    {
        const Axis axis = axis_from(light, p);
        const Float radius = light.get(&Record::radius);
        const Mask outside = axis.distance > radius;
        // No light arrives inside the cylinder; a distance outside keeps numbers finite there.
        const Float rho = select(outside, axis.distance, Float(2) * radius), tangent2 = (rho - radius) * (rho + radius);
        const Float limit = atan2(radius, sqrt(tangent2)), angle = fma(random.x, Float(2), Float(-1)) * limit;
        const SinCos turn = sincos_2pi(angle * Float(0.5f * inv_pi));
        // Distance of the nearer intersection with the circle, without cancellation close to it.
        const Float sine = rho * turn.sin, root = sqrt(max(fma(radius, radius, -(sine * sine)), Float(0)));
        const Elevations range(tangent2 / fma(rho, turn.cos, root), axis.along, axis.half_length);
        const Float z = range.sample(random.y), h = range.height;
        const Vec3 to = fma(axis.x, turn.cos * h, fma(cross(axis.e, axis.x), turn.sin * h, axis.e * z));
        const Float distance2 = dot(to, to), inverse = inverse_sqrt(max(distance2, Float(1e-37f)));
        return {to * inverse, distance2 * inverse, select(outside, Float(2) * limit * range.size, Float(0)), Float(1),
                Float(1),     Mask(true)};
    }

    /// Density of sample(), outside the tube; 0 inside.
    template <class Light>
    static Float sample_pdf(const Light& light, const Vec3& p, const Vec3& wi)
    {
        const Axis axis = axis_from(light, p);
        const Float radius = light.get(&Record::radius), rho = axis.distance,
                    tangent2 = (rho - radius) * (rho + radius);
        const Vec3 across = fma(axis.e, -dot(wi, axis.e), wi);
        const Float cosine = dot(across, axis.x) * inverse_sqrt(max(dot(across, across), Float(1e-37f)));
        const Float root2 = fma(rho * rho, fma(cosine, cosine, Float(-1)), radius * radius);
        const Float limit = atan2(radius, sqrt(max(tangent2, Float(0))));
        const Elevations range(tangent2 / fma(rho, cosine, sqrt(max(root2, Float(0)))), axis.along, axis.half_length);
        return select(rho > radius, Float(0.5f) / max(limit * range.size, Float(1e-30f)), Float(0));
    }

    template <class Light>
    static EmittedRay emit(const Light& light, Float, Sample2 position, Sample2 direction)
    {
        const Vec3 half = light.get(&Record::half_axis);
        const Frame frame(unit_or_zero(half));
        const SinCos turn = sincos_2pi(position.x);
        const Vec3 n = fma(frame.s, turn.cos, frame.t * turn.sin);
        const Vec3 on_axis = fma(half, fma(position.y, Float(2), Float(-1)), light.get(&Record::center));
        return emit_from_surface(fma(n, light.get(&Record::radius), on_axis), n, area(light), Mask(false), direction);
    }
    template <class Light>
    static void aim(const Light&, EmittedRay& ray, const Vec3& d)
    {
        aim_from_surface(ray, d, Mask(false));
    }
    template <class Light>
    static EmissionDensity emission_density(const Light& light, const Vec3&, Float)
    {
        return surface_emission_density(area(light), Mask(false), Float(mean_cosine));
    }

    template <class Moving>
    static void place(Moving& light, const LightPlace& at, Mask m)
    {
        const Vec3 half = light.get(&Record::half_axis), now = at.to_render.vector(half);
        // Change of areas across the axis: the determinant without the change of lengths along it.
        const Float across2 =
            abs(at.to_render.determinant()) * sqrt(dot(half, half) / max(dot(now, now), Float(1e-37f)));
        light.set(&Record::center, at.to_render.shift, m);
        light.set(&Record::half_axis, now, m);
        light.set(&Record::radius, light.get(&Record::radius) * sqrt(across2), m);
    }

private:
    template <class Light>
    static Float area(const Light& light)
    {
        const Vec3 half = light.get(&Record::half_axis);
        return light.get(&Record::radius) * sqrt(dot(half, half)) * Float(4 * pi);
    }

    /// The axis of the tube as seen from a point.
    struct Axis {
        Vec3 e;       ///< unit vector along the axis, towards the half that contains the center
        Vec3 x;       ///< unit vector from the point towards the axis, perpendicular to it
        Float along;  ///< position of the center along e, not negative
        Float half_length;
        Float distance;  ///< distance of the point from the axis
    };
    template <class Light>
    static Axis axis_from(const Light& light, const Vec3& p)
    {
        const Vec3 half = light.get(&Record::half_axis), to_center = light.get(&Record::center) - p;
        const Float length2 = dot(half, half), inverse = inverse_sqrt(max(length2, Float(1e-37f)));
        Axis a;
        const Float along = dot(to_center, half) * inverse;
        a.e = half * flip_sign(inverse, along);
        a.along = abs(along);
        a.half_length = length2 * inverse;
        const Vec3 across = to_center - a.e * a.along;
        const Float rho2 = dot(across, across), inverse_rho = inverse_sqrt(max(rho2, Float(1e-37f)));
        a.x = across * inverse_rho;
        a.distance = rho2 * inverse_rho;
        return a;
    }

    /// Elevations of a line from z0 to z1, at a distance of `height`, z0 + z1 >= 0. They are kept as 1 - sine, which is
    /// accurate where the line is far ahead.
    struct Elevations {
        Float height, z0, z1;
        Float first;  ///< 1 - sine at z0
        Float size;   ///< difference of the sines at z1 and z0

        Elevations(Float h, Float along, Float half_length)
            : height(h), z0(along - half_length), z1(along + half_length)
        {
            const Float h2 = h * h, d0 = sqrt(fma(z0, z0, h2)), d1 = sqrt(fma(z1, z1, h2));
            const Mask ahead = z0 > Float(0);
            first = select(ahead, h2 / (d0 * (d0 + z0)), Float(1) - z0 / d0);
            // This avoids the cancellation of z1 / d1 - z0 / d0 if both terms are positive.
            const Float difference = h2 * Float(4) * along * half_length / (d0 * d1 * fma(z1, d0, z0 * d1));
            size = select(ahead, difference, z1 / d1 - z0 / d0);
        }
        /// Returns the sampled position along the line.
        Float sample(Float random) const
        {
            const Float c = fma(random, -size, first), cosine2 = c * (Float(2) - c);
            return clamp(height * (Float(1) - c) * inverse_sqrt(max(cosine2, Float(1e-37f))), z0, z1);
        }
    };
};

}  // namespace FATHOM_LANES
}  // namespace fathom
