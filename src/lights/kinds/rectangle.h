// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/kind.h"
#include "lights/kinds/spherical_rectangle.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Rectangles that subtend a smaller solid angle are sampled by area: they are nearly flat as seen from the point, and
/// float angles would be too coarse.
inline constexpr float min_solid_angle = 1e-3f;

/// Lanes closer to a rectangle than the length of its diagonal. From farther away, sampling by area is about as good as
/// by solid angle, at a third of the cost (docs/performance.md).
template <class Light>
Mask is_rectangle_close(const Light& light, Vec3 p)
{
    const Vec3 to_center = light.get(&RectangleLightRecord::center) - p;
    const Float diagonal = light.get(&RectangleLightRecord::diagonal);
    return dot(to_center, to_center) < diagonal * diagonal;
}

namespace detail {

/// Samples by solid angle in the lanes of `large`, by area in the others; the result is valid in all lanes.
template <class Light>
[[gnu::noinline]] FlatLightPoint sample_large_rectangle(const Light& light, Vec3 corner, Sample2 random, Mask large)
{
    using Record = RectangleLightRecord;
    const Vec3 u = light.get(&Record::u), v = light.get(&Record::v), n = light.get(&FlatLightRecord::normal);
    const Float length_u = light.get(&Record::length_u), length_v = light.get(&Record::length_v);
    const SphericalRectangle seen(corner, u, v, n, length_u, length_v);
    const SphericalRectangle::Point point = seen.sample(random);
    const Mask by_solid_angle = large & (seen.solid_angle >= Float(min_solid_angle));
    const Float du = select(by_solid_angle, point.x - seen.x0, random.x * length_u);
    const Float dv = select(by_solid_angle, point.y - seen.y0, random.y * length_v);
    FlatLightPoint s(fma(u, du, fma(v, dv, corner)), n, light.get(&FlatLightRecord::area));
    s.inverse_pdf = select(by_solid_angle, seen.solid_angle, s.inverse_pdf);
    return s;
}

}  // namespace detail

/// Rectangle light, sampled by solid angle if it is close, else by area.
struct RectangleLight {
    using Record = RectangleLightRecord;

    template <class Light>
    [[gnu::always_inline]] static detail::FlatLightPoint sample(const Light& light, Vec3 p, Float, Sample2 random,
                                                                Mask active)
    {
        const Vec3 n = light.get(&FlatLightRecord::normal);
        const Vec3 corner = light.get(&Record::corner) - p;
        // Points behind a one-sided light receive nothing, so any sample is good enough there.
        const Mask large =
            active & is_rectangle_close(light, p) & (light.has(LightRecord::two_sided) | (dot(corner, n) < Float(0)));
        if (any(large)) return detail::sample_large_rectangle(light, corner, random, large);
        const Float du = random.x * light.get(&Record::length_u), dv = random.y * light.get(&Record::length_v);
        const Vec3 to = fma(light.get(&Record::u), du, fma(light.get(&Record::v), dv, corner));
        return detail::FlatLightPoint(to, n, light.get(&FlatLightRecord::area));
    }
    template <class Light>
    static EmittedRay emit(const Light& light, Float, Sample2 position, Sample2 direction)
    {
        const Float du = position.x * light.get(&Record::length_u), dv = position.y * light.get(&Record::length_v);
        const Vec3 p = fma(light.get(&Record::u), du, fma(light.get(&Record::v), dv, light.get(&Record::corner)));
        return detail::emit_from_flat(light, p, direction);
    }
    template <class Light>
    static void aim(const Light& light, EmittedRay& ray, const Vec3& d)
    {
        detail::aim_from_flat(light, ray, d);
    }
    template <class Light>
    static EmissionDensity emission_density(const Light& light, const Vec3& wi, Float)
    {
        return detail::flat_emission_density(light, wi);
    }

    template <class Light>
    static Mask by_solid_angle(const Light& light, Vec3 p)
    {
        return is_rectangle_close(light, p);
    }
    template <class Light>
    static Float pdf(const Light& light, Vec3 p, Float, Float by_area)
    {
        const SphericalRectangle seen(light.get(&Record::corner) - p, light.get(&Record::u), light.get(&Record::v),
                                      light.get(&FlatLightRecord::normal), light.get(&Record::length_u),
                                      light.get(&Record::length_v));
        return select(seen.solid_angle >= Float(min_solid_angle), reciprocal(seen.solid_angle), by_area);
    }

    template <class Moving>
    static void place(Moving& light, const LightPlace& at, Mask m)
    {
        const Vec3 u = at.to_render.vector(light.get(&Record::u) * light.get(&Record::length_u)),
                   v = at.to_render.vector(light.get(&Record::v) * light.get(&Record::length_v)), n = cross(u, v);
        const Vec3 corner = at.to_render.point(light.get(&Record::corner)), diagonal = u + v;
        const Float length_u = sqrt(dot(u, u)), length_v = sqrt(dot(v, v));
        light.set(&Record::corner, corner, m);
        light.set(&Record::u, u * (Float(1) / length_u), m);
        light.set(&Record::v, v * (Float(1) / length_v), m);
        light.set(&Record::length_u, length_u, m);
        light.set(&Record::length_v, length_v, m);
        light.set(&Record::center, fma(diagonal, Float(0.5f), corner), m);
        light.set(&Record::diagonal, sqrt(dot(diagonal, diagonal)), m);
        light.set(&FlatLightRecord::area, sqrt(dot(n, n)), m);
        detail::place_normal(light, at, m);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
