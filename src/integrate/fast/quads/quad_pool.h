#pragma once
#include "kernel/camera_paths.h"
#include "kernel/pool.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Paths that wait on a quad each.
struct QuadPool {
    VectorColumn eye;
    SpectrumColumn throughput, radiance;
    /// The quad in its low 15 bits, whether any closure but delta lobes has scattered the path, the bounces so far in
    /// the next 15, and on top whether the path is on the quad's back.
    Column<std::uint32_t> place;
    Column<std::uint32_t> pixel_hash, reversed_index, pixel;
    Column<float> eta_scale;  ///< where something refracts

    static constexpr std::uint32_t quad_mask = 0x7fff, scattered = 1u << 15, bounce_mask = 0x7fff, back = 1u << 31;
    static constexpr int bounce_shift = 16;

    SampleKey key(std::size_t i) const { return {pixel_hash.load(i), reversed_index.load(i)}; }
    UInt quad(std::size_t i) const { return place.load(i) & UInt(quad_mask); }
    UInt bounces(std::size_t i) const { return (place.load(i) >> bounce_shift) & UInt(bounce_mask); }

    template <class F>
    void for_all(bool refracts, F&& f)
    {
        f(eye.x), f(eye.y), f(eye.z);
        for (int c = 0; c < channels; ++c) f(throughput.c[c]), f(radiance.c[c]);
        f(place), f(pixel_hash), f(reversed_index), f(pixel);
        if (refracts) f(eta_scale);
    }
};

/// Of quads that are not plain, those of one ClosureKind.
struct OtherQuadPool : QuadPool {
    std::uint32_t kind;
    std::size_t end;         ///< where the next path goes
    VectorColumn direction;  ///< along which the path came
    Column<float> offset;    ///< of the eye from the quad
};

}  // namespace FATHOM_LANES
}  // namespace fathom
