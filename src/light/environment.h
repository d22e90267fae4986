#pragma once
/// Radiance from outside the scene, by direction, and sampling of it where it is an image.
#include "fathom/description.h"
#include "light/light.h"
#include "light/records.h"
#include "sampling/inversion.h"
#include "shading/textures/image.h"

namespace fathom::inline FATHOM_LANES {

namespace detail {

inline Vec3 rotate_in(const EnvironmentRecord& e, Vec3 d)
{
    const auto& m = e.environment_from_render;
    const auto row = [&](std::size_t i) {
        return fma(d.x, Float(m[i]), fma(d.y, Float(m[i + 1]), d.z * Float(m[i + 2])));
    };
    return {row(0), row(3), row(6)};
}
/// By the transpose: the map is a rotation.
inline Vec3 rotate_out(const EnvironmentRecord& e, Vec3 d)
{
    const auto& m = e.environment_from_render;
    const auto column = [&](std::size_t i) {
        return fma(d.x, Float(m[i]), fma(d.y, Float(m[i + 3]), d.z * Float(m[i + 6])));
    };
    return {column(0), column(1), column(2)};
}

struct ImagePoint {
    Float u, v;  ///< in [0, 1], v downwards
};
/// The image's middle looks along +x, its top along +y; u grows to the right as seen from inside: towards +z.
inline ImagePoint image_point(Vec3 d)
{
    return {fma(atan2(d.z, d.x), Float(0.5f * inv_pi), Float(0.5f)),
            acos(clamp(d.y, Float(-1), Float(1))) * Float(inv_pi)};
}

}  // namespace detail

inline Spectrum environment_radiance(const LightTables& tables, Vec3 direction, Mask m)
{
    const EnvironmentRecord& e = tables.environment;
    Spectrum radiance;
    switch (EnvironmentKind(e.kind)) {
        case EnvironmentKind::none:
            return Spectrum(Float(0));
        case EnvironmentKind::constant:
            return Spectrum(e.color);
        case EnvironmentKind::gradient: {
            const Float t = fma(detail::rotate_in(e, direction).y, Float(0.5f), Float(0.5f));
            for (std::size_t i = 0; i < channels; ++i)
                radiance.c[i] = fma(t, Float(e.top[i] - e.bottom[i]), Float(e.bottom[i]));
            return radiance;
        }
        default:
            break;  // compiled to a picture
    }
    const detail::ImagePoint at = detail::image_point(detail::rotate_in(e, direction));
    TextureRecord image;
    image.width = e.width;
    image.height = e.height;
    image.wrap_u = std::uint32_t(Wrap::repeat);
    image.wrap_v = std::uint32_t(Wrap::clamp);
    const Texel t = lookup_image(e.texels.data(), image, at.u, at.v, m);
    for (std::size_t i = 0; i < channels; ++i) radiance.c[i] = t.c[i] * Float(e.color[i]);
    return radiance;
}

/// Density per solid angle with which sample_environment gives the direction; 0 if the environment is not sampled.
inline Float environment_pdf(const LightTables& tables, Vec3 direction)
{
    const EnvironmentRecord& e = tables.environment;
    if (e.light == no_index || EnvironmentKind(e.kind) != EnvironmentKind::image) return Float(0);
    const Vec3 d = detail::rotate_in(e, direction);
    const detail::ImagePoint at = detail::image_point(d);
    const UInt x = to_uint(clamp(at.u * Float(float(e.width)), Float(0), Float(float(e.width - 1))));
    const UInt y = to_uint(clamp(at.v * Float(float(e.height)), Float(0), Float(float(e.height - 1))));
    const UInt cell = y * UInt(std::uint32_t(e.width + 1)) + x;
    const Float row = gather(e.marginal.data() + 1, y) - gather(e.marginal.data(), y);
    const Float column = gather(e.conditional.data() + 1, cell) - gather(e.conditional.data(), cell);
    const Float sine = sqrt(max(fma(-d.y, d.y, Float(1)), Float(1e-12f)));
    // Density in (u, v), over the solid angle 2 pi^2 sin(theta) du dv.
    return row * column * Float(float(e.width) * float(e.height) * 0.5f * inv_pi * inv_pi) / sine;
}

struct EnvironmentSample {
    Vec3 wi;
    Float inverse_pdf;
    Spectrum radiance;
};

inline EnvironmentSample sample_environment(const LightTables& tables, Sample2 random, Mask m)
{
    const EnvironmentRecord& e = tables.environment;
    const auto within = [](const float* table, UInt at, Float x) {
        const Float lo = gather(table, at), hi = gather(table + 1, at);
        return clamp((x - lo) / max(hi - lo, Float(1e-20f)), Float(0), Float(0.9999999f));
    };
    const UInt y = find_interval(e.marginal.data(), UInt(0u), e.height, random.y);
    const Float v = (to_float(y) + within(e.marginal.data(), y, random.y)) * Float(1.0f / float(e.height));
    const UInt first = y * UInt(std::uint32_t(e.width + 1));
    const UInt x = find_interval(e.conditional.data(), first, e.width, random.x);
    const Float u = (to_float(x) + within(e.conditional.data(), first + x, random.x)) * Float(1.0f / float(e.width));
    const SinCos theta = sincos_2pi(v * Float(0.5f)), phi = sincos_2pi(u - Float(0.5f));
    const Vec3 d{theta.sin * phi.cos, theta.cos, theta.sin * phi.sin};
    EnvironmentSample s;
    s.wi = detail::rotate_out(e, d);
    const Float pdf = environment_pdf(tables, s.wi);
    s.inverse_pdf = select(pdf > Float(0), Float(1) / max(pdf, Float(1e-30f)), Float(0));
    s.radiance = environment_radiance(tables, s.wi, m);
    return s;
}

}  // namespace fathom::inline FATHOM_LANES
