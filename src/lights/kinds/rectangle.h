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
    const Vec3 to_center = light.center() - p;
    return dot(to_center, to_center) < light.radius() * light.radius();
}

namespace detail {

/// Samples by solid angle in the lanes of `large`, by area in the others; the result is valid in all lanes.
template <class Light>
[[gnu::noinline]] FlatLightPoint sample_large_rectangle(const Light& light, Vec3 corner, Sample2 random, Mask large)
{
    const Vec3 u = light.edge_u(), v = light.edge_v(), n = light.normal();
    const Float length_u = light.length_u(), length_v = light.length_v();
    const SphericalRectangle seen(corner, u, v, n, length_u, length_v);
    const SphericalRectangle::Point point = seen.sample(random);
    const Mask by_solid_angle = large & (seen.solid_angle >= Float(min_solid_angle));
    const Float du = select(by_solid_angle, point.x - seen.x0, random.x * length_u);
    const Float dv = select(by_solid_angle, point.y - seen.y0, random.y * length_v);
    FlatLightPoint s(fma(u, du, fma(v, dv, corner)), n, light.area());
    s.inverse_pdf = select(by_solid_angle, seen.solid_angle, s.inverse_pdf);
    return s;
}

}  // namespace detail

/// Rectangle, sampled by solid angle where it is close, else by area.
struct RectangleLight {
    static constexpr LightRecordKind kind = LightRecordKind::rectangle;

    template <class Light>
    [[gnu::always_inline]] static detail::FlatLightPoint sample(const Light& light, Vec3 p, Float, Sample2 random,
                                                                Mask active)
    {
        const Vec3 n = light.normal();
        const Vec3 corner = light.position() - p;
        // Points behind a one-sided light need no good sample.
        const Mask large =
            active & is_rectangle_close(light, p) & (light.has(LightRecord::two_sided) | (dot(corner, n) < Float(0)));
        if (any(large)) return detail::sample_large_rectangle(light, corner, random, large);
        const Vec3 to =
            fma(light.edge_u(), random.x * light.length_u(), fma(light.edge_v(), random.y * light.length_v(), corner));
        return detail::FlatLightPoint(to, n, light.area());
    }
    template <class Light>
    static Mask by_solid_angle(const Light& light, Vec3 p)
    {
        return is_rectangle_close(light, p);
    }
    template <class Light>
    static Float pdf(const Light& light, Vec3 p, Float, Float by_area)
    {
        const SphericalRectangle seen(light.position() - p, light.edge_u(), light.edge_v(), light.normal(),
                                      light.length_u(), light.length_v());
        return select(seen.solid_angle >= Float(min_solid_angle), reciprocal(seen.solid_angle), by_area);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
