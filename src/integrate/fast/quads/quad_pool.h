// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/camera_paths.h"
#include "kernel/pool.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Paths that wait at a vertex on a quad, as a structure of arrays.
struct QuadPool {
    VectorColumn eye;
    SpectrumColumn throughput, radiance;
    /// The quad in the low 15 bits, `scattered` (some event was not a delta lobe), the number of bounces in the next 15
    /// bits, and `back` (the path is on the back of the quad).
    Column<std::uint32_t> place;
    Column<std::uint32_t> pixel_hash, reversed_index, pixel;
    Column<float> eta_scale;  ///< used if some material refracts

    static constexpr std::uint32_t quad_mask = 0x7fff, scattered = 1u << 15, bounce_mask = 0x7fff, back = 1u << 31;
    static constexpr int bounce_shift = 16;

    SampleKey key(std::size_t i) const { return {pixel_hash.load(i), reversed_index.load(i)}; }
    UInt quad(std::size_t i) const { return place.load(i) & UInt(quad_mask); }
    UInt bounces(std::size_t i) const { return (place.load(i) >> bounce_shift) & UInt(bounce_mask); }

    /// Calls f(column) for each column in use.
    template <class F>
    void for_all(bool refracts, F&& f)
    {
        f(eye.x), f(eye.y), f(eye.z);
        for (int c = 0; c < channels; ++c) f(throughput.c[c]), f(radiance.c[c]);
        f(place), f(pixel_hash), f(reversed_index), f(pixel);
        if (refracts) f(eta_scale);
    }
};

/// Paths on quads that are not plain, all of one ClosureKind.
struct ClosureQuadPool : QuadPool {
    std::uint32_t kind;
    std::size_t end;         ///< slot of the next path
    VectorColumn direction;  ///< direction along which the path arrived
    Column<float> offset;    ///< distance of the eye from the quad
};

}  // namespace FATHOM_LANES
}  // namespace fathom
