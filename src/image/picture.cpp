// SPDX-License-Identifier: Apache-2.0
#include "image/picture.h"

#include <bit>
#include <cstddef>

#include "image/codecs/codecs.h"

namespace fathom {

// Texels take the bytes of a file in memory order.
static_assert(std::endian::native == std::endian::little);

ByteImage::ByteImage(int w, int h, int c)
    : width(w), height(h), channels(c), texels(std::size_t(w) * std::size_t(h), 0xff000000u)
{
}

Image to_image(const ByteImage& picture, const std::string& name, std::uint64_t memory_limit)
{
    const std::size_t count = std::size_t(picture.channels);
    check_size({name, nullptr, 0, memory_limit}, std::uint64_t(picture.width), std::uint64_t(picture.height),
               count * sizeof(float) + sizeof(std::uint32_t));
    Image image = make_image(picture.width, picture.height, picture.channels);
    const int shift[] = {0, count == 2 ? 24 : 8, 16, 24};
    float* value = image.layers[0].pixels.data();
    for (const std::uint32_t texel : picture.texels)
        for (std::size_t c = 0; c < count; ++c) *value++ = float(texel >> shift[c] & 0xffu) / 255;
    return image;
}

}  // namespace fathom
