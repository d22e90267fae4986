// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "kernel/features.h"
#include "math/spectrum.h"
#include "math/vec3.h"
#include "media/stack.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Number of paths a thread keeps in flight.
inline constexpr std::size_t pool_capacity = 2048;
/// Length of columns in memory: padding allows stores of whole registers past the last path.
inline constexpr std::size_t pool_padded = pool_capacity + 32;

/// One value per path, stored contiguously; loops run over it `lanes` paths at a time. T: float or std::uint32_t.
template <class T>
struct Column {
    using Lanes = decltype(fathom::load(static_cast<const T*>(nullptr)));

    Lanes load(std::size_t i) const { return fathom::load(&data[i]); }
    void store(std::size_t i, Lanes value) { fathom::store(&data[i], value); }
    /// Stores the lanes of the mask only; the other lanes belong to other paths.
    void store(std::size_t i, Lanes value, Mask m) { store(i, select(m, value, load(i))); }
    /// Stores the lanes of the mask contiguously from index i on (stream compaction).
    void append(std::size_t i, Lanes value, Mask m) { compress_store(&data[i], value, m); }
    Lanes gather(UInt index, Mask m) const { return fathom::gather(data, index, m); }
    T& operator[](std::size_t i) { return data[i]; }
    T operator[](std::size_t i) const { return data[i]; }

    alignas(64) T data[pool_padded];
};

/// One vector per path, as three columns.
struct VectorColumn {
    Vec3 load(std::size_t i) const { return {x.load(i), y.load(i), z.load(i)}; }
    void store(std::size_t i, const Vec3& v) { x.store(i, v.x), y.store(i, v.y), z.store(i, v.z); }
    void store(std::size_t i, const Vec3& v, Mask m) { x.store(i, v.x, m), y.store(i, v.y, m), z.store(i, v.z, m); }
    void append(std::size_t i, const Vec3& v, Mask m) { x.append(i, v.x, m), y.append(i, v.y, m), z.append(i, v.z, m); }
    Vec3 gather(UInt index, Mask m) const { return {x.gather(index, m), y.gather(index, m), z.gather(index, m)}; }

    Column<float> x, y, z;
};

/// One spectrum per path, a column per channel.
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

/// One MediumStack per path, as two columns of words.
struct MediaColumn {
    MediumStack load(std::size_t i) const { return {low.load(i), high.load(i)}; }
    void store(std::size_t i, const MediumStack& media) { low.store(i, media.low()), high.store(i, media.high()); }
    void store(std::size_t i, const MediumStack& media, Mask m)
    {
        low.store(i, media.low(), m), high.store(i, media.high(), m);
    }

    Column<std::uint32_t> low, high;
};

/// Calls f(column of a, column of b) for each plain column of two columns of equal type.
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

/// State of the paths in flight, as a structure of arrays.
struct PathPool {
    VectorColumn origin, direction;
    SpectrumColumn throughput, radiance;
    Column<std::uint32_t> pixel_hash, reversed_index;  ///< hash of the pixel and reversed sample index, see SampleKey
    /// Bits 0 to 14: number of bounces. Bits from 16 on: position of the pixel in the job. Other bits: the flags below.
    Column<std::uint32_t> state;
    static constexpr std::uint32_t bounce_mask = 0x7fff;
    static constexpr std::uint32_t scattered = 1u << 15;  ///< some scattering event was not a delta lobe
    static constexpr int pixel_shift = 16;
    static constexpr std::uint32_t max_pixels = 1u << 14;
    static constexpr std::uint32_t specular = 1u << 31;  ///< the last direction came from a delta lobe or the camera
    static constexpr std::uint32_t dead = 1u << 30;  ///< the path has ended: throughput is 0, or by Russian roulette
    Column<float> bsdf_pdf;     ///< MIS density (solid angle) of the last direction; kept when a path passes an open
                                ///< boundary or pane
    Column<float> exit_offset;  ///< distance along the ray from the point where lights were sampled to the ray origin;
                                ///< see Feature::exit_offsets
    Column<float> eta_scale, time;
    Column<float> indirect_left;  ///< remaining budget of indirect light: see integrate/stages/indirect_clamp.h
    /// Probability with which this vertex samples a light; negative if this path does not sample one.
    Column<float> nee_probability;
    Column<std::uint32_t> number;  ///< number of the path in the job
    MediaColumn media;
    Column<std::uint32_t> walk_steps;  ///< scattering events within a medium since the last surface
    /// Extinction and single-scattering albedo of textured media, fixed on entry; negative extinction: use the
    /// medium's.
    SpectrumColumn walk_extinction, walk_albedo;
    Column<float> connection;  ///< what the weight against light tracing needs: see integrate/stages/light_tracing.h
    /// Density with which the closure alone samples the last direction; negative if no vertex came before.
    Column<float> scatter_pdf;

    /// Whether photons of caustics were gathered at the last vertex that is not a delta lobe: a value of Gathered.
    Column<std::uint32_t> gathered;
    enum Gathered : std::uint32_t {
        nothing,
        caustics,         ///< gathered at the last vertex
        caustics_before,  ///< gathered before the last vertices, which are delta lobes: the photons have what follows
    };

    /// Calls f(column of a, column of b) for each column that lives on to the next surface and beyond.
    template <class F>
    static void for_each_live_column(PathPool& a, PathPool& b, PathColumns columns, F&& f)
    {
        for_columns(a.origin, b.origin, f), for_columns(a.direction, b.direction, f);
        for_columns(a.throughput, b.throughput, f), for_columns(a.radiance, b.radiance, f);
        f(a.pixel_hash, b.pixel_hash), f(a.reversed_index, b.reversed_index), f(a.state, b.state);
        if (columns.has(PathColumn::eta_scale)) f(a.eta_scale, b.eta_scale);
        if (columns.has(PathColumn::time)) f(a.time, b.time);
        if (columns.has(PathColumn::media)) for_columns(a.media, b.media, f);
        if (columns.has(PathColumn::indirect_left)) f(a.indirect_left, b.indirect_left);
        if (columns.has(PathColumn::nee_probability)) f(a.nee_probability, b.nee_probability);
        if (columns.has(PathColumn::number)) f(a.number, b.number);
        if (columns.has(PathColumn::walk_steps)) f(a.walk_steps, b.walk_steps);
        if (columns.has(PathColumn::light_sampling_state)) f(a.bsdf_pdf, b.bsdf_pdf), f(a.exit_offset, b.exit_offset);
        if (columns.has(PathColumn::walk_coefficients))
            for_columns(a.walk_extinction, b.walk_extinction, f), for_columns(a.walk_albedo, b.walk_albedo, f);
        if (columns.has(PathColumn::light_tracing)) f(a.connection, b.connection), f(a.scatter_pdf, b.scatter_pdf);
        if (columns.has(PathColumn::gathered)) f(a.gathered, b.gathered);
    }
    /// The position of the pixel in the job.
    template <class Word>
    static Word pixel_of(Word state)
    {
        return (state >> pixel_shift) & Word(max_pixels - 1);
    }
};

/// Result of tracing the pool, one entry per path.
struct HitColumns {
    Column<float> t, u, v;
    Column<std::uint32_t> primitive, instance;
    Column<std::uint32_t> material;  ///< material that a mixture chose, see SurfaceHit

    /// Calls f(column of a, column of b) for each column; instance and material only if used.
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
