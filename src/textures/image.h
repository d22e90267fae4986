// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>

#include "textures/mapping.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

/// Wraps a texel coordinate (an integer) into [0, size).
inline Float wrap(Float x, int size, std::uint32_t mode)
{
    const Float n(static_cast<float>(size));
    if (mode == std::uint32_t(Wrap::clamp)) return clamp(x, Float(0), n - Float(1));
    if (mode == std::uint32_t(Wrap::repeat)) {
        const Float r = x - floor(x / n) * n;
        return clamp(r, Float(0), n - Float(1));
    }
    const Float period = n + n;
    const Float r = x - floor(x / period) * period;
    return clamp(min(r, period - Float(1) - r), Float(0), n - Float(1));
}

/// Bilinear interpolation of four texels: a and b are the upper row.
inline Texel between_texels(const Texel& a, const Texel& b, const Texel& c, const Texel& d, Float fx, Float fy)
{
    Texel r;
    for (int i = 0; i < 4; ++i) {
        const Float top = fma(fx, b.c[i] - a.c[i], a.c[i]), bottom = fma(fx, d.c[i] - c.c[i], c.c[i]);
        r.c[i] = fma(fy, bottom - top, top);
    }
    return r;
}

/// Maps a column and row outside the image to a texel by the texture's wrap modes. Returns false in lanes that read
/// black.
inline Mask apply_wrap_modes(const TextureRecord& t, Float& column, Float& row)
{
    const Float width(static_cast<float>(t.width)), height(static_cast<float>(t.height)), one(1);
    Mask inside(true);
    if (t.wrap_u == std::uint32_t(Wrap::octahedral)) {
        // Octahedral maps: each edge of the square is folded at its midpoint, and both halves are the same curve on the
        // sphere.
        const Mask aside = (column < Float(0)) | (column >= width);
        column =
            select(column < Float(0), -one - column, select(column >= width, width + width - one - column, column));
        row = select(aside, height - one - row, row);
        const Mask beyond = (row < Float(0)) | (row >= height);
        row = select(row < Float(0), -one - row, select(row >= height, height + height - one - row, row));
        column = select(beyond, width - one - column, column);
    } else {
        if (t.wrap_u == std::uint32_t(Wrap::black)) inside = inside & (column >= Float(0)) & (column < width);
        if (t.wrap_v == std::uint32_t(Wrap::black)) inside = inside & (row >= Float(0)) & (row < height);
    }
    const auto within = [](Float x, int size, std::uint32_t mode) {
        return wrap(x, size, mode < std::uint32_t(Wrap::black) ? mode : std::uint32_t(Wrap::clamp));
    };
    column = within(column, t.width, t.wrap_u), row = within(row, t.height, t.wrap_v);
    return inside;
}

/// filter_texels() for the rare wrap modes black and octahedral. x, y: in texels; integers are texel centers.
template <class Fetch>
[[gnu::noinline]] Texel filter_across_edges(const TextureRecord& t, Float x, Float y, const Fetch& fetch)
{
    const auto at = [&](Float column, Float row) {
        const Mask inside = apply_wrap_modes(t, column, row);
        Texel texel = fetch(to_uint(row) * UInt(std::uint32_t(t.width)) + to_uint(column));
        for (Float& c : texel.c) c = select(inside, c, Float(0));
        return texel;
    };
    if (t.nearest) return at(floor(x + Float(0.5f)), floor(y + Float(0.5f)));
    const Float x0 = floor(x), y0 = floor(y), x1 = x0 + Float(1), y1 = y0 + Float(1);
    return between_texels(at(x0, y0), at(x1, y0), at(x0, y1), at(x1, y1), x - x0, y - y0);
}

/// Bilinear filter at (u, v), or the nearest texel. fetch(texel index) returns a Texel.
template <class Fetch>
Texel filter_texels(const TextureRecord& t, Float u, Float v, Fetch&& fetch)
{
    const Float x = clamp(u * Float(float(t.width)), Float(-1e9f), Float(1e9f)) - Float(0.5f);
    const Float y = clamp(v * Float(float(t.height)), Float(-1e9f), Float(1e9f)) - Float(0.5f);
    const auto at = [&](Float column, Float row) {
        return fetch(to_uint(row) * UInt(std::uint32_t(t.width)) + to_uint(column));
    };
    if (std::max(t.wrap_u, t.wrap_v) >= std::uint32_t(Wrap::black)) return filter_across_edges(t, x, y, fetch);
    if (t.nearest)
        return at(wrap(floor(x + Float(0.5f)), t.width, t.wrap_u), wrap(floor(y + Float(0.5f)), t.height, t.wrap_v));
    const Float x0 = floor(x), y0 = floor(y), fx = x - x0, fy = y - y0;
    const Float xa = wrap(x0, t.width, t.wrap_u), xb = wrap(x0 + Float(1), t.width, t.wrap_u);
    const Float ya = wrap(y0, t.height, t.wrap_v), yb = wrap(y0 + Float(1), t.height, t.wrap_v);
    return between_texels(at(xa, ya), at(xb, ya), at(xa, yb), at(xb, yb), fx, fy);
}

/// Converts a finite half in the lower 16 bits to float. The multiplication corrects the exponent, also of subnormal
/// halves.
inline Float float_of_half(UInt half)
{
    const Float magnitude = bits_float((half & UInt(0x7fff)) << 13) * Float(0x1p112f);
    return bits_float(float_bits(magnitude) | ((half & UInt(0x8000)) << 16));
}

}  // namespace detail

/// Filtered value at (u, v) of an image of format float4; v grows downwards.
inline Texel lookup_image(const float* all_texels, const TextureRecord& t, Float u, Float v, Mask m)
{
    const float* texels = all_texels + t.texels * 4;
    return detail::filter_texels(t, u, v, [&](UInt number) {
        // Texel indices are below 2^29: the index of the float (4 times that) stays below 2^31.
        Texel texel;
        gather_row(texels, number << 2, m, texel.c);
        return texel;
    });
}

/// Filtered value at (u, v) of an image of any format.
inline Texel lookup_image(const ShadingTables& tables, const TextureRecord& t, Float u, Float v, Mask m)
{
    if (TexelFormat(t.format) == TexelFormat::float4) return lookup_image(tables.texels.data(), t, u, v, m);
    const std::uint32_t* words = tables.packed_images[t.texels].data();
    const auto in_bytes = [&](UInt number) {
        const UInt word = gather(words, number, m);
        Texel texel;
        for (int c = 0; c < 4; ++c) texel.c[c] = to_float((word >> (8 * c)) & UInt(0xff));
        return texel;
    };
    Texel r;
    switch (TexelFormat(t.format)) {
        case TexelFormat::float4:
            break;
        case TexelFormat::bytes:
            // Integer codes are interpolated, and the result is divided once.
            r = detail::filter_texels(t, u, v, in_bytes);
            for (Float& value : r.c) value = value / Float(255);
            break;
        case TexelFormat::bytes_srgb:
            r = detail::filter_texels(t, u, v, [&](UInt number) {
                const UInt word = gather(words, number, m);
                Texel texel;
                for (int c = 0; c < 3; ++c)
                    texel.c[c] = gather(tables.linear_of_srgb.data(), (word >> (8 * c)) & UInt(0xff), m);
                texel.c[3] = to_float(word >> 24);
                return texel;
            });
            r.c[3] = r.c[3] / Float(255);
            break;
        case TexelFormat::halves:
        case TexelFormat::shorts: {
            const bool halves = TexelFormat(t.format) == TexelFormat::halves;
            r = detail::filter_texels(t, u, v, [&](UInt number) {
                const UInt index = number << 1;
                const UInt pairs[2] = {gather(words, index, m), gather(words + 1, index, m)};
                Texel texel;
                for (int c = 0; c < 4; ++c) {
                    const UInt code = c % 2 ? pairs[c / 2] >> 16 : pairs[c / 2] & UInt(0xffff);
                    texel.c[c] = halves ? detail::float_of_half(code) : to_float(code);
                }
                return texel;
            });
            if (!halves)
                for (Float& value : r.c) value = value / Float(65535);
            break;
        }
    }
    return r;
}

/// An image, filtered at texture coordinates.
struct ImageTexture {
    static constexpr TextureKind kind = TextureKind::image;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        const TextureUv uv(graph.tables, t, at);
        return lookup_image(graph.tables, t, uv.u, uv.v, m);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
