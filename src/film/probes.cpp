// SPDX-License-Identifier: Apache-2.0
#include "film/probes.h"

namespace fathom {

namespace {

constexpr int cell_width = 32;
/// Pixels that hold the sums of a probe.
constexpr int sum_pixels = 3;

/// Place of the probe in its cell: points of the R2 sequence (Roberts 2018), which spread evenly over rows and columns.
int place_in_cell(int cell, int row)
{
    const std::uint32_t fraction = std::uint32_t(cell) * 0xc13fa9a9u + std::uint32_t(row) * 0x91e10da5u;
    return int(std::uint64_t(fraction) * cell_width >> 32);
}

}  // namespace

std::vector<Probe> probes_of(int width, Crop pixels)
{
    std::vector<Probe> probes;
    for (int y = pixels.y0; y < pixels.y1; ++y)
        for (int x0 = pixels.x0, cell = 0; x0 + sum_pixels <= pixels.x1; x0 += cell_width, ++cell) {
            // The place is drawn from a whole cell even at the right border, so that all pixels are equally likely.
            const int x = x0 + place_in_cell(cell, y);
            if (x >= pixels.x1) continue;
            const std::size_t first = std::size_t(y) * std::size_t(width) + std::size_t(x0);
            probes.push_back({x, y, first, (cell + y) % 2 != 0});
        }
    return probes;
}

std::uint32_t probe_seed(std::uint32_t seed)
{
    return seed ^ 0x9e3779b9u;
}

}  // namespace fathom
