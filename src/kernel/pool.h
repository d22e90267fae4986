#pragma once
#include <cstdint>

#include "math/spectrum.h"
#include "math/vec3.h"
#include "media/stack.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// So many paths are under way at once in a thread.
inline constexpr std::size_t pool_capacity = 2048;
/// Columns have room behind for stores of whole registers.
inline constexpr std::size_t pool_padded = pool_capacity + 32;

/// A number of many paths, path by path; loops run over it N lanes at a time. T: float or a 32-bit integer.
template <class T>
struct Column {
    using Lanes = decltype(fathom::load(static_cast<const T*>(nullptr)));

    Lanes load(std::size_t i) const { return fathom::load(&data[i]); }
    void store(std::size_t i, Lanes value) { fathom::store(&data[i], value); }
    /// Only the lanes of the mask: what follows belongs to other paths.
    void store(std::size_t i, Lanes value, Mask m) { store(i, select(m, value, load(i))); }
    /// The lanes of the mask, one behind the other.
    void append(std::size_t i, Lanes value, Mask m) { compress_store(&data[i], value, m); }
    Lanes gather(UInt index, Mask m) const { return fathom::gather(data, index, m); }
    T& operator[](std::size_t i) { return data[i]; }
    T operator[](std::size_t i) const { return data[i]; }

    alignas(64) T data[pool_padded];
};

struct VectorColumn {
    Vec3 load(std::size_t i) const { return {x.load(i), y.load(i), z.load(i)}; }
    void store(std::size_t i, const Vec3& v) { x.store(i, v.x), y.store(i, v.y), z.store(i, v.z); }
    void store(std::size_t i, const Vec3& v, Mask m) { x.store(i, v.x, m), y.store(i, v.y, m), z.store(i, v.z, m); }
    void append(std::size_t i, const Vec3& v, Mask m) { x.append(i, v.x, m), y.append(i, v.y, m), z.append(i, v.z, m); }
    Vec3 gather(UInt index, Mask m) const { return {x.gather(index, m), y.gather(index, m), z.gather(index, m)}; }

    Column<float> x, y, z;
};

struct SpectrumColumn {
    Spectrum load(std::size_t i) const
    {
        Spectrum s;
        for (int k = 0; k < channels; ++k) s.c[k] = c[k].load(i);
        return s;
    }
    void store(std::size_t i, const Spectrum& s)
    {
        for (int k = 0; k < channels; ++k) c[k].store(i, s.c[k]);
    }
    void store(std::size_t i, const Spectrum& s, Mask m)
    {
        for (int k = 0; k < channels; ++k) c[k].store(i, s.c[k], m);
    }
    void append(std::size_t i, const Spectrum& s, Mask m)
    {
        for (int k = 0; k < channels; ++k) c[k].append(i, s.c[k], m);
    }

    Column<float> c[channels];
};

/// See MediumStack.
struct MediaColumn {
    MediumStack load(std::size_t i) const { return {low.load(i), high.load(i)}; }
    void store(std::size_t i, const MediumStack& media) { low.store(i, media.low()), high.store(i, media.high()); }
    void store(std::size_t i, const MediumStack& media, Mask m)
    {
        low.store(i, media.low(), m), high.store(i, media.high(), m);
    }

    Column<std::uint32_t> low, high;
};

/// Calls f(column of a, the same of b) for each plain column of two columns of the same type.
template <class T, class F>
void for_columns(Column<T>& a, Column<T>& b, F&& f)
{
    f(a, b);
}
template <class F>
void for_columns(VectorColumn& a, VectorColumn& b, F&& f)
{
    f(a.x, b.x), f(a.y, b.y), f(a.z, b.z);
}
template <class F>
void for_columns(SpectrumColumn& a, SpectrumColumn& b, F&& f)
{
    for (int k = 0; k < channels; ++k) f(a.c[k], b.c[k]);
}

template <class F>
void for_columns(MediaColumn& a, MediaColumn& b, F&& f)
{
    f(a.low, b.low), f(a.high, b.high);
}

/// What a path carries that not every scene needs.
struct PathExtras {
    bool time = false;                  ///< something moves
    bool eta_scale = false;             ///< something refracts
    bool media = false;                 ///< what solids are filled with matters
    bool clamp = false;                 ///< indirect light is limited
    bool light_chance = false;          ///< a light is not sampled everywhere
    bool number = false;                ///< paths are noted
    bool walks = false;                 ///< and that scatters
    bool walk_textures = false;         ///< in colours and distances of its own where the path came in
    bool transmissive_shadows = false;  ///< surfaces may be passed as if they were not there
};

/// Paths under way.
struct PathPool {
    VectorColumn origin, direction;
    SpectrumColumn throughput, radiance;
    Column<std::uint32_t> pixel_hash, reversed_index;  ///< see SampleKey
    /// The bounce in its low 15 bits, the pixel (its place in the job) from the 16th on, and:
    Column<std::uint32_t> state;
    static constexpr std::uint32_t bounce_mask = 0x7fff;
    static constexpr std::uint32_t scattered = 1u << 15;  ///< some direction came from other than delta lobes
    static constexpr int pixel_shift = 16;
    static constexpr std::uint32_t max_pixels = 1u << 14;
    static constexpr std::uint32_t specular = 1u << 31;  ///< the last direction came from a delta lobe, or the camera
    static constexpr std::uint32_t dead = 1u << 30;      ///< throughput is 0, or roulette ended the path
    Column<float> bsdf_pdf;  ///< of the last direction; whoever shades gives it anew, but at open boundaries
    Column<float>
        exit_offset;  ///< beside it, see LaneScene::has_way_out: so far before the origin lights were seen from
    Column<float> eta_scale, time;
    Column<float> indirect_left;  ///< see IndirectClamp
    /// Of sampling a light where the path is; below 0: it does not.
    Column<float> light_chance;
    Column<std::uint32_t> number;  ///< in the job
    MediaColumn media;
    Column<std::uint32_t> walk_steps;  ///< within a medium, since the last surface
    /// Of media with textures: extinction, and what is scattered of it; below 0: what the medium says.
    SpectrumColumn walk_extinction, walk_albedo;

    /// Calls f(column of a, the same of b) for what a path takes with it to its next surface and on from there.
    template <class F>
    static void for_each_live_column(PathPool& a, PathPool& b, PathExtras extras, F&& f)
    {
        for_columns(a.origin, b.origin, f), for_columns(a.direction, b.direction, f);
        for_columns(a.throughput, b.throughput, f), for_columns(a.radiance, b.radiance, f);
        f(a.pixel_hash, b.pixel_hash), f(a.reversed_index, b.reversed_index), f(a.state, b.state);
        if (extras.eta_scale) f(a.eta_scale, b.eta_scale);
        if (extras.time) f(a.time, b.time);
        if (extras.media) for_columns(a.media, b.media, f);
        if (extras.clamp) f(a.indirect_left, b.indirect_left);
        if (extras.light_chance) f(a.light_chance, b.light_chance);
        if (extras.number) f(a.number, b.number);
        if (extras.walks) f(a.walk_steps, b.walk_steps);
        if (extras.transmissive_shadows) f(a.bsdf_pdf, b.bsdf_pdf), f(a.exit_offset, b.exit_offset);
        if (extras.walk_textures)
            for_columns(a.walk_extinction, b.walk_extinction, f), for_columns(a.walk_albedo, b.walk_albedo, f);
    }
    template <class Word>
    static Word pixel_of(Word state)
    {
        return (state >> pixel_shift) & Word(max_pixels - 1);
    }
};

/// What tracing the pool gave, one entry a path.
struct HitColumns {
    Column<float> t, u, v;
    Column<std::uint32_t> primitive, instance;
    Column<std::uint32_t> material;  ///< see SurfaceHit

    /// Calls f(column of a, the same of b) for each; instance and material only where there are any.
    template <class F>
    static void for_all(HitColumns& a, HitColumns& b, bool instances, bool materials, F&& f)
    {
        f(a.t, b.t), f(a.u, b.u), f(a.v, b.v), f(a.primitive, b.primitive);
        if (instances) f(a.instance, b.instance);
        if (materials) f(a.material, b.material);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
