// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace fathom::cli {

/// A mask as COCO's compressed run lengths: lengths of runs of 0 and 1 by columns, as differences to the run before the
/// last, in groups of five bits from the character '0' on (pycocotools, maskApi.c).
///
/// pixels  x + y * width of the pixels that are set, ascending
std::string coco_run_lengths(const std::vector<std::uint32_t>& pixels, int width, int height);

/// A mask with `value` where it is set, row by row.
std::vector<std::uint16_t> mask_values(const std::vector<std::uint32_t>& pixels, int width, int height,
                                       std::uint16_t value);

}  // namespace fathom::cli
