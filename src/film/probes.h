// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fathom/job.h"

namespace fathom {

/// A pixel that is rendered a second time, with independent random numbers and as many samples. The difference of both
/// results shows how large the error of the pixel is.
struct Probe {
    int x = 0, y = 0;
    /// Index of the first of the three pixels, next to each other, whose FilmLayout::probe sums are the red, green and
    /// blue of the second result.
    std::size_t sums = 0;
    /// Which of two disjoint sets the probe belongs to: the set that decides when to stop, or the one that reports.
    bool decides = false;
};

/// Returns the probes of an image in rows from the top: one in each cell of 32 pixels of a row. Both sets alternate
/// like the squares of a chessboard.
///
/// width   Width of the whole image in pixels.
/// pixels  The rectangle of pixels that is rendered.
std::vector<Probe> probes_of(int width, Crop pixels);

/// Returns the seed of the second results of a render with this seed.
std::uint32_t probe_seed(std::uint32_t seed);

}  // namespace fathom
