// SPDX-License-Identifier: Apache-2.0
#include "difference/exposures.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <algorithm>
#include <cmath>
#include <limits>

namespace fathom {

namespace {

/// The curve is (a x^2 + b x) / (c x^2 + d x + e).
constexpr float a = 0.6f * 0.6f * 2.51f, b = 0.6f * 0.03f, c = 0.6f * 0.6f * 2.43f, d = 0.6f * 0.59f, e = 0.14f;

float curve(float x)
{
    return std::clamp((a * x * x + b * x) / (c * x * x + d * x + e), 0.0f, 1.0f);
}

/// The value that the curve maps to `bright`.
double inverse_of_bright()
{
    constexpr double bright = 0.85;
    const double p = double(a) - bright * double(c), q = double(b) - bright * double(d), r = -bright * double(e);
    return (-q + std::sqrt(q * q - 4 * p * r)) / (2 * p);
}

}  // namespace

Exposures exposures_for(const Colors& reference)
{
    std::vector<float> luminances;
    for (const auto& rgb : reference)
        luminances.push_back(0.2126f * std::max(rgb[0], 0.0f) + 0.7152f * std::max(rgb[1], 0.0f) +
                             0.0722f * std::max(rgb[2], 0.0f));
    const auto middle = luminances.begin() + std::ptrdiff_t(luminances.size() / 2);
    std::nth_element(luminances.begin(), middle, luminances.end());
    const auto median = double(*middle);
    const double brightest = double(*std::max_element(middle, luminances.end()));

    constexpr double darkest = double(std::numeric_limits<float>::epsilon());
    Exposures exposures;
    exposures.first = std::log2(inverse_of_bright() / std::max(brightest, darkest));
    exposures.last = std::log2(inverse_of_bright() / std::max(median, darkest));
    exposures.count = std::max(2, int(std::ceil(exposures.last - exposures.first)));
    return exposures;
}

Colors tone_mapped(const Colors& radiance, double exposure_ev)
{
    const auto scale = float(std::exp2(exposure_ev));
    Colors result(radiance.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, radiance.size(), 1 << 14), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            for (std::size_t k = 0; k < 3; ++k) result[i][k] = curve(scale * std::max(radiance[i][k], 0.0f));
    });
    return result;
}

}  // namespace fathom
