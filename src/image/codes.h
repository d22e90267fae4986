// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

#include <tbb/parallel_for.h>

#include "fathom/image.h"

namespace fathom {

/// Calls `write(layer pixel, first code of the pixel)` for every pixel, on all threads.
///
/// codes  output, `channels` codes for each pixel
template <class Code, class Write>
void encode_pixels(const Image::Layer& layer, int channels, Code* codes, Write write)
{
    const std::size_t stride = layer.channels.size();
    const tbb::blocked_range<std::size_t> pixels(0, layer.pixels.size() / stride, 1 << 14);
    tbb::parallel_for(pixels, [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            write(layer.pixels.data() + i * stride, codes + i * std::size_t(channels));
    });
}

}  // namespace fathom
