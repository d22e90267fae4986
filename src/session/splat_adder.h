// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <tbb/spin_mutex.h>

#include <array>
#include <cmath>
#include <vector>

#include "film/film_data.h"
#include "kernel/kernel.h"

namespace fathom {

/// Adds splats to `words`, the sums of a whole image, from several threads at once: sums do not depend on the order.
class SplatAdder {
public:
    SplatAdder(const Film::Data& film, Crop crop, std::uint32_t* words) : film_(film), crop_(crop), words_(words) {}

    /// Adds splats. Returns the number of those that are dropped, since a value is not finite.
    std::uint64_t add(const std::vector<LightSplat>& splats)
    {
        std::uint64_t dropped = 0;
        for (std::size_t i = 0; i < splats.size(); ++i) {
            // Splats fall on pixels at random, which are far apart in memory.
            if (i + fetched_ahead < splats.size()) {
                std::uint32_t* const ahead = sums_of(index_of(splats[i + fetched_ahead]));
                __builtin_prefetch(ahead + film_.layout.splats, 1);
                __builtin_prefetch(film_.layout.splat_square(ahead, 2), 1);
            }
            const LightSplat& splat = splats[i];
            const int x = int(splat.pixel & 0xffff), y = int(splat.pixel >> 16);
            if (x < crop_.x0 || x >= crop_.x1 || y < crop_.y0 || y >= crop_.y1) continue;
            const std::size_t index = index_of(splat);
            std::uint32_t* const pixel = sums_of(index);
            if (!std::isfinite(splat.value[0] + splat.value[1] + splat.value[2])) {
                ++dropped;
                continue;
            }
            const tbb::spin_mutex::scoped_lock lock(locks_[index % locks_.size()]);
            for (int c = 0; c < 3; ++c) {
                const double value = splat.value[c];
                ExactSum::add_number(other_sum(pixel, film_.layout.splats + c), value);
                ExactSquareSum::add_number(film_.layout.splat_square(pixel, c), value * value);
            }
        }
        return dropped;
    }

private:
    static constexpr std::size_t fetched_ahead = 16;

    std::size_t index_of(const LightSplat& splat) const
    {
        return std::size_t(splat.pixel >> 16) * std::size_t(film_.width) + (splat.pixel & 0xffff);
    }
    std::uint32_t* sums_of(std::size_t index) const { return words_ + index * std::size_t(film_.layout.words); }

    const Film::Data& film_;
    const Crop crop_;
    std::uint32_t* const words_;
    std::array<tbb::spin_mutex, 1024> locks_;
};

}  // namespace fathom
