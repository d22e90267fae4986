// SPDX-License-Identifier: Apache-2.0
#include "image/codecs/exr_luminance.h"

#include <ImfArray.h>
#include <ImfRgbaFile.h>
#include <ImfRgbaYca.h>
#include <ImfStandardAttributes.h>

#include <algorithm>

#include "fathom/error.h"
#include "image/codecs/exr_parts.h"

namespace fathom {

namespace {

std::size_t place_of(const Image::Layer& layer, const char* channel)
{
    const auto found = std::find(layer.channels.begin(), layer.channels.end(), channel);
    return std::size_t(found - layer.channels.begin());
}
bool has(const Image::Layer& layer, const char* channel)
{
    return place_of(layer, channel) < layer.channels.size();
}

/// Replaces channels Y, RY and BY of a layer by R, G and B; `color(pixel index)` gives the three values.
template <class Color>
void replace_luminance(Image::Layer& layer, const Color& color)
{
    const auto is_other = [](const std::string& c) { return c != "Y" && c != "RY" && c != "BY"; };
    const std::size_t before = layer.channels.size();
    std::vector<std::size_t> others;
    std::vector<std::string> channels{"R", "G", "B"};
    for (std::size_t c = 0; c < before; ++c)
        if (is_other(layer.channels[c])) {
            others.push_back(c);
            channels.push_back(layer.channels[c]);
        }
    const std::size_t pixels = layer.pixels.size() / before;
    std::vector<float> values;
    values.reserve(pixels * channels.size());
    for (std::size_t i = 0; i < pixels; ++i) {
        for (const float v : color(i)) values.push_back(v);
        for (const std::size_t c : others) values.push_back(layer.pixels[i * before + c]);
    }
    layer.channels = std::move(channels);
    layer.pixels = std::move(values);
}

std::array<float, 3> rgb_of(float y, float ry, float by, const Imath::V3f& weights)
{
    const float r = (ry + 1) * y, b = (by + 1) * y;
    return {r, (y - r * weights.x - b * weights.z) / weights.y, b};
}

/// Reads chroma at half resolution with OpenEXR's reconstruction filter, which matches the filter of its writer.
void add_half_chroma(Image::Layer& layer, const EncodedImage& file, int threads)
{
    ExrMemoryInput stream(file);
    Imf::RgbaInputFile input(stream, layer.name, threads);
    const Imath::Box2i window = input.dataWindow();
    const std::ptrdiff_t width = std::ptrdiff_t(window.max.x) - window.min.x + 1;
    std::vector<Imf::Rgba> pixels(layer.pixels.size() / layer.channels.size());
    input.setFrameBuffer(pixels.data() - (window.min.x + width * window.min.y), 1, std::size_t(width));
    input.readPixels(window.min.y, window.max.y);
    replace_luminance(layer,
                      [&](std::size_t i) { return std::array<float, 3>{pixels[i].r, pixels[i].g, pixels[i].b}; });
}

}  // namespace

bool is_half_chroma(const std::string& channel, const Imf::Channel& format)
{
    return (channel == "RY" || channel == "BY") && format.xSampling == 2 && format.ySampling == 2;
}

void add_chroma(Image& image, const EncodedImage& file, const Imf::Header& header, bool is_later_part, int threads)
{
    const Imf::Chromaticities primaries =
        Imf::hasChromaticities(header) ? Imf::chromaticities(header) : Imf::Chromaticities();
    const Imath::V3f weights = Imf::RgbaYca::computeYw(primaries);
    for (Image::Layer& layer : image.layers) {
        if (!has(layer, "Y") || has(layer, "R")) continue;
        const std::size_t y = place_of(layer, "Y"), ry = place_of(layer, "RY"), by = place_of(layer, "BY");
        if (has(layer, "RY") && has(layer, "BY")) {
            const std::vector<float> values = layer.pixels;
            const std::size_t stride = layer.channels.size();
            replace_luminance(layer, [&](std::size_t i) {
                const float* const pixel = &values[i * stride];
                return rgb_of(pixel[y], pixel[ry], pixel[by], weights);
            });
            continue;
        }
        const auto* const half_ry = header.channels().findChannel(full_name(layer.name, "RY"));
        const auto* const half_by = header.channels().findChannel(full_name(layer.name, "BY"));
        if (!half_ry || !half_by || !is_half_chroma("RY", *half_ry) || !is_half_chroma("BY", *half_by)) continue;
        if (is_later_part)
            throw Error(file.name, full_name(layer.name, "RY"),
                        "chroma at half resolution is supported in the first part of a file only");
        add_half_chroma(layer, file, threads);
    }
}

}  // namespace fathom
