// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/kind.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

/// Base of flat lights that are sampled uniformly by area. Points::at(light, random): a point of the light.
template <class Own, class Points>
struct FlatLight {
    using Record = Own;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2 random, Mask)
    {
        return FlatLightPoint(Points::at(light, random) - p, light);
    }
    template <class Light>
    static EmittedRay emit(const Light& light, Float, Sample2 position, Sample2 direction)
    {
        return emit_from_flat(light, Points::at(light, position), direction);
    }
    template <class Light>
    static void aim(const Light& light, EmittedRay& ray, const Vec3& d)
    {
        aim_from_flat(light, ray, d);
    }
    template <class Light>
    static EmissionDensity emission_density(const Light& light, const Vec3& wi, Float)
    {
        return flat_emission_density(light, wi);
    }
};

/// Base of flat lights that are spanned by two edges. `parts` of them fill the parallelogram.
template <class Own, class Points, int parts>
struct EdgesLight : FlatLight<Own, Points> {
    template <class Moving>
    static void place(Moving& light, const LightPlace& at, Mask m)
    {
        const Vec3 u = at.to_render.vector(light.get(&Own::edge_u)), v = at.to_render.vector(light.get(&Own::edge_v)),
                   n = cross(u, v);
        light.set(&Own::corner, at.to_render.point(light.get(&Own::corner)), m);
        light.set(&Own::edge_u, u, m);
        light.set(&Own::edge_v, v, m);
        light.set(&FlatLightRecord::area, sqrt(dot(n, n)) * Float(1.0f / parts), m);
        place_normal(light, at, m);
    }
    template <class Light>
    static Vec3 point(const Light& light, Float u, Float v)
    {
        return fma(light.get(&Own::edge_u), u, fma(light.get(&Own::edge_v), v, light.get(&Own::corner)));
    }
};

}  // namespace detail

/// Parallelogram light, sampled uniformly by area.
struct ParallelogramLight : detail::EdgesLight<ParallelogramLightRecord, ParallelogramLight, 1> {
    template <class Light>
    static Vec3 at(const Light& light, Sample2 random)
    {
        return point(light, random.x, random.y);
    }
};

/// Triangle light, sampled uniformly by area.
struct TriangleLight : detail::EdgesLight<TriangleLightRecord, TriangleLight, 2> {
    /// The map from the square is that of Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
    template <class Light>
    static Vec3 at(const Light& light, Sample2 random)
    {
        const Mask upper = random.y > random.x;
        const Float half = Float(0.5f) * select(upper, random.x, random.y);
        const Float u = select(upper, half, random.x - half), v = select(upper, random.y - half, half);
        return point(light, u, v);
    }
};

/// Disk light, sampled uniformly by area.
struct DiskLight : detail::FlatLight<DiskLightRecord, DiskLight> {
    template <class Light>
    static Vec3 at(const Light& light, Sample2 random)
    {
        const DiskPoint d = sample_disk(random);
        const Frame frame(light.get(&FlatLightRecord::normal));
        const Float radius = light.get(&Record::radius);
        return fma(frame.s, d.x * radius, fma(frame.t, d.y * radius, light.get(&Record::center)));
    }

    /// Disks are lights only under similarities, which keep their shape.
    template <class Moving>
    static void place(Moving& light, const LightPlace& at, Mask m)
    {
        const Vec3 x{at.to_render.row[0].x, at.to_render.row[1].x, at.to_render.row[2].x};
        const Float factor2 = dot(x, x);
        light.set(&Record::center, at.to_render.point(light.get(&Record::center)), m);
        light.set(&Record::radius, light.get(&Record::radius) * sqrt(factor2), m);
        light.set(&FlatLightRecord::area, light.get(&FlatLightRecord::area) * factor2, m);
        detail::place_normal(light, at, m);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
