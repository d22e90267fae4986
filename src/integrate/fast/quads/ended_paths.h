// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "film/tile_sums.h"
#include "kernel/pool.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Buffers the radiance of finished paths and adds it to the film in batches.
class FinishedPaths {
public:
    explicit FinishedPaths(TileSums& sums) : sums_(sums) {}

    /// Adds the paths of the mask. pixels: positions in the job; reversed_index: see SampleKey.
    [[gnu::always_inline]] void add(Mask ended, UInt pixels, UInt reversed_index, const Spectrum& radiance)
    {
        Float largest = abs(radiance.c[0]);
        for (int c = 1; c < channels; ++c) largest = max(abs(radiance.c[c]), largest);
        // NaN must not count as small. max() may lose a NaN, which the comparison of the sum with itself finds.
        Float total = radiance.c[0];
        for (int c = 1; c < channels; ++c) total = total + radiance.c[c];
        const Mask small = ended & (largest < Float(TileSums::small)) & (total == total);
        if (const Mask large = ended & !small; any(large)) sum_large(large, pixels, reversed_index, radiance);
        pixel_.append(size_, pixels, small);
        radiance_.append(size_, radiance, small);
        size_ += std::size_t(count(small));
        if (size_ > pool_capacity - lanes) sum();
    }
    /// Adds all buffered paths to the film.
    [[gnu::noinline]] void sum()
    {
        for (std::size_t k = 0; k < size_; ++k)
            sums_.add_small(pixel_[k], radiance_.c[0][k], radiance_.c[1][k], radiance_.c[2][k]);
        size_ = 0;
    }

private:
    [[gnu::noinline]] void sum_large(Mask m, UInt pixels, UInt reversed_index, Spectrum radiance)
    {
        std::uint32_t pixel_of[lanes], sample[lanes];
        float value[channels][lanes];
        store(pixel_of, pixels), store(sample, reverse_bits(reversed_index));
        for (int c = 0; c < channels; ++c) store(value[c], radiance.c[c]);
        for_each_active(m, [&](int k) { sums_.add(pixel_of[k], sample[k], value[0][k], value[1][k], value[2][k]); });
    }

    TileSums& sums_;
    std::size_t size_ = 0;
    Column<std::uint32_t> pixel_;
    SpectrumColumn radiance_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
