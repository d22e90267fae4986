// SPDX-License-Identifier: Apache-2.0
#include "session/variance_estimate.h"

#include <algorithm>

namespace fathom {

namespace {

/// Number of pixels before and after a pixel in its row over which brightness is averaged.
constexpr std::size_t neighbors = 16;
/// Fraction of pixels with the largest noise that is ignored.
constexpr double outliers = 0.001;

double mean_of(const float* values, std::size_t samples)
{
    double sum = 0;
    for (std::size_t i = 0; i < samples; ++i) sum += double(values[i]);
    return sum / double(samples);
}

}  // namespace

std::vector<PixelVariance> pixel_variances(const std::vector<std::vector<float>>& sets, std::size_t samples)
{
    std::vector<PixelVariance> spreads(sets[0].size() / samples);
    const double n = double(sets.size());
    std::vector<double> means(sets.size());
    for (std::size_t i = 0; i < spreads.size(); ++i) {
        PixelVariance& s = spreads[i];
        for (std::size_t k = 0; k < sets.size(); ++k) {
            means[k] = mean_of(&sets[k][i * samples], samples);
            s.mean += means[k] / n;
        }
        double squares = 0;
        for (const double mean : means) squares += (mean - s.mean) * (mean - s.mean);
        s.variance = double(samples) * squares / (n - 1);
    }
    return spreads;
}

std::vector<double> squared_brightness(const std::vector<PixelVariance>& along_rows)
{
    const std::size_t pixels = along_rows.size();
    std::vector<double> sums(pixels + 1), squares(pixels);
    for (std::size_t i = 0; i < pixels; ++i) sums[i + 1] = sums[i] + along_rows[i].mean;
    const double mean = sums[pixels] / double(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        const std::size_t from = i - std::min(i, neighbors), to = std::min(pixels, i + neighbors + 1);
        const double around = (sums[to] - sums[from]) / double(to - from);
        squares[i] = around * around + 0.1 * mean * mean;
    }
    return squares;
}

double mean_without_outliers(std::vector<double> numbers)
{
    const auto kept = std::ptrdiff_t(numbers.size()) - std::ptrdiff_t(outliers * double(numbers.size()));
    std::nth_element(numbers.begin(), numbers.begin() + kept - 1, numbers.end());
    // Sorting makes the order of summation depend on the numbers alone.
    std::sort(numbers.begin(), numbers.begin() + kept);
    double sum = 0;
    for (auto x = numbers.begin(); x < numbers.begin() + kept; ++x) sum += *x;
    return sum / double(kept);
}

}  // namespace fathom
