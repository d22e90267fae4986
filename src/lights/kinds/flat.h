// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/kind.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

/// Base of lights that are spanned by two edges. `parts` of them fill the parallelogram.
template <class Own, int parts>
struct EdgesLight {
    using Record = Own;

    template <class Moving>
    static void place(Moving& light, const LightPlace& at, Mask m)
    {
        const Vec3 u = at.to_render.vector(light.get(&Record::edge_u)),
                   v = at.to_render.vector(light.get(&Record::edge_v)), n = cross(u, v);
        light.set(&Record::corner, at.to_render.point(light.get(&Record::corner)), m);
        light.set(&Record::edge_u, u, m);
        light.set(&Record::edge_v, v, m);
        light.set(&FlatLightRecord::area, sqrt(dot(n, n)) * Float(1.0f / parts), m);
        place_normal(light, at, m);
    }
};

}  // namespace detail

/// Parallelogram, sampled uniformly by area.
struct ParallelogramLight : detail::EdgesLight<ParallelogramLightRecord, 1> {
    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2 random, Mask)
    {
        const Vec3 q = fma(light.get(&Record::edge_u), random.x,
                           fma(light.get(&Record::edge_v), random.y, light.get(&Record::corner)));
        return detail::FlatLightPoint(q - p, light);
    }
};

/// Triangle, sampled uniformly by area.
struct TriangleLight : detail::EdgesLight<TriangleLightRecord, 2> {
    /// Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2 random, Mask)
    {
        const Mask upper = random.y > random.x;
        const Float half = Float(0.5f) * select(upper, random.x, random.y);
        const Float u = select(upper, half, random.x - half), v = select(upper, random.y - half, half);
        const Vec3 q =
            fma(light.get(&Record::edge_u), u, fma(light.get(&Record::edge_v), v, light.get(&Record::corner)));
        return detail::FlatLightPoint(q - p, light);
    }
};

/// Disk, sampled uniformly by area.
struct DiskLight {
    using Record = DiskLightRecord;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2 random, Mask)
    {
        const DiskPoint d = sample_disk(random);
        const Frame frame(light.get(&FlatLightRecord::normal));
        const Float radius = light.get(&Record::radius);
        const Vec3 q = fma(frame.s, d.x * radius, fma(frame.t, d.y * radius, light.get(&Record::center)));
        return detail::FlatLightPoint(q - p, light);
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
