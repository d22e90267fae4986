// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "fathom/api.h"

namespace fathom {

/// Writes numbers as a gray PNG, without a display transform: depths, ids and masks of data sets.
///
/// file           Name of the file. It is written atomically, as by write_image().
/// width, height  Size in pixels.
/// bits           8 or 16 bits per pixel.
/// values         Pixel values, row by row from the top left; the low bits count.
///
/// Throws Error if writing fails, and std::invalid_argument if the number of values is not width * height.
FATHOM_API void write_gray_png(const std::filesystem::path& file, int width, int height, int bits,
                               const std::vector<std::uint16_t>& values);

}  // namespace fathom
