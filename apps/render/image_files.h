// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/image.h"
#include "options/image_options.h"
#include "report/reporter.h"

namespace fathom::cli {

/// Writes all files of the options and reports each. EXR has all layers; other formats show the layer "denoised", if
/// there is one. A file that can't be written is reported and written elsewhere if possible; the result is false then.
///
/// sums  film sums of the image that EXR files also store, or nullptr
bool write_images(const ImageOptions& options, const Image& image, const Film* sums, const WriteOptions& write,
                  Reporter& reporter);

/// A layer with the number of samples of each pixel.
Image::Layer sample_count_layer(const Film& film);

}  // namespace fathom::cli
