// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <vector>

namespace fathom {

/// Mean and effective variance of a pixel's paths. The mean of stratified samples has a lower variance than that of
/// independent ones.
struct PixelVariance {
    double mean = 0, variance = 0;
};
/// Estimates the PixelVariance of each pixel from the means of independent sets of `samples` stratified samples each.
/// Only the variation between sets shows the noise that remains with stratification.
std::vector<PixelVariance> pixel_variances(const std::vector<std::vector<float>>& sets, std::size_t samples);

/// Squared brightness of pixels, averaged over neighbors in the row, since few samples of a dark pixel would
/// underestimate it. A tenth of the squared mean is added, since noise in dark areas is less visible than its relative
/// variance suggests.
std::vector<double> squared_brightness(const std::vector<PixelVariance>& along_rows);

/// Mean without the largest numbers, which would dominate the result.
double mean_without_outliers(std::vector<double> numbers);

}  // namespace fathom
