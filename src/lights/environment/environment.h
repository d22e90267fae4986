// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Radiance of the environment by direction, and importance sampling of environment images.
#include "fathom/description.h"
#include "lights/light.h"
#include "lights/records.h"
#include "sampling/inversion.h"
#include "textures/image.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

/// Rotates a direction from render space to the environment's axes.
inline Vec3 rotate_in(const EnvironmentRecord& e, Vec3 d)
{
    const auto& m = e.environment_from_render;
    const auto row = [&](std::size_t i) {
        return fma(d.x, Float(m[i]), fma(d.y, Float(m[i + 1]), d.z * Float(m[i + 2])));
    };
    return {row(0), row(3), row(6)};
}
/// Inverse of rotate_in: the transpose, since the map is a rotation.
inline Vec3 rotate_out(const EnvironmentRecord& e, Vec3 d)
{
    const auto& m = e.environment_from_render;
    const auto column = [&](std::size_t i) {
        return fma(d.x, Float(m[i]), fma(d.y, Float(m[i + 3]), d.z * Float(m[i + 6])));
    };
    return {column(0), column(1), column(2)};
}

/// A point of an equirectangular image.
struct ImagePoint {
    Float u, v;  ///< coordinates in [0, 1]; v grows downwards
};
/// The image's center is +x, its top +y; u grows to the right as seen from inside, towards +z.
inline ImagePoint image_point(Vec3 d)
{
    return {fma(atan2(d.z, d.x), Float(0.5f * inv_pi), Float(0.5f)),
            acos(clamp(d.y, Float(-1), Float(1))) * Float(inv_pi)};
}

/// Radiance of the environment image at a point, bilinearly filtered.
inline Spectrum image_radiance(const EnvironmentRecord& e, const ImagePoint& at, Mask m)
{
    TextureRecord image;
    image.width = e.width;
    image.height = e.height;
    image.wrap_u = std::uint32_t(Wrap::repeat);
    image.wrap_v = std::uint32_t(Wrap::clamp);
    const Texel t = lookup_image(e.texels.data(), image, at.u, at.v, m);
    Spectrum radiance;
    for (std::size_t i = 0; i < channels; ++i) radiance.c[i] = t.c[i] * Float(e.color[i]);
    return radiance;
}

/// Density with respect to solid angle of a direction in a pixel, from the probabilities of its row and of its column
/// within the row. sine: sine of the polar angle.
inline Float cell_pdf(const EnvironmentRecord& e, Float row, Float column, Float sine)
{
    // Converts the density in (u, v) by the Jacobian 2 pi^2 sin(theta) of solid angle.
    return row * column * Float(float(e.width) * float(e.height) * 0.5f * inv_pi * inv_pi) / max(sine, Float(1e-6f));
}

}  // namespace detail

/// Radiance of the environment along a direction (render space), for the lanes of m.
inline Spectrum environment_radiance(const LightTables& tables, Vec3 direction, Mask m)
{
    const EnvironmentRecord& e = tables.environment;
    switch (EnvironmentKind(e.kind)) {
        case EnvironmentKind::none:
            return Spectrum(Float(0));
        case EnvironmentKind::constant:
            return Spectrum(e.color);
        case EnvironmentKind::gradient: {
            const Float t = fma(detail::rotate_in(e, direction).y, Float(0.5f), Float(0.5f));
            Spectrum radiance;
            for (std::size_t i = 0; i < channels; ++i)
                radiance.c[i] = fma(t, Float(e.top[i] - e.bottom[i]), Float(e.bottom[i]));
            return radiance;
        }
        default:
            break;  // procedural environments were compiled to an image
    }
    return detail::image_radiance(e, detail::image_point(detail::rotate_in(e, direction)), m);
}

/// Density with respect to solid angle with which sample_environment returns the direction; 0 if the environment is not
/// a light.
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
    return detail::cell_pdf(e, row, column, sqrt(fma(d.x, d.x, d.z * d.z)));
}

/// A sampled direction of the environment.
struct EnvironmentSample {
    Vec3 wi;
    Float inverse_pdf;
    detail::ImagePoint at;
    Float likely;  ///< approximate luminance, derived from the density alone
};

/// Radiance of a sampled direction.
inline Spectrum environment_radiance(const LightTables& tables, const EnvironmentSample& s, Mask m)
{
    return detail::image_radiance(tables.environment, s.at, m);
}

/// Samples a direction by the image's luminance.
inline EnvironmentSample sample_environment(const LightTables& tables, Sample2 random)
{
    const EnvironmentRecord& e = tables.environment;
    const auto within = [](const GuidedInterval& i, Float x) {
        return clamp((x - i.begin) / max(i.end - i.begin, Float(1e-20f)), Float(0), Float(0.9999999f));
    };
    const GuidedInterval row = find_guided(e.marginal, e.marginal_guide, e.height, UInt(0u), random.y);
    const GuidedInterval column = find_guided(e.conditional, e.conditional_guides, e.width, row.number, random.x);
    const detail::ImagePoint at{(to_float(column.number) + within(column, random.x)) * Float(1.0f / float(e.width)),
                                (to_float(row.number) + within(row, random.y)) * Float(1.0f / float(e.height))};
    const SinCos theta = sincos_2pi(at.v * Float(0.5f)), phi = sincos_2pi(at.u - Float(0.5f));
    const Float pdf = detail::cell_pdf(e, row.end - row.begin, column.end - column.begin, theta.sin);
    EnvironmentSample s;
    s.wi = detail::rotate_out(e, {theta.sin * phi.cos, theta.cos, theta.sin * phi.sin});
    s.inverse_pdf = select(pdf > Float(0), Float(1) / max(pdf, Float(1e-30f)), Float(0));
    s.at = at;
    s.likely = fma(pdf, Float(e.luminance_per_pdf), Float(e.base_luminance));
    return s;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
