// SPDX-License-Identifier: Apache-2.0
#include "dataset/mask_codes.h"

namespace fathom::cli {

namespace {

/// Lengths of alternating runs of 0 and 1, by columns; the first run is of 0 and may be empty.
std::vector<std::int64_t> run_lengths(const std::vector<std::uint16_t>& mask, int width, int height)
{
    std::vector<std::int64_t> runs;
    std::uint16_t value = 0;
    std::int64_t length = 0;
    for (int x = 0; x < width; ++x)
        for (int y = 0; y < height; ++y) {
            const std::uint16_t now = mask[std::size_t(y) * std::size_t(width) + std::size_t(x)];
            if (now != value) {
                runs.push_back(length);
                value = now, length = 0;
            }
            ++length;
        }
    runs.push_back(length);
    return runs;
}

void append_code(std::string& text, std::int64_t number)
{
    bool more = true;
    while (more) {
        const auto bits = int(number & 0x1f);
        number >>= 5;
        more = bits & 0x10 ? number != -1 : number != 0;
        text += char((more ? bits | 0x20 : bits) + '0');
    }
}

}  // namespace

std::string coco_run_lengths(const std::vector<std::uint32_t>& pixels, int width, int height)
{
    const std::vector<std::int64_t> runs = run_lengths(mask_values(pixels, width, height, 1), width, height);
    std::string text;
    for (std::size_t i = 0; i < runs.size(); ++i) append_code(text, i > 2 ? runs[i] - runs[i - 2] : runs[i]);
    return text;
}

std::vector<std::uint16_t> mask_values(const std::vector<std::uint32_t>& pixels, int width, int height,
                                       std::uint16_t value)
{
    std::vector<std::uint16_t> values(std::size_t(width) * std::size_t(height));
    for (const std::uint32_t pixel : pixels) values[pixel] = value;
    return values;
}

}  // namespace fathom::cli
