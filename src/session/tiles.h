// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fathom/job.h"

namespace fathom {

/// Number of samples per task, which keeps the kernel's pool full and still balances the threads.
inline constexpr std::uint64_t samples_per_job = 1u << 15;

/// Square tiles of the image, in rows.
class Tiles {
public:
    Tiles(Crop crop, int size) : crop_(crop), size_(size)
    {
        columns_ = (crop.x1 - crop.x0 + size - 1) / size;
        rows_ = (crop.y1 - crop.y0 + size - 1) / size;
    }
    std::size_t count() const { return std::size_t(columns_) * std::size_t(rows_); }
    /// Pixels of a tile, x in the low 16 bits and y above, in Morton order, which keeps neighbors in the list close in
    /// the image.
    void pixels(std::size_t tile, std::vector<std::uint32_t>& list) const
    {
        list.clear();
        const int x0 = crop_.x0 + int(tile % std::size_t(columns_)) * size_;
        const int y0 = crop_.y0 + int(tile / std::size_t(columns_)) * size_;
        for (std::uint32_t code = 0; code < std::uint32_t(size_ * size_); ++code) {
            const int x = x0 + even_bits(code), y = y0 + even_bits(code >> 1);
            if (x < crop_.x1 && y < crop_.y1) list.push_back(std::uint32_t(y) << 16 | std::uint32_t(x));
        }
    }

private:
    static int even_bits(std::uint32_t code)
    {
        int bits = 0;
        for (int i = 0; i < 16; ++i) bits |= int(code >> (2 * i) & 1) << i;
        return bits;
    }
    Crop crop_;
    int size_, columns_, rows_;
};

/// Tile size, a power of two, for about samples_per_job samples per task and several tasks per thread.
inline int tile_size(Crop crop, std::uint64_t samples, int threads)
{
    int size = 4;
    const auto jobs = [&](int s) {
        return std::uint64_t((crop.x1 - crop.x0 + s - 1) / s) * std::uint64_t((crop.y1 - crop.y0 + s - 1) / s);
    };
    const auto pixels = [](int s) { return std::uint64_t(s) * std::uint64_t(s); };
    while (size < 128 && pixels(2 * size) * samples <= samples_per_job && jobs(2 * size) >= 8 * std::uint64_t(threads))
        size *= 2;
    return size;
}

}  // namespace fathom
