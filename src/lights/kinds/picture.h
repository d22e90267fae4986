// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Lookup of the images that multiply the intensity of lights by direction.
#include "lights/records.h"
#include "math/elementary.h"
#include "math/gather_member.h"
#include "math/spectrum.h"
#include "sampling/warp.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

/// A point of an image, in texels; integers are texel centers.
struct PicturePoint {
    Float x, y;
    Mask is_inside;
};

using PictureRow = RecordRow<LightPictureRecord, 8>;

/// The image point of a direction by perspective projection. right, up, along: components of the unit direction.
inline PicturePoint plane_point(const PictureRow& t, Float right, Float up, Float along)
{
    const Mask ahead = along > Float(0);
    const Float scale = Float(0.5f) / select(ahead, along, Float(1));
    const Float u = fma(right * scale, t.get(&LightPictureRecord::scale_u), Float(0.5f)),
                v = fma(-up * scale, t.get(&LightPictureRecord::scale_v), Float(0.5f));
    const Mask inside = ahead & (u >= Float(0)) & (u <= Float(1)) & (v >= Float(0)) & (v <= Float(1));
    return {fma(u, t.get(&LightPictureRecord::width), Float(-0.5f)),
            fma(v, t.get(&LightPictureRecord::height), Float(-0.5f)), inside};
}

/// The image point of a direction in an equal-area square.
inline PicturePoint equal_area_point(const PictureRow& t, Float right, Float up, Float along)
{
    const SquarePoint p = equal_area_square(right, up, along);
    const Float half_w = t.get(&LightPictureRecord::width) * Float(0.5f),
                half_h = t.get(&LightPictureRecord::height) * Float(0.5f);
    // Rows grow downwards.
    return {fma(p.x, half_w, half_w - Float(0.5f)), fma(-p.y, half_h, half_h - Float(0.5f)), Mask(true)};
}

/// The image point of a direction if rows are angles from the axis, and columns angles about it.
inline PicturePoint angles_point(const PictureRow& t, Float right, Float up, Float along)
{
    const Float polar = atan2(sqrt(fma(right, right, up * up)), along), azimuth = atan2(up, right);
    const Float row = (polar - t.get(&LightPictureRecord::start)) * t.get(&LightPictureRecord::scale_v);
    constexpr float slack = 1e-3f;  // larger than the rounding errors of angles; the last row is part of the image
    const Float last = t.get(&LightPictureRecord::height) - Float(1);
    const Mask inside = (row >= Float(-slack)) & (row <= last + Float(slack));
    return {select(azimuth < Float(0), azimuth + Float(2 * pi), azimuth) * t.get(&LightPictureRecord::scale_u), row,
            inside};
}

/// Index of a texel; x and y may lie beyond the edges.
inline UInt picture_texel(const PictureRow& t, Float x, Float y, Mask equal_area, Mask angles)
{
    const Float w = t.get(&LightPictureRecord::width), h = t.get(&LightPictureRecord::height);
    x = select(angles & (x >= w), x - w, x);
    const Float last_x = w - Float(1), last_y = h - Float(1);
    const Mask beside = equal_area & ((x < Float(0)) | (x > last_x));
    x = clamp(x, Float(0), last_x);
    // Beyond an edge, an equal-area image continues at the same edge, mirrored at the edge's midpoint.
    y = select(beside, last_y - y, y);
    const Mask above = equal_area & ((y < Float(0)) | (y > last_y));
    y = clamp(y, Float(0), last_y);
    x = select(above, last_x - x, x);
    return t.get(&LightPictureRecord::first) + to_uint(y) * to_uint(w) + to_uint(x);
}

}  // namespace detail

/// Factor of a light's intensity in a direction, for the lanes of m; 0 outside the image.
///
/// right, up, along  components of the unit direction in the axes of the light
inline Spectrum light_picture(const LightTables& tables, UInt picture, Float right, Float up, Float along, Mask m)
{
    const detail::PictureRow t(tables.light_pictures, picture, m);
    const auto is_map = [&](LightPictureMap map) {
        return m & (t.get(&LightPictureRecord::map) == UInt(std::uint32_t(map)));
    };
    const auto has = [&](std::uint32_t flag) { return (t.get(&LightPictureRecord::flags) & UInt(flag)) != UInt(0u); };
    const Mask equal_area = is_map(LightPictureMap::equal_area), angles = is_map(LightPictureMap::angles);
    detail::PicturePoint at = detail::plane_point(t, right, up, along);
    const auto take = [&](const detail::PicturePoint& other, Mask mine) {
        at.x = select(mine, other.x, at.x);
        at.y = select(mine, other.y, at.y);
        at.is_inside = (mine & other.is_inside) | (at.is_inside & !mine);
    };
    if (any(equal_area)) take(detail::equal_area_point(t, right, up, along), equal_area);
    if (any(angles)) take(detail::angles_point(t, right, up, along), angles);

    const Mask inside = m & at.is_inside;
    Spectrum factor(Float(0));
    if (none(inside)) return factor;
    const Float x = select(inside, at.x, Float(0)), y = select(inside, at.y, Float(0));
    const Mask nearest = has(LightPictureRecord::nearest);
    const Float x0 = select(nearest, floor(x + Float(0.5f)), floor(x)),
                y0 = select(nearest, floor(y + Float(0.5f)), floor(y));
    const Float fx = select(nearest, Float(0), x - x0), fy = select(nearest, Float(0), y - y0);
    const auto texel = [&](Float column, Float row) {
        // Texel indices are below 2^29: the index of the float (4 times that) stays below 2^31.
        Float values[4];
        gather_row(tables.picture_texels.data(), detail::picture_texel(t, column, row, equal_area, angles) << 2, inside,
                   values);
        Spectrum s;
        for (int i = 0; i < channels; ++i) s.c[i] = values[i];
        return s;
    };
    const Spectrum a = texel(x0, y0), b = texel(x0 + Float(1), y0), c = texel(x0, y0 + Float(1)),
                   d = texel(x0 + Float(1), y0 + Float(1));
    const Mask flat = inside & has(LightPictureRecord::flat_field) & (along > Float(0));
    const Float oblique = select(flat, Float(1) / select(flat, along * along * along, Float(1)), Float(1));
    for (int i = 0; i < channels; ++i) {
        const Float top = fma(fx, b.c[i] - a.c[i], a.c[i]), bottom = fma(fx, d.c[i] - c.c[i], c.c[i]);
        factor.c[i] = select(inside, fma(fy, bottom - top, top) * oblique, Float(0));
    }
    return factor;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
