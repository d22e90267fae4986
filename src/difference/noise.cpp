// SPDX-License-Identifier: Apache-2.0
#include "fathom/noise_test.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "difference/comparable.h"
#include "difference/student_t.h"
#include "image/color/primaries.h"

namespace fathom {

namespace {

/// Number of samples per pixel, from the attributes or the layer "samples"; 0 if it is unknown.
double samples_per_pixel(const Image& image)
{
    if (const auto found = image.attributes.find("fathom.samples_per_pixel"); found != image.attributes.end()) {
        double count = 0;
        const std::string& text = found->second;
        std::from_chars(text.data(), text.data() + text.size(), count);
        return count;
    }
    const Image::Layer* layer = image.find("samples");
    return layer ? double(*std::max_element(layer->pixels.begin(), layer->pixels.end())) : 0;
}

/// The variances of the pixels' means, or null.
const Image::Layer* variance_layer(const Image& image)
{
    const Image::Layer* layer = image.find("variance");
    return layer && layer->channels == std::vector<std::string>{"R", "G", "B"} ? layer : nullptr;
}

/// Largest relative rounding of stored values: half precision if all values have it.
double relative_rounding(const Image::Layer& layer)
{
    const auto is_half = [](float v) {
        int exponent = 0;
        const float mantissa = std::frexp(v, &exponent);
        return !std::isfinite(v) || std::ldexp(mantissa, 11) == std::trunc(std::ldexp(mantissa, 11));
    };
    return std::all_of(layer.pixels.begin(), layer.pixels.end(), is_half) ? 0x1p-11 : 0x1p-23;
}

/// The colors of a render, with the variances of their samples and their rounding.
class NoisyColors {
public:
    explicit NoisyColors(const Image& image)
        : variances_(*variance_layer(image)),
          samples_(samples_per_pixel(image)),
          rounding_(relative_rounding(image.layers.front()))
    {
        ComparableLayers layers{image.layers.front(), {}};
        layers.is_linear = true;
        layers.space = image.chromaticities.value_or(rec709_chromaticities);
        colors_ = linear_colors(layers, layers.image);
    }
    double mean(std::size_t pixel, std::size_t channel) const { return double(colors_[pixel][channel]); }
    /// Variance of single samples.
    double sample_variance(std::size_t pixel, std::size_t channel) const
    {
        return samples_ * double(variances_.pixels[3 * pixel + channel]);
    }
    double samples() const { return samples_; }
    double rounding() const { return rounding_; }

private:
    const Image::Layer& variances_;
    const double samples_, rounding_;
    Colors colors_;
};

/// Sums of one channel over the pixels of a block.
struct BlockSums {
    double means = 0, reference_means = 0, rounding = 0;
    double variance = 0;       ///< of the difference of the sums of means
    double squared_terms = 0;  ///< sum of variance^2 / degrees of freedom of each term, for Satterthwaite's equation

    void add(const NoisyColors& a, const NoisyColors& b, std::size_t pixel, std::size_t channel)
    {
        const double mean_a = a.mean(pixel, channel), mean_b = b.mean(pixel, channel);
        // Few samples may have missed rare bright paths that the other image has seen.
        const double of_sample = std::max(a.sample_variance(pixel, channel), b.sample_variance(pixel, channel));
        if (!std::isfinite(mean_a + mean_b + of_sample)) return;
        means += mean_a, reference_means += mean_b;
        rounding += std::abs(mean_a) * a.rounding() + std::abs(mean_b) * b.rounding();
        for (const double samples : {a.samples(), b.samples()}) {
            const double term = of_sample / samples;
            variance += term;
            squared_terms += term * term / (samples - 1);
        }
    }
    /// Welch's test: the probability that noise alone causes a difference of the means as large as this. Degrees of
    /// freedom are those of Satterthwaite 1946 for a sum of variances. Differences by rounding are left out.
    double p() const
    {
        const double difference = std::max(0.0, std::abs(means - reference_means) - rounding);
        if (difference == 0) return 1;
        if (variance == 0) return 0;
        return student_t_two_sided(difference / std::sqrt(variance), variance * variance / squared_terms);
    }
};

NoiseTest::Change test_block(const NoisyColors& a, const NoisyColors& b, int width, NoiseTest::Change block)
{
    const double pixels = double(block.x1 - block.x0) * double(block.y1 - block.y0);
    block.p = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < 3; ++c) {
        BlockSums sums;
        for (int y = block.y0; y < block.y1; ++y)
            for (int x = block.x0; x < block.x1; ++x)
                sums.add(a, b, std::size_t(y) * std::size_t(width) + std::size_t(x), c);
        const double p = sums.p();
        if (p >= block.p) continue;
        block.p = p;
        block.channel = std::string(1, "RGB"[c]);
        block.mean = sums.means / pixels, block.reference_mean = sums.reference_means / pixels;
        block.standard_error = std::sqrt(sums.variance) / pixels;
    }
    return block;
}

std::vector<NoiseTest::Change> all_blocks(int width, int height, int side)
{
    std::vector<NoiseTest::Change> blocks;
    for (int y = 0; y < height; y += side)
        for (int x = 0; x < width; x += side)
            blocks.push_back({x, y, std::min(width, x + side), std::min(height, y + side), "", 0, 0, 0, 1});
    return blocks;
}

}  // namespace

std::string noise_test_obstacle(const Image& image)
{
    const Image::Layer& colors = image.layers.front();
    const auto has = [&](const char* channel) {
        return std::find(colors.channels.begin(), colors.channels.end(), channel) != colors.channels.end();
    };
    if (!has("R") || !has("G") || !has("B")) return "has no red, green and blue";
    if (!variance_layer(image)) return "has no layer variance";
    if (samples_per_pixel(image) < 2) return "does not state that it has two samples per pixel or more";
    return "";
}

NoiseTest test_noise(const Image& image, const Image& reference)
{
    const NoisyColors a(image), b(reference);
    NoiseTest result;
    const std::vector<NoiseTest::Change> blocks = all_blocks(image.width, image.height, result.block_side);
    result.blocks = blocks.size();
    const double tests = 3 * (double(blocks.size()) + 1);
    const auto corrected = [&](const NoiseTest::Change& block) {
        NoiseTest::Change tested = test_block(a, b, image.width, block);
        tested.p = std::min(1.0, tested.p * tests);
        result.smallest_p = std::min(result.smallest_p, tested.p);
        return tested;
    };
    for (const NoiseTest::Change& block : blocks)
        if (const NoiseTest::Change tested = corrected(block); tested.p < result.significance)
            result.changes.push_back(tested);
    result.whole_changed = corrected({0, 0, image.width, image.height, "", 0, 0, 0, 1}).p < result.significance;
    std::stable_sort(result.changes.begin(), result.changes.end(),
                     [](const auto& one, const auto& other) { return one.p < other.p; });
    return result;
}

}  // namespace fathom
