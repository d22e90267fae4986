// SPDX-License-Identifier: Apache-2.0
#include "difference/comparable.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "fathom/error.h"
#include "image/color/primaries.h"
#include "image/color/tonemap.h"

namespace fathom {

namespace {

constexpr std::size_t no_channel = ~std::size_t(0);

std::size_t channel_index(const Image::Layer& layer, const char* name)
{
    const auto found = std::find(layer.channels.begin(), layer.channels.end(), name);
    return found == layer.channels.end() ? no_channel : std::size_t(found - layer.channels.begin());
}

std::string layer_names(const Image& image)
{
    std::vector<std::string> names;
    for (const Image::Layer& layer : image.layers)
        if (!layer.name.empty()) names.push_back(layer.name);
    return names.empty() ? "no layers" : fmt::format("{}", fmt::join(names, ", "));
}

const Image::Layer& find_layer(const Image& image, const std::string& file, const std::string& name)
{
    if (name.empty()) return image.layers.front();
    if (const Image::Layer* layer = image.find(name)) return *layer;
    throw Error(file, "", fmt::format("it has no layer '{}', but {}", name, layer_names(image)));
}

void check_sizes(const Image& image, const std::string& name, const Image& reference, const std::string& reference_name)
{
    if (image.width != reference.width || image.height != reference.height)
        throw Error(name, "",
                    fmt::format("the image is {}x{}, but {} is {}x{}: only images of the same size can be compared",
                                image.width, image.height, reference_name, reference.width, reference.height));
}

/// Throws Error unless both images are linear, or both are encoded for displays.
void check_encodings(const Image& image, const std::string& name, const Image& reference,
                     const std::string& reference_name)
{
    if (image.is_linear == reference.is_linear) return;
    const auto kind = [](const Image& i) { return i.is_linear ? "linear radiance" : "tone mapped"; };
    throw Error(name, "",
                fmt::format("the image is {}, but {} is {}: compare EXR with EXR or HDR, and PNG with PNG, JPEG, WebP "
                            "or AVIF",
                            kind(image), reference_name, kind(reference)));
}

Chromaticities chromaticities_of(const Image& image)
{
    return image.chromaticities.value_or(rec709_chromaticities);
}

void convert_to_rec709(Image::Layer& layer, const Chromaticities& space)
{
    if (!is_same(space, rec709_chromaticities)) convert(layer, conversion(space, rec709_chromaticities));
}

/// Converts the layers to linear Rec.709 if their color spaces differ.
void match_spaces(ComparableLayers& layers, const Chromaticities& image, const Chromaticities& reference)
{
    layers.space = image;
    if (!layers.is_linear || !has_colors(layers.image) || is_same(image, reference)) return;
    convert_to_rec709(layers.image, image);
    convert_to_rec709(layers.reference, reference);
    layers.space = rec709_chromaticities;
    layers.notes.emplace_back("the color spaces differ: both images were converted to linear Rec.709");
}

/// Returns a color layer with the channels R, G, B and A; a missing alpha is 1.
Image::Layer with_rgba(const Image::Layer& layer)
{
    const std::size_t gray = channel_index(layer, "Y"), alpha = channel_index(layer, "A");
    std::array<std::size_t, 4> from{channel_index(layer, "R"), channel_index(layer, "G"), channel_index(layer, "B"),
                                    alpha};
    for (std::size_t& index : from)
        if (index == no_channel && &index != &from[3]) index = gray;
    Image::Layer result{layer.name, {"R", "G", "B", "A"}, {}};
    const std::size_t stride = layer.channels.size(), pixels = layer.pixels.size() / stride;
    result.pixels.resize(4 * pixels);
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t c = 0; c < 4; ++c)
            result.pixels[4 * i + c] = from[c] == no_channel ? 1 : layer.pixels[i * stride + from[c]];
    return result;
}

/// Gives both layers the same channels, or throws Error.
void match_channels(ComparableLayers& layers, const std::string& name, const std::string& reference_name)
{
    Image::Layer &a = layers.image, &b = layers.reference;
    if (a.channels == b.channels) return;
    if (!has_colors(a) || !has_colors(b))
        throw Error(name, a.name,
                    fmt::format("it has the channels {}, but that of {} has {}", fmt::join(a.channels, ", "),
                                reference_name, fmt::join(b.channels, ", ")));
    const bool a_has_alpha = channel_index(a, "A") != no_channel;
    if (a_has_alpha != (channel_index(b, "A") != no_channel))
        layers.notes.push_back(
            fmt::format("{} has no alpha: it counts as opaque", a_has_alpha ? reference_name : name));
    a = with_rgba(a), b = with_rgba(b);
}

}  // namespace

bool has_colors(const Image::Layer& layer)
{
    const auto has = [&](const char* name) { return channel_index(layer, name) != no_channel; };
    const bool is_noise = layer.name == "variance" || layer.name == "error" || layer.name == "samples";
    return !is_noise && ((has("R") && has("G") && has("B")) || has("Y"));
}

ComparableLayers comparable_layers(const Image& image, const std::string& image_name, const Image& reference,
                                   const std::string& reference_name, const std::string& layer)
{
    check_sizes(image, image_name, reference, reference_name);
    check_encodings(image, image_name, reference, reference_name);
    ComparableLayers layers{find_layer(image, image_name, layer), find_layer(reference, reference_name, layer)};
    layers.is_linear = image.is_linear;
    match_channels(layers, image_name, reference_name);
    match_spaces(layers, chromaticities_of(image), chromaticities_of(reference));
    return layers;
}

Colors linear_colors(const ComparableLayers& layers, const Image::Layer& layer)
{
    Image::Layer rgba = with_rgba(layer);
    if (layers.is_linear) convert_to_rec709(rgba, layers.space);
    Colors colors(rgba.pixels.size() / 4);
    for (std::size_t i = 0; i < colors.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const float value = rgba.pixels[4 * i + c], alpha = rgba.pixels[4 * i + 3];
            colors[i][c] = layers.is_linear ? value : float(linear_from_srgb(double(value)) * double(alpha));
        }
    return colors;
}

}  // namespace fathom
