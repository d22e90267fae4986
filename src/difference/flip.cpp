// SPDX-License-Identifier: Apache-2.0
#include "difference/flip.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "difference/convolution.h"
#include "difference/exposures.h"
#include "difference/perceptual.h"

namespace fathom {

namespace {

using perceptual::Triple;

/// A display of 3840 pixels and 0.7 m, seen from 0.7 m.
constexpr double pixels_per_degree = 0.7 * 3840 / 0.7 * std::numbers::pi / 180;

template <class Pixel>
void for_pixels(std::size_t count, const Pixel& pixel)
{
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1 << 12), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) pixel(i);
    });
}

/// A Gaussian of the contrast sensitivity functions: a sqrt(pi / b) exp(-pi^2 x^2 / b) with x in degrees (Andersson et
/// al. 2020, table 1).
struct Gaussian {
    double a, b;
    double weight() const { return a * std::sqrt(std::numbers::pi / b); }
    Kernel kernel() const
    {
        constexpr double widest_b = 0.04;
        const double pi2 = std::numbers::pi * std::numbers::pi;
        const int radius = int(std::ceil(3 * std::sqrt(widest_b / (2 * pi2)) * pixels_per_degree));
        Kernel weights;
        for (int i = -radius; i <= radius; ++i) {
            const double x = i / pixels_per_degree;
            weights.push_back(float(std::exp(-pi2 * x * x / b)));
        }
        return weights;
    }
};

double sum(const Kernel& kernel)
{
    double total = 0;
    for (const float weight : kernel) total += double(weight);
    return total;
}

/// Filters a channel by a sum of Gaussians, normalized to 1.
Plane filtered(const Plane& channel, const std::vector<Gaussian>& sensitivity)
{
    Plane result(channel.width, channel.height);
    double total = 0;
    for (const Gaussian& gaussian : sensitivity) {
        const double in_row = sum(gaussian.kernel());
        total += gaussian.weight() * in_row * in_row;
    }
    for (const Gaussian& gaussian : sensitivity) {
        const Plane part = convolve(channel, gaussian.kernel(), gaussian.kernel());
        const auto weight = float(gaussian.weight() / total);
        for_pixels(part.values.size(), [&](std::size_t i) { result.values[i] += weight * part.values[i]; });
    }
    return result;
}

/// The colors as a viewer perceives them: filtered by the contrast sensitivity, in a perceptually uniform space.
std::vector<Triple> perceived(const Colors& colors, int width, int height)
{
    std::array<Plane, 3> channels{Plane(width, height), Plane(width, height), Plane(width, height)};
    for_pixels(colors.size(), [&](std::size_t i) {
        const Triple ycxcz = perceptual::ycxcz_from_linear(colors[i]);
        for (std::size_t c = 0; c < 3; ++c) channels[c].values[i] = ycxcz[c];
    });
    channels[0] = filtered(channels[0], {{1, 0.0047}});
    channels[1] = filtered(channels[1], {{1, 0.0053}});
    channels[2] = filtered(channels[2], {{34.1, 0.04}, {13.5, 0.025}});
    std::vector<Triple> result(colors.size());
    for_pixels(colors.size(), [&](std::size_t i) {
        Triple rgb =
            perceptual::linear_from_ycxcz({channels[0].values[i], channels[1].values[i], channels[2].values[i]});
        for (float& value : rgb) value = std::clamp(value, 0.0f, 1.0f);
        result[i] = perceptual::hunt_lab(rgb);
    });
    return result;
}

/// Filters that respond to edges and to points: derivatives of a Gaussian.
struct FeatureKernels {
    Kernel smooth, edge, point;

    FeatureKernels()
    {
        constexpr double feature_width_deg = 0.082;
        const double deviation = 0.5 * feature_width_deg * pixels_per_degree;
        const int radius = int(std::ceil(3 * deviation));
        for (int x = -radius; x <= radius; ++x) {
            const double g = std::exp(-x * x / (2 * deviation * deviation));
            smooth.push_back(float(g));
            edge.push_back(float(-x * g));
            point.push_back(float((x * x / (deviation * deviation) - 1) * g));
        }
        for (Kernel* kernel : {&smooth, &edge, &point}) normalize(*kernel);
    }
    /// Scales positive weights to a sum of 1, negative ones to -1.
    static void normalize(Kernel& kernel)
    {
        double positive = 0, negative = 0;
        for (const float weight : kernel) (weight > 0 ? positive : negative) += double(weight);
        for (float& weight : kernel) weight = float(double(weight) / (weight > 0 ? positive : -negative));
    }
};

/// Strength of edges and points in the luminance of each pixel.
struct Features {
    std::vector<float> edges, points;

    Features(const Colors& colors, int width, int height)
    {
        static const FeatureKernels kernels;
        Plane luminance(width, height);
        for_pixels(colors.size(),
                   [&](std::size_t i) { luminance.values[i] = perceptual::relative_luminance(colors[i]); });
        edges = magnitude(luminance, kernels.edge, kernels.smooth);
        points = magnitude(luminance, kernels.point, kernels.smooth);
    }
    static std::vector<float> magnitude(const Plane& luminance, const Kernel& derivative, const Kernel& smooth)
    {
        const Plane x = convolve(luminance, derivative, smooth), y = convolve(luminance, smooth, derivative);
        std::vector<float> result(x.values.size());
        for_pixels(result.size(), [&](std::size_t i) {
            result[i] = std::sqrt(x.values[i] * x.values[i] + y.values[i] * y.values[i]);
        });
        return result;
    }
    /// Difference of a pixel's features, 0 to 1.
    static float difference(const Features& a, const Features& b, std::size_t i)
    {
        const float larger = std::max(std::abs(a.edges[i] - b.edges[i]), std::abs(a.points[i] - b.points[i]));
        return std::min(1.0f, std::sqrt(larger / std::numbers::sqrt2_v<float>));
    }
};

std::vector<float> flip_map(const Colors& image, const Colors& reference, int width, int height)
{
    const std::vector<Triple> a = perceived(image, width, height), b = perceived(reference, width, height);
    const Features of_a(image, width, height), of_b(reference, width, height);
    std::vector<float> map(image.size());
    for_pixels(map.size(), [&](std::size_t i) {
        map[i] = std::pow(perceptual::color_difference(a[i], b[i]), 1 - Features::difference(of_a, of_b, i));
    });
    return map;
}

}  // namespace

Flip flip_of_display(const Colors& image, const Colors& reference, int width, int height)
{
    Flip flip;
    flip.map = flip_map(image, reference, width, height);
    return flip;
}

Flip flip_of_radiance(const Colors& image, const Colors& reference, int width, int height)
{
    const Exposures exposures = exposures_for(reference);
    Flip flip;
    flip.map.resize(image.size());
    for (int i = 0; i < exposures.count; ++i) {
        const double ev = exposures.exposure(i);
        const std::vector<float> map = flip_map(tone_mapped(image, ev), tone_mapped(reference, ev), width, height);
        for_pixels(map.size(), [&](std::size_t p) { flip.map[p] = std::max(flip.map[p], map[p]); });
    }
    flip.exposures = exposures.count;
    flip.first_ev = exposures.first, flip.last_ev = exposures.last;
    return flip;
}

}  // namespace fathom
