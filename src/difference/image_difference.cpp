// SPDX-License-Identifier: Apache-2.0
#include "fathom/image_difference.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "difference/comparable.h"
#include "difference/flip.h"
#include "fathom/memory.h"
#include "image/color/tonemap.h"

namespace fathom {

namespace {

double absolute_difference(float a, float b)
{
    if (a == b || (std::isnan(a) && std::isnan(b))) return 0;
    if (!std::isfinite(a) || !std::isfinite(b)) return std::numeric_limits<double>::infinity();
    return std::abs(double(a) - double(b));
}

/// Compares the stored values of all pixels.
void compare_values(const ComparableLayers& layers, double tolerance, ImageDifference& result)
{
    const std::size_t stride = layers.image.channels.size(), pixels = layers.image.pixels.size() / stride;
    result.differences.resize(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        double largest = 0;
        bool is_finite = true;
        for (std::size_t c = 0; c < stride; ++c) {
            const float a = layers.image.pixels[i * stride + c], b = layers.reference.pixels[i * stride + c];
            is_finite = is_finite && std::isfinite(a) && std::isfinite(b);
            const double difference = absolute_difference(a, b);
            largest = std::max(largest, difference);
            if (difference > result.largest.difference)
                result.largest = {difference,
                                  int(i % std::size_t(result.width)),
                                  int(i / std::size_t(result.width)),
                                  layers.image.channels[c],
                                  a,
                                  b};
        }
        result.differences[i] = float(largest);
        result.invalid_pixels += is_finite ? 0 : 1;
        result.different_pixels += largest > tolerance ? 1 : 0;
    }
}

bool is_finite(const std::array<float, 3>& c)
{
    return std::isfinite(c[0]) && std::isfinite(c[1]) && std::isfinite(c[2]);
}

/// Largest value of the finite colors.
double brightest(const Colors& colors)
{
    float result = 0;
    for (const auto& color : colors)
        if (is_finite(color)) result = std::max({result, color[0], color[1], color[2]});
    return double(result);
}

/// Sets `mse`, `psnr_db` and `relmse`. Display values are compared as sRGB encodes them.
void compare_means(const Colors& image, const Colors& reference, bool is_linear, ColorDifference& result)
{
    const auto stored = [&](float v) { return is_linear ? double(v) : srgb_from_linear(double(v)); };
    double squares = 0, relative = 0, count = 0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        if (!is_finite(image[i]) || !is_finite(reference[i])) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const double x = double(image[i][c]), r = double(reference[i][c]);
            const double difference = stored(image[i][c]) - stored(reference[i][c]);
            squares += difference * difference;
            relative += (x - r) * (x - r) / (r * r + 0.01);
        }
        count += 3;
    }
    if (count == 0) return;
    result.mse = squares / count, result.relmse = relative / count;
    result.peak = is_linear ? brightest(reference) : 1;
    if (result.mse > 0 && result.peak > 0) result.psnr_db = 10 * std::log10(result.peak * result.peak / result.mse);
}

/// Replaces colors that are not finite by black, and returns their pixels.
std::vector<std::size_t> blacken_invalid(Colors& colors)
{
    std::vector<std::size_t> invalid;
    for (std::size_t i = 0; i < colors.size(); ++i)
        if (!is_finite(colors[i])) {
            invalid.push_back(i);
            colors[i] = {};
        }
    return invalid;
}

/// FLIP of finite colors. Pixels that are finite in one image only have the largest value, 1.
Flip compare_perceived(Colors image, Colors reference, const ImageDifference& about)
{
    Flip flip;
    flip.map.resize(image.size());
    if (about.largest.difference == 0) return flip;
    std::vector<std::size_t> invalid = blacken_invalid(image);
    const std::vector<std::size_t> others = blacken_invalid(reference);
    invalid.insert(invalid.end(), others.begin(), others.end());
    flip = (about.is_linear ? flip_of_radiance : flip_of_display)(image, reference, about.width, about.height);
    for (const std::size_t i : invalid)
        if (std::isinf(about.differences[i])) flip.map[i] = 1;
    double sum = 0;
    for (const float value : flip.map) sum += double(value);
    flip.mean = sum / double(flip.map.size());
    flip.max = double(*std::max_element(flip.map.begin(), flip.map.end()));
    return flip;
}

/// Throws Error if the planes of FLIP don't fit into memory.
void check_flip_memory(const std::string& name, const Image& image)
{
    constexpr double bytes_per_pixel = 160;
    check_memory(name, {{"comparison", bytes_per_pixel * image.width * image.height}});
}

}  // namespace

ImageDifference compare_images(const Image& image, const std::string& image_name, const Image& reference,
                               const std::string& reference_name, const CompareOptions& options)
{
    ComparableLayers layers = comparable_layers(image, image_name, reference, reference_name, options.layer);
    ImageDifference result;
    result.width = image.width, result.height = image.height;
    result.is_linear = image.is_linear;
    compare_values(layers, options.tolerance, result);
    if (has_colors(layers.image)) {
        check_flip_memory(image_name, image);
        const Colors a = linear_colors(layers, layers.image), b = linear_colors(layers, layers.reference);
        ColorDifference& color = result.color.emplace();
        compare_means(a, b, image.is_linear, color);
        color.flip = compare_perceived(a, b, result);
    }
    result.notes = std::move(layers.notes);
    return result;
}

}  // namespace fathom
