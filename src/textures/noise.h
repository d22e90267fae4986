// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "math/hash.h"
#include "textures/improved_noise.h"
#include "textures/mapping.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

/// Gradient noise in about -1 to 1: Perlin 2002, "Improving Noise", with a hash of the lattice point instead of a
/// table.
inline Float perlin_noise(Vec3 p)
{
    const Vec3 cell{floor(p.x), floor(p.y), floor(p.z)};
    const Vec3 f = p - cell;
    const UInt x = to_uint(clamp(cell.x, Float(-1e9f), Float(1e9f))),
               y = to_uint(clamp(cell.y, Float(-1e9f), Float(1e9f))),
               z = to_uint(clamp(cell.z, Float(-1e9f), Float(1e9f)));
    const auto corner = [&](std::uint32_t dx, std::uint32_t dy, std::uint32_t dz) {
        const UInt h = hash((x + UInt(dx)) + hash((y + UInt(dy)) + hash(z + UInt(dz)))) & UInt(15);
        const Float fx = f.x - Float(float(dx)), fy = f.y - Float(float(dy)), fz = f.z - Float(float(dz));
        // The gradients are Perlin's 12 edge vectors, four of which occur twice.
        const Float a = select(less(h, UInt(8)), fx, fy);
        const Float b = select(less(h, UInt(4)), fy, select((h == UInt(12)) | (h == UInt(14)), fx, fz));
        return bits_float(float_bits(a) ^ (h << 31)) + bits_float(float_bits(b) ^ ((h >> 1) << 31));
    };
    const auto mix = [](Float t, Float a, Float b) { return fma(t, b - a, a); };
    const Float u = fade(f.x), v = fade(f.y), w = fade(f.z);
    return mix(w, mix(v, mix(u, corner(0, 0, 0), corner(1, 0, 0)), mix(u, corner(0, 1, 0), corner(1, 1, 0))),
               mix(v, mix(u, corner(0, 0, 1), corner(1, 0, 1)), mix(u, corner(0, 1, 1), corner(1, 1, 1))));
}

/// Sum of octaves of |noise|, each with half the weight and twice the frequency of the one before.
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

}  // namespace detail

/// Mixes two colors by gradient noise in space.
struct NoiseTexture {
    static constexpr TextureKind kind = TextureKind::noise;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        const Float noise = detail::perlin_noise(texture_space_point(graph.tables, t, at) * Float(t.scale));
        return graph.mix(t, fma(noise, Float(0.5f), Float(0.5f)), at, m);
    }
};

/// Mixes two colors by turbulence.
struct TurbulenceTexture {
    static constexpr TextureKind kind = TextureKind::turbulence;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        return graph.mix(t, detail::turbulence(texture_space_point(graph.tables, t, at) * Float(t.scale), t.octaves),
                         at, m);
    }
};

/// Marble: sinusoidal bands along z, displaced by turbulence.
struct MarbleTexture {
    static constexpr TextureKind kind = TextureKind::marble;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        const Vec3 p = texture_space_point(graph.tables, t, at);
        const Float phase = fma(detail::turbulence(p, t.octaves), Float(t.turbulence_weight), p.z * Float(t.scale));
        return graph.mix(t, fma(sincos_2pi(phase * Float(0.5f * inv_pi)).sin, Float(0.5f), Float(0.5f)), at, m);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
