// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>
#include <vector>

#include "fathom/image.h"

namespace fathom {

/// Layers of two images with the same channels and color space.
struct ComparableLayers {
    Image::Layer image, reference;
    bool is_linear = false;            ///< whether colors are linear, not encoded as sRGB
    Chromaticities space{};            ///< primaries of linear colors
    std::vector<std::string> notes{};  ///< what was converted or assumed, in sentences
};

/// Red, green and blue of a layer on black, pixel by pixel.
using Colors = std::vector<std::array<float, 3>>;

/// Returns the layers of that name in one form. Throws Error where compare_images() does.
ComparableLayers comparable_layers(const Image& image, const std::string& image_name, const Image& reference,
                                   const std::string& reference_name, const std::string& layer);

/// Whether a layer of an image holds colors or grays, for which perceived differences make sense.
bool has_colors(const Image::Layer& layer);

/// Returns the colors of `layers.image` or `layers.reference` in linear Rec.709.
Colors linear_colors(const ComparableLayers& layers, const Image::Layer& layer);

}  // namespace fathom
