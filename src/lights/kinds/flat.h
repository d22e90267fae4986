// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/kind.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

/// Transforms a light that is spanned by two edges. share: its area relative to that of the parallelogram.
template <class Record, class Moving>
void place_edges(Moving& light, const LightPlace& at, Float share, Mask m)
{
    const Vec3 u = at.to_render.vector(light.get(&Record::edge_u)), v = at.to_render.vector(light.get(&Record::edge_v)),
               n = cross(u, v);
    light.set(&Record::corner, at.to_render.point(light.get(&Record::corner)), m);
    light.set(&Record::edge_u, u, m);
    light.set(&Record::edge_v, v, m);
    light.set(&FlatLightRecord::area, sqrt(dot(n, n)) * share, m);
    place_normal(light, at, m);
}

}  // namespace detail

/// Parallelogram light, sampled uniformly by area.
struct ParallelogramLight {
    using Record = ParallelogramLightRecord;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2 random, Mask)
    {
        return detail::FlatLightPoint(point(light, random) - p, light);
    }

    template <class Light>
    static EmittedRay emit(const Light& light, Float, Sample2 position, Sample2 direction)
    {
        return detail::emit_from_flat(light, point(light, position), direction);
    }
    template <class Light>
    static Float emission_density(const Light& light, const Vec3&, Float)
    {
        return detail::flat_emission_density(light);
    }

    template <class Moving>
    static void place(Moving& light, const LightPlace& at, Mask m)
    {
        detail::place_edges<Record>(light, at, Float(1), m);
    }

private:
    template <class Light>
    static Vec3 point(const Light& light, Sample2 random)
    {
        return fma(light.get(&Record::edge_u), random.x,
                   fma(light.get(&Record::edge_v), random.y, light.get(&Record::corner)));
    }
};

/// Triangle light, sampled uniformly by area.
struct TriangleLight {
    using Record = TriangleLightRecord;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2 random, Mask)
    {
        return detail::FlatLightPoint(point(light, random) - p, light);
    }

    template <class Light>
    static EmittedRay emit(const Light& light, Float, Sample2 position, Sample2 direction)
    {
        return detail::emit_from_flat(light, point(light, position), direction);
    }
    template <class Light>
    static Float emission_density(const Light& light, const Vec3&, Float)
    {
        return detail::flat_emission_density(light);
    }

    template <class Moving>
    static void place(Moving& light, const LightPlace& at, Mask m)
    {
        detail::place_edges<Record>(light, at, Float(0.5f), m);
    }

private:
    /// Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
    template <class Light>
    static Vec3 point(const Light& light, Sample2 random)
    {
        const Mask upper = random.y > random.x;
        const Float half = Float(0.5f) * select(upper, random.x, random.y);
        const Float u = select(upper, half, random.x - half), v = select(upper, random.y - half, half);
        return fma(light.get(&Record::edge_u), u, fma(light.get(&Record::edge_v), v, light.get(&Record::corner)));
    }
};

/// Disk light, sampled uniformly by area.
struct DiskLight {
    using Record = DiskLightRecord;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2 random, Mask)
    {
        return detail::FlatLightPoint(point(light, random) - p, light);
    }

    template <class Light>
    static EmittedRay emit(const Light& light, Float, Sample2 position, Sample2 direction)
    {
        return detail::emit_from_flat(light, point(light, position), direction);
    }
    template <class Light>
    static Float emission_density(const Light& light, const Vec3&, Float)
    {
        return detail::flat_emission_density(light);
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

private:
    template <class Light>
    static Vec3 point(const Light& light, Sample2 random)
    {
        const DiskPoint d = sample_disk(random);
        const Frame frame(light.get(&FlatLightRecord::normal));
        const Float radius = light.get(&Record::radius);
        return fma(frame.s, d.x * radius, fma(frame.t, d.y * radius, light.get(&Record::center)));
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
