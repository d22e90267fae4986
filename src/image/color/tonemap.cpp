// SPDX-License-Identifier: Apache-2.0
#include "image/color/tonemap.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "image/codecs/codecs.h"
#include "image/codes.h"
#include "image/color/ocio.h"
#include "image/color/primaries.h"
#include "image/color/tone_curves.h"

namespace fathom {

namespace {

/// Finds the nearest 8-bit sRGB code of linear light without evaluating a power, exactly as by the formula; viewers
/// convert every frame.
///
/// The upper bits of the float select a bucket; within a bucket at most one threshold to the next code lies.
class SrgbTable {
public:
    SrgbTable()
    {
        for (int code = 1; code < 256; ++code) threshold_[code] = float(linear_from_srgb((code - 0.5) / 255));
        threshold_[0] = 0;
        threshold_[256] = 2;
        int code = 0;
        for (std::uint32_t i = 0; i < first_code_.size(); ++i) {
            const float start = std::bit_cast<float>((i + first_bucket) << shift);
            while (threshold_[code + 1] <= start) ++code;
            first_code_[i] = static_cast<unsigned char>(code);
        }
    }

    unsigned char code(float linear) const
    {
        // The code is free of branches, which noise would make unpredictable. The operand order turns NaN into the
        // smallest value.
        linear = linear > smallest ? linear : smallest;
        linear = linear < largest ? linear : largest;
        const unsigned code = first_code_[(std::bit_cast<std::uint32_t>(linear) >> shift) - first_bucket];
        return static_cast<unsigned char>(code + unsigned(linear >= threshold_[code + 1]));
    }

private:
    static constexpr int shift = 16;                  // keeps 7 bits of mantissa: 128 buckets per octave
    static constexpr float smallest = 0x1p-13f;       // code 1 begins at 0.5 / 255 / 12.92 = 1.5e-4
    static constexpr float largest = 0x1.fffffep-1f;  // code 255 begins at 0.9955
    static constexpr std::uint32_t first_bucket = std::bit_cast<std::uint32_t>(smallest) >> shift;
    std::array<float, 257> threshold_;
    std::array<unsigned char, 13 * 128> first_code_;
};

const SrgbTable& srgb_table()
{
    static const SrgbTable table;
    return table;
}

/// Clamps to [0, 1]; NaN becomes 0.
float clamp_unit(float x)
{
    return x > 0 ? std::min(x, 1.0f) : 0.0f;
}

}  // namespace

double srgb_from_linear(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double linear_from_srgb(double encoded)
{
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

DisplayMap::DisplayMap(const DisplayTransform& display)
    : scale_(float(std::exp2(display.exposure_ev))), tonemap_(display.tonemap), ocio_(display.ocio)
{
    if (!display.white_kelvin) return;
    const ColorMatrix matrix = white_balance(*display.white_kelvin);
    balance_.emplace();
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) (*balance_)[i][k] = float(matrix[i][k]);
}

Color DisplayMap::exposed(const Color& radiance) const
{
    // Tone curves reach 1 long before this limit, beyond which their squares would overflow.
    constexpr float most = 1e6f;
    const auto limited = [&](float x) { return x > 0 ? std::min(x, most) : 0.0f; };
    const Color c = {limited(radiance.r * scale_), limited(radiance.g * scale_), limited(radiance.b * scale_)};
    if (!balance_) return c;
    const auto row = [&](std::size_t i) {
        const auto& m = (*balance_)[i];
        return limited(m[0] * c.r + m[1] * c.g + m[2] * c.b);
    };
    return {row(0), row(1), row(2)};
}

/// OpenColorIO's display values are encoded already.
Color DisplayMap::display_value(const Color& radiance) const
{
    const Color c = exposed(radiance);
    float rgb[3] = {c.r, c.g, c.b};
    ocio_->apply(rgb);
    return {rgb[0], rgb[1], rgb[2]};
}

std::array<unsigned char, 3> DisplayMap::codes8(const Color& radiance) const
{
    if (ocio_) {
        const Color c = display_value(radiance);
        return {unit8(c.r), unit8(c.g), unit8(c.b)};
    }
    const SrgbTable& table = srgb_table();
    const Color c = tone_map(tonemap_, exposed(radiance));
    return {table.code(c.r), table.code(c.g), table.code(c.b)};
}

std::array<std::uint16_t, 3> DisplayMap::codes16(const Color& radiance) const
{
    if (ocio_) {
        const Color c = display_value(radiance);
        return {unit16(c.r), unit16(c.g), unit16(c.b)};
    }
    const auto code = [](float x) { return std::uint16_t(srgb_from_linear(x) * 65535 + 0.5); };
    const Color c = tone_map(tonemap_, exposed(radiance));
    return {code(c.r), code(c.g), code(c.b)};
}

unsigned char unit8(float value)
{
    return static_cast<unsigned char>(clamp_unit(value) * 255 + 0.5f);
}
std::uint16_t unit16(float value)
{
    return std::uint16_t(clamp_unit(value) * 65535 + 0.5f);
}

DisplayChannels display_channels(const Image::Layer& layer)
{
    const auto index = [&](const char* name) {
        const auto found = std::find(layer.channels.begin(), layer.channels.end(), name);
        return found == layer.channels.end() ? -1 : int(found - layer.channels.begin());
    };
    DisplayChannels channels{index("R"), index("G"), index("B"), index("A")};
    if (channels.r < 0 || channels.g < 0 || channels.b < 0) {
        const bool three = layer.channels.size() >= 3;
        channels.r = 0;
        channels.g = three ? 1 : 0;
        channels.b = three ? 2 : 0;
    }
    return channels;
}

std::vector<unsigned char> to_display(const Image::Layer& layer, int width, int height, const DisplayTransform& display)
{
    const DisplayMap map(display);
    const DisplayChannels channels = display_channels(layer);
    std::vector<unsigned char> codes(std::size_t(width) * std::size_t(height) * 4);
    encode_pixels(layer, 4, codes.data(), [&](const float* pixel, unsigned char* code) {
        float straight = 1;
        code[3] = 255;
        if (channels.a >= 0) {
            const float a = pixel[channels.a];
            code[3] = unit8(a);
            straight = a > 0 ? 1 / a : 0;
        }
        const auto rgb =
            map.codes8({pixel[channels.r] * straight, pixel[channels.g] * straight, pixel[channels.b] * straight});
        std::copy(rgb.begin(), rgb.end(), code);
    });
    return codes;
}

}  // namespace fathom
