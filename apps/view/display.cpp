// SPDX-License-Identifier: Apache-2.0
#include "display.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fathom::view {

namespace {

/// Value that mark_misses() writes.
constexpr float miss = -1;

/// NaN becomes black.
unsigned char to_byte(double value)
{
    return value > 0 ? static_cast<unsigned char>(std::min(value, 1.0) * 255 + 0.5) : 0;
}

/// A color that differs clearly between neighboring ids.
std::array<unsigned char, 3> color_of_id(std::uint32_t id)
{
    std::uint32_t hash = (id + 1) * 2654435761u;
    hash ^= hash >> 15;
    hash *= 2246822519u;
    hash ^= hash >> 13;
    return {static_cast<unsigned char>(64 + (hash & 0xff) * 191 / 255),
            static_cast<unsigned char>(64 + (hash >> 8 & 0xff) * 191 / 255),
            static_cast<unsigned char>(64 + (hash >> 16 & 0xff) * 191 / 255)};
}

/// Opaque pixels with the colors `color(values of the pixel)`.
template <class ColorOf>
std::vector<unsigned char> fill(const Image::Layer& layer, int width, int height, ColorOf color)
{
    const std::size_t pixels = std::size_t(width) * std::size_t(height), stride = layer.channels.size();
    std::vector<unsigned char> codes(pixels * 4, 255);
    for (std::size_t i = 0; i < pixels; ++i) {
        const std::array<unsigned char, 3> c = color(layer.pixels.data() + i * stride);
        std::copy(c.begin(), c.end(), &codes[i * 4]);
    }
    return codes;
}

}  // namespace

const char* name_of(View view)
{
    constexpr const char* names[view_count] = {"image",    "albedo",   "normal",   "depth",
                                               "position", "instance", "material", "noise"};
    return names[int(view)];
}

void set_aovs(View view, RenderSettings& settings)
{
    switch (view) {
        case View::albedo:
            settings.aovs = {Aov::albedo};
            break;
        case View::normal:
            settings.aovs = {Aov::normal};
            break;
        case View::depth:
            settings.aovs = {Aov::depth};
            break;
        case View::position:
            settings.aovs = {Aov::position};
            break;
        case View::instance:
            settings.aovs = {Aov::instance_id, Aov::depth};
            break;
        case View::material:
            settings.aovs = {Aov::material_id, Aov::depth};
            break;
        case View::image:
        case View::noise:
            settings.aovs = {};
            break;
    }
}

void mark_misses(View view, Image& image)
{
    const Image::Layer* depth = image.find("depth");
    if (!depth || (view != View::instance && view != View::material)) return;
    for (Image::Layer& layer : image.layers) {
        if (layer.name != name_of(view)) continue;
        for (std::size_t i = 0; i < layer.pixels.size(); ++i)
            if (std::isinf(depth->pixels[i])) layer.pixels[i] = miss;
    }
}

const Image::Layer& layer_of(View view, const Image& image)
{
    const std::string name = view == View::image ? "" : view == View::noise ? "variance" : name_of(view);
    const Image::Layer* layer = image.find(name);
    return layer ? *layer : image.layers.front();
}

std::vector<unsigned char> display_pixels(View view, const Image::Layer& layer, int width, int height,
                                          const DisplayScale& scale)
{
    using Codes = std::array<unsigned char, 3>;
    switch (view) {
        case View::image:
            return to_display(layer, width, height, scale.transform);
        case View::albedo:
            return to_display(layer, width, height, {});
        case View::noise: {
            Image::Layer deviation = layer;
            for (float& value : deviation.pixels) value = std::sqrt(value);
            return to_display(deviation, width, height, scale.transform);
        }
        case View::normal:
            return fill(layer, width, height, [](const float* n) {
                return Codes{to_byte(0.5 + 0.5 * n[0]), to_byte(0.5 + 0.5 * n[1]), to_byte(0.5 + 0.5 * n[2])};
            });
        case View::depth:
            return fill(layer, width, height, [&](const float* z) {
                const unsigned char gray = to_byte(scale.distance / (scale.distance + z[0]));
                return Codes{gray, gray, gray};
            });
        case View::position:
            return fill(layer, width, height, [&](const float* p) {
                const auto part = [](double value, double min, double max) {
                    return to_byte(max > min ? (value - min) / (max - min) : 0.5);
                };
                return Codes{part(p[0], scale.bounds.min.x, scale.bounds.max.x),
                             part(p[1], scale.bounds.min.y, scale.bounds.max.y),
                             part(p[2], scale.bounds.min.z, scale.bounds.max.z)};
            });
        case View::instance:
        case View::material:
            return fill(layer, width, height, [](const float* id) {
                return id[0] != miss ? color_of_id(std::uint32_t(id[0])) : Codes{0, 0, 0};
            });
    }
    return {};
}

}  // namespace fathom::view
