// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/image.h"

namespace fathom::test {

/// An image whose pixels all have the same values.
inline Image uniform_image(int width, int height, const std::vector<std::string>& channels,
                           const std::vector<float>& values, bool is_linear)
{
    Image image;
    image.width = width, image.height = height;
    image.is_linear = is_linear;
    image.layers.push_back({"", channels, {}});
    for (int i = 0; i < width * height; ++i)
        image.layers[0].pixels.insert(image.layers[0].pixels.end(), values.begin(), values.end());
    return image;
}

}  // namespace fathom::test
