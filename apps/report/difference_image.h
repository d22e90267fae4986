// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "render/comparison.h"

namespace fathom::cli {

/// An image of a comparison that explains itself: the FLIP map (or, of layers that are no colors, the difference) in
/// the colors of magma, outlines of blocks that noise does not explain, a scale and the numbers. Colors are linear, to
/// be written without a tone curve.
Image difference_picture(const Comparison& comparison);

/// Writes the picture, or for EXR the values: the map as a layer Y.
void write_difference(const std::filesystem::path& file, const Comparison& comparison);

}  // namespace fathom::cli
