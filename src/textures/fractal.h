// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Sums of noise octaves (fBm) and textures made of them, as in pbrt-v4 without its antialiasing of octaves.
#include "textures/improved_noise.h"
#include "textures/mapping.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

/// Frequency ratio of octaves; not exactly 2, so that their lattices don't coincide.
inline constexpr float lacunarity = 1.99f;

/// Fractional Brownian motion: a weighted sum of octaves of noise.
inline Float fbm(Vec3 p, float gain, std::uint32_t octaves)
{
    Float sum(0.f);
    float frequency = 1, height = 1;
    for (std::uint32_t i = 0; i < octaves; ++i) {
        sum = fma(improved_noise(p * Float(frequency)), Float(height), sum);
        frequency *= lacunarity;
        height *= gain;
    }
    return sum;
}

/// Turbulence: a sum of octaves of |noise|. 0.2, which is about the mean of |noise|, stands for the omitted octaves.
inline Float wrinkles(Vec3 p, float gain, std::uint32_t octaves)
{
    Float sum(0.f);
    float frequency = 1, height = 1;
    for (std::uint32_t i = 0; i < octaves; ++i) {
        sum = fma(abs(improved_noise(p * Float(frequency))), Float(height), sum);
        frequency *= lacunarity;
        height *= gain;
    }
    return sum + Float(0.2f * height);
}

/// Control points of the marble's color: cubic Bézier segments, each of which starts at the last point of the segment
/// before.
inline constexpr float marble_colors[9][3] = {{0.58f, 0.58f, 0.6f}, {0.58f, 0.58f, 0.6f}, {0.58f, 0.58f, 0.6f},
                                              {0.5f, 0.5f, 0.5f},   {0.6f, 0.59f, 0.58f}, {0.58f, 0.58f, 0.6f},
                                              {0.58f, 0.58f, 0.6f}, {0.2f, 0.2f, 0.33f},  {0.58f, 0.58f, 0.6f}};

}  // namespace detail

/// Mixes two colors by fBm.
struct FbmTexture {
    static constexpr TextureKind kind = TextureKind::fbm;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        return graph.mix(t, detail::fbm(texture_space_point(graph.tables, t, at) * Float(t.scale), t.gain, t.octaves),
                         at, m);
    }
};

/// Mixes two colors by turbulence.
struct WrinkledTexture {
    static constexpr TextureKind kind = TextureKind::wrinkled;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        return graph.mix(
            t, detail::wrinkles(texture_space_point(graph.tables, t, at) * Float(t.scale), t.gain, t.octaves), at, m);
    }
};

/// Waves on water: fBm with an amplitude that varies with a second fBm of lower frequency.
struct WindyTexture {
    static constexpr TextureKind kind = TextureKind::windy;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        const Vec3 p = texture_space_point(graph.tables, t, at) * Float(t.scale);
        const Float wind = abs(detail::fbm(p * Float(0.1f), 0.5f, 3)), waves = detail::fbm(p, 0.5f, 6);
        return graph.mix(t, wind * waves, at, m);
    }
};

/// Marble of pbrt-v4: a color spline along y, displaced by fBm.
struct VeinedMarbleTexture {
    static constexpr TextureKind kind = TextureKind::veined_marble;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask)
    {
        constexpr int pieces = 6;
        const Vec3 p = texture_space_point(graph.tables, t, at) * Float(t.scale);
        const Float phase = fma(detail::fbm(p, t.gain, t.octaves), Float(t.turbulence_weight), p.y);
        const Float along = fma(sincos_2pi(phase * Float(0.5f * inv_pi)).sin, Float(0.5f), Float(0.5f)) * Float(pieces);
        const Float piece = clamp(floor(along), Float(0), Float(pieces - 1));
        const Float b = along - piece, a = Float(1) - b;
        const Float weight[4] = {a * a * a, Float(3) * a * a * b, Float(3) * a * b * b, b * b * b};
        const UInt first = to_uint(piece) * UInt(3u);
        Texel r;
        for (int c = 0; c < 3; ++c) {
            Float sum(0.f);
            for (int k = 0; k < 4; ++k) sum = fma(weight[k], gather(&detail::marble_colors[k][c], first), sum);
            r.c[c] = sum * Float(1.5f);
        }
        r.c[3] = Float(1);
        return r;
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
