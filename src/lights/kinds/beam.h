// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/kind.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Parallel light from a flat area, along its normal.
struct BeamLight {
    using Record = BeamLightRecord;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2, Mask)
    {
        const Vec3 u = light.get(&Record::half_u), v = light.get(&Record::half_v), n = light.get(&Record::axis),
                   from = p - light.get(&Record::center);
        // The point is lit if its projection onto the area's plane, x u + y v from the center, is inside the area.
        const Vec3 across_v = cross(v, n), across_u = cross(n, u);
        const Float x = dot(from, across_v) / dot(u, across_v), y = dot(from, across_u) / dot(v, across_u);
        const Mask in_ellipse = fma(x, x, y * y) <= Float(1), in_parallelogram = max(abs(x), abs(y)) <= Float(1);
        const Mask is_round = light.get(&Record::is_round) > Float(0);
        const Float distance = dot(from, n);
        const Mask arrives = (distance > Float(0)) & ((is_round & in_ellipse) | (!is_round & in_parallelogram));
        return {-n, max(distance, Float(0)), select(arrives, Float(1), Float(0)), Float(1), Float(1), Mask(true)};
    }

    template <class Light>
    static EmittedRay emit(const Light& light, Float, Sample2 position, Sample2)
    {
        const Mask is_round = light.get(&Record::is_round) > Float(0);
        const DiskPoint disk = sample_disk(position);
        const Float x = select(is_round, disk.x, fma(position.x, Float(2), Float(-1))),
                    y = select(is_round, disk.y, fma(position.y, Float(2), Float(-1)));
        const Vec3 u = light.get(&Record::half_u), v = light.get(&Record::half_v);
        return {fma(u, x, fma(v, y, light.get(&Record::center))), light.get(&Record::axis),
                Vec3(Float(0), Float(0), Float(0)), area(light), Float(0)};
    }
    template <class Light>
    static Float sample_pdf(const Light&, const Vec3&, const Vec3&)
    {
        return Float(1);
    }
    template <class Light>
    static EmissionDensity emission_density(const Light& light, const Vec3&, Float)
    {
        return {Float(1) / max(area(light), Float(1e-30f)), Float(0)};
    }

    /// The node may stretch and mirror the area.
    template <class Moving>
    static void place(Moving& light, const LightPlace& at, Mask m)
    {
        const Vec3 u = at.to_render.vector(light.get(&Record::half_u)),
                   v = at.to_render.vector(light.get(&Record::half_v)), n = cross(u, v);
        const Vec3 forwards = at.to_render.vector(light.get(&Record::axis));
        light.set(&Record::center, at.to_render.shift, m);
        light.set(&Record::half_u, u, m);
        light.set(&Record::half_v, v, m);
        light.set(&Record::axis, flip_sign(unit_or_zero(n), dot(n, forwards)), m);
    }

private:
    template <class Light>
    static Float area(const Light& light)
    {
        const Vec3 n = cross(light.get(&Record::half_u), light.get(&Record::half_v));
        return sqrt(dot(n, n)) * select(light.get(&Record::is_round) > Float(0), Float(pi), Float(4));
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
