#pragma once
#include <cstdint>
#include <cstring>

#include "math/vec3.h"
#include "shading/spectrum.h"

namespace fathom::inline FATHOM_LANES {

/// Numbers of many paths, field by field, path by path; loops run over them N lanes at a time.
template <int fields, std::size_t size>
struct PathFields {
    UInt integer(int field, std::size_t i) const { return float_bits(load(&data[field][i])); }
    Float number(int field, std::size_t i) const { return load(&data[field][i]); }
    Vec3 vector(int field, std::size_t i) const
    {
        return {number(field, i), number(field + 1, i), number(field + 2, i)};
    }
    Spectrum spectrum(int field, std::size_t i) const
    {
        Spectrum s;
        for (int c = 0; c < channels; ++c) s.c[c] = number(field + c, i);
        return s;
    }

    /// Floats, and the bits of integers.
    alignas(64) float data[fields][size];
};

/// The fields of PathPool.
struct PathPoolLayout {
    static constexpr int capacity = 512;
    static constexpr std::size_t padded = capacity + 32;  ///< with room behind for whole registers

    enum Field {
        origin = 0,
        direction = 3,
        throughput = 6,
        radiance = throughput + channels,
        pixel_hash = radiance + channels,
        reversed_index,
        state,
        eta_scale,
        time,
        bsdf_pdf,
        field_count
    };
};

/// Paths under way.
struct PathPool : PathPoolLayout, PathFields<PathPoolLayout::field_count, PathPoolLayout::padded> {
    /// `state` holds the bounce in its low 16 bits, above it the pixel (its place in the job), and:
    static constexpr std::uint32_t bounce_mask = 0xffff;
    static constexpr int pixel_shift = 16;
    static constexpr std::uint32_t max_pixels = 1u << 14;
    static constexpr std::uint32_t specular = 1u << 31;  ///< the last direction came from a delta lobe, or the camera
    static constexpr std::uint32_t dead = 1u << 30;      ///< throughput is 0, or roulette ended the path

    void set(int field, std::size_t i, Float value) { store(&data[field][i], value); }
    void set(int field, std::size_t i, UInt value) { store(&data[field][i], bits_float(value)); }
    void set(int field, std::size_t i, const Vec3& v)
    {
        set(field, i, v.x), set(field + 1, i, v.y), set(field + 2, i, v.z);
    }
    void set(int field, std::size_t i, const Spectrum& s)
    {
        for (int c = 0; c < channels; ++c) set(field + c, i, s.c[c]);
    }
    /// Only the lanes of the mask: what follows belongs to other kinds of paths.
    void set(int field, std::size_t i, Float value, Mask m)
    {
        store(&data[field][i], select(m, value, load(&data[field][i])));
    }
    void set(int field, std::size_t i, UInt value, Mask m) { set(field, i, bits_float(value), m); }
    void set(int field, std::size_t i, const Vec3& v, Mask m)
    {
        set(field, i, v.x, m), set(field + 1, i, v.y, m), set(field + 2, i, v.z, m);
    }
    void set(int field, std::size_t i, const Spectrum& s, Mask m)
    {
        for (int c = 0; c < channels; ++c) set(field + c, i, s.c[c], m);
    }
    std::uint32_t scalar_integer(int field, std::size_t i) const
    {
        return std::bit_cast<std::uint32_t>(data[field][i]);
    }

    /// By lanes from a list of positions.
    UInt gather_integer(int field, UInt index, Mask m) const { return float_bits(gather(data[field], index, m)); }
    Float gather_number(int field, UInt index, Mask m) const { return gather(data[field], index, m); }
    Vec3 gather_vector(int field, UInt index, Mask m) const
    {
        return {gather_number(field, index, m), gather_number(field + 1, index, m), gather_number(field + 2, index, m)};
    }
};

/// What tracing the pool gave, one entry a path.
struct HitArrays {
    static constexpr std::size_t padded = PathPool::padded;
    alignas(64) float t[padded], u[padded], v[padded];
    alignas(64) std::uint32_t primitive[padded], instance[padded];
};

}  // namespace fathom::inline FATHOM_LANES
