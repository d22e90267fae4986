#pragma once
/// Textures by lanes: images in full resolution, checkers, Perlin noise and what is made of it.
#include "fathom/description.h"
#include "math/elementary.h"
#include "math/hash.h"
#include "math/vec3.h"
#include "shading/records.h"

namespace fathom::inline FATHOM_LANES {

struct Texel {
    Float c[4];
};

/// Where a texture is looked up.
struct TexturePoint {
    Float u[2], v[2];  ///< the two uv sets
    Vec3 p_world;
};

namespace detail {

/// Gradient noise: Perlin 2002, "Improving Noise", with a hash of the lattice point instead of a table. About -1 to 1.
inline Float perlin_noise(Vec3 p)
{
    const Vec3 cell{floor(p.x), floor(p.y), floor(p.z)};
    const Vec3 f = p - cell;
    const UInt x = to_uint(clamp(cell.x, Float(-1e9f), Float(1e9f))),
               y = to_uint(clamp(cell.y, Float(-1e9f), Float(1e9f))),
               z = to_uint(clamp(cell.z, Float(-1e9f), Float(1e9f)));
    const auto fade = [](Float t) { return t * t * t * fma(t, fma(t, Float(6), Float(-15)), Float(10)); };
    const auto corner = [&](std::uint32_t dx, std::uint32_t dy, std::uint32_t dz) {
        const UInt h = hash((x + UInt(dx)) + hash((y + UInt(dy)) + hash(z + UInt(dz)))) & UInt(15);
        const Float fx = f.x - Float(float(dx)), fy = f.y - Float(float(dy)), fz = f.z - Float(float(dz));
        // Perlin's 12 edge directions, four of them twice.
        const Float a = select(less(h, UInt(8)), fx, fy);
        const Float b = select(less(h, UInt(4)), fy, select((h == UInt(12)) | (h == UInt(14)), fx, fz));
        return bits_float(float_bits(a) ^ (h << 31)) + bits_float(float_bits(b) ^ ((h >> 1) << 31));
    };
    const auto mix = [](Float t, Float a, Float b) { return fma(t, b - a, a); };
    const Float u = fade(f.x), v = fade(f.y), w = fade(f.z);
    return mix(w, mix(v, mix(u, corner(0, 0, 0), corner(1, 0, 0)), mix(u, corner(0, 1, 0), corner(1, 1, 0))),
               mix(v, mix(u, corner(0, 0, 1), corner(1, 0, 1)), mix(u, corner(0, 1, 1), corner(1, 1, 1))));
}

inline Float turbulence(Vec3 p, std::uint32_t octaves)
{
    Float sum(0.f);
    float weight = 1;
    for (std::uint32_t i = 0; i < octaves; ++i) {
        sum = fma(abs(perlin_noise(p)), Float(weight), sum);
        p = p + p;
        weight *= 0.5f;
    }
    return sum;
}

/// Texel numbers, wrapped into [0, size). x is whole.
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

/// Mixes the four texels about (u, v), or takes the nearest. fetch(number of the texel) gives a Texel.
template <class Fetch>
Texel filter_texels(const TextureRecord& t, Float u, Float v, Fetch&& fetch)
{
    const Float x = clamp(u * Float(float(t.width)), Float(-1e9f), Float(1e9f)) - Float(0.5f);
    const Float y = clamp(v * Float(float(t.height)), Float(-1e9f), Float(1e9f)) - Float(0.5f);
    const auto at = [&](Float column, Float row) {
        return fetch(to_uint(row) * UInt(std::uint32_t(t.width)) + to_uint(column));
    };
    if (t.nearest)
        return at(wrap(floor(x + Float(0.5f)), t.width, t.wrap_u), wrap(floor(y + Float(0.5f)), t.height, t.wrap_v));
    const Float x0 = floor(x), y0 = floor(y), fx = x - x0, fy = y - y0;
    const Float xa = wrap(x0, t.width, t.wrap_u), xb = wrap(x0 + Float(1), t.width, t.wrap_u);
    const Float ya = wrap(y0, t.height, t.wrap_v), yb = wrap(y0 + Float(1), t.height, t.wrap_v);
    const Texel a = at(xa, ya), b = at(xb, ya), c = at(xa, yb), d = at(xb, yb);
    Texel r;
    for (int i = 0; i < 4; ++i) {
        const Float top = fma(fx, b.c[i] - a.c[i], a.c[i]), bottom = fma(fx, d.c[i] - c.c[i], c.c[i]);
        r.c[i] = fma(fy, bottom - top, top);
    }
    return r;
}

/// A finite half in the lower 16 bits; the multiplication puts the exponent right, also of the smallest ones.
inline Float float_of_half(UInt half)
{
    const Float magnitude = bits_float((half & UInt(0x7fff)) << 13) * Float(0x1p112f);
    return bits_float(float_bits(magnitude) | ((half & UInt(0x8000)) << 16));
}

}  // namespace detail

/// The bilinear value at (u, v) of an image of four floats a texel; v grows downwards.
inline Texel lookup_image(const float* all_texels, const TextureRecord& t, Float u, Float v, Mask m)
{
    const float* texels = all_texels + t.texels * 4;
    return detail::filter_texels(t, u, v, [&](UInt number) {
        // Texel numbers below 2^29, so that four floats each stay within 32 bits.
        const UInt index = number << 2;
        Texel texel;
        for (int c = 0; c < 4; ++c) texel.c[c] = gather(texels + c, index, m);
        return texel;
    });
}

/// The same of an image in any format.
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
            // Codes are mixed, and then divided once.
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

/// One texture, the same for all lanes.
inline Texel evaluate_texture(const ShadingTables& tables, const TextureRecord& t, const TexturePoint& at, Mask m)
{
    const int set = t.uv_set ? 1 : 0;
    const Float u = fma(at.u[set], Float(t.uv_map[0]), fma(at.v[set], Float(t.uv_map[1]), Float(t.uv_map[2])));
    const Float v = fma(at.u[set], Float(t.uv_map[3]), fma(at.v[set], Float(t.uv_map[4]), Float(t.uv_map[5])));
    Float mix(0.f);  // from color_a to color_b
    const Vec3 p = at.p_world * Float(t.scale);
    switch (TextureKind(t.kind)) {
        case TextureKind::image:
            return lookup_image(tables, t, u, v, m);
        case TextureKind::checker_uv: {
            const Float cell = floor(u * Float(t.scale)) + floor(v * Float(t.scale));
            mix = cell - floor(cell * Float(0.5f)) * Float(2);
            break;
        }
        case TextureKind::checker_space: {
            const auto sine = [](Float x) { return sincos_2pi(x * Float(0.5f * inv_pi)).sin; };
            mix = select(sine(p.x) * sine(p.y) * sine(p.z) < Float(0), Float(1), Float(0));
            break;
        }
        case TextureKind::noise:
            mix = fma(detail::perlin_noise(p), Float(0.5f), Float(0.5f));
            break;
        case TextureKind::turbulence:
            mix = detail::turbulence(p, t.octaves);
            break;
        case TextureKind::marble: {
            const Float phase = fma(detail::turbulence(at.p_world, t.octaves), Float(t.turbulence_weight), p.z);
            mix = fma(sincos_2pi(phase * Float(0.5f * inv_pi)).sin, Float(0.5f), Float(0.5f));
            break;
        }
    }
    Texel r;
    for (std::size_t c = 0; c < 4; ++c) r.c[c] = fma(mix, Float(t.color_b[c] - t.color_a[c]), Float(t.color_a[c]));
    return r;
}

/// A texture of each lane's own; 1 where there is none.
inline Texel evaluate_textures(const ShadingTables& tables, UInt texture, const TexturePoint& at, Mask m)
{
    Texel r;
    for (Float& c : r.c) c = Float(1);
    for_each_unique(m & (texture != UInt(no_index)), texture, [&](std::uint32_t index, Mask same) {
        const Texel t = evaluate_texture(tables, tables.textures[index], at, same);
        for (int c = 0; c < 4; ++c) r.c[c] = select(same, t.c[c], r.c[c]);
    });
    return r;
}

}  // namespace fathom::inline FATHOM_LANES
