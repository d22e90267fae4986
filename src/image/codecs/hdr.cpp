// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

#include "image/codecs/codecs.h"

// Radiance's RGBE encoding: G. Ward, "Real Pixels", Graphics Gems II, 1991. Run lengths follow Radiance's
// ray/src/common/color.c.
namespace fathom {

namespace {

using Rgbe = std::array<unsigned char, 4>;

Rgbe rgbe_from(const float* pixel, const DisplayChannels& channels)
{
    // The largest value of the shared-exponent encoding.
    constexpr float largest = 0x1.fep126f;
    std::array<float, 3> rgb = {pixel[channels.r], pixel[channels.g], pixel[channels.b]};
    // NaN and negative values can't be encoded.
    for (float& v : rgb) v = v > 0 ? std::min(v, largest) : 0;
    const float top = std::max({rgb[0], rgb[1], rgb[2]});
    if (top < 1e-32f) return {0, 0, 0, 0};
    int exponent = 0;
    std::frexp(top, &exponent);
    // Mantissas are rounded to nearest; a mantissa that rounds up to 256 needs the next exponent.
    if (std::lround(std::ldexp(top, 8 - exponent)) > 255) ++exponent;
    Rgbe code;
    for (int c = 0; c < 3; ++c) code[c] = static_cast<unsigned char>(std::lround(std::ldexp(rgb[c], 8 - exponent)));
    code[3] = static_cast<unsigned char>(exponent + 128);
    return code;
}

/// Appends one component of a row as runs (128 + length, value) of at least 4 and literals (length, values).
void append_runs(std::vector<unsigned char>& out, const std::vector<Rgbe>& row, int component)
{
    const std::size_t width = row.size();
    const auto run_at = [&](std::size_t i) {
        std::size_t n = 1;
        while (n < 127 && i + n < width && row[i + n][component] == row[i][component]) ++n;
        return n;
    };
    std::size_t i = 0;
    while (i < width) {
        const std::size_t run = run_at(i);
        if (run >= 4) {
            out.push_back(static_cast<unsigned char>(128 + run));
            out.push_back(row[i][component]);
            i += run;
            continue;
        }
        std::size_t end = i + run;
        while (end < width && end - i < 128 && run_at(end) < 4) ++end;
        out.push_back(static_cast<unsigned char>(end - i));
        for (; i < end; ++i) out.push_back(row[i][component]);
    }
}

}  // namespace

std::vector<unsigned char> encode_hdr(const Image& image)
{
    const Image::Layer& layer = image.layers[0];
    const DisplayChannels channels = display_channels(layer);
    const std::string header =
        fmt::format("#?RADIANCE\nSOFTWARE=Fathom\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", image.height, image.width);
    std::vector<unsigned char> out(header.begin(), header.end());
    const std::size_t width = std::size_t(image.width);
    // Compressed rows store the width in 15 bits, and readers take rows below 8 pixels as uncompressed.
    const bool runs = width >= 8 && width < 32768;
    std::vector<Rgbe> row(width);
    const float* pixel = layer.pixels.data();
    for (int y = 0; y < image.height; ++y) {
        for (std::size_t x = 0; x < width; ++x, pixel += layer.channels.size()) row[x] = rgbe_from(pixel, channels);
        if (runs) {
            out.insert(out.end(),
                       {2, 2, static_cast<unsigned char>(width >> 8), static_cast<unsigned char>(width & 255)});
            for (int component = 0; component < 4; ++component) append_runs(out, row, component);
        } else {
            for (const Rgbe& code : row) out.insert(out.end(), code.begin(), code.end());
        }
    }
    return out;
}

}  // namespace fathom
