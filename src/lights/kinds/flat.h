// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/kind.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Parallelogram, sampled uniformly by area.
struct ParallelogramLight {
    static constexpr LightRecordKind kind = LightRecordKind::parallelogram;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2 random, Mask)
    {
        const Vec3 q = fma(light.edge_u(), random.x, fma(light.edge_v(), random.y, light.position()));
        return detail::FlatLightPoint(q - p, light.normal(), light.area());
    }
};

/// Triangle, sampled uniformly by area.
struct TriangleLight {
    static constexpr LightRecordKind kind = LightRecordKind::triangle;

    /// Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2 random, Mask)
    {
        const Mask upper = random.y > random.x;
        const Float half = Float(0.5f) * select(upper, random.x, random.y);
        const Float u = select(upper, half, random.x - half), v = select(upper, random.y - half, half);
        const Vec3 q = fma(light.edge_u(), u, fma(light.edge_v(), v, light.position()));
        return detail::FlatLightPoint(q - p, light.normal(), light.area());
    }
};

/// Disk, sampled uniformly by area.
struct DiskLight {
    static constexpr LightRecordKind kind = LightRecordKind::disk;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2 random, Mask)
    {
        const DiskPoint d = sample_disk(random);
        const Frame frame(light.normal());
        const Vec3 q = fma(frame.s, d.x * light.radius(), fma(frame.t, d.y * light.radius(), light.position()));
        return detail::FlatLightPoint(q - p, light.normal(), light.area());
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
