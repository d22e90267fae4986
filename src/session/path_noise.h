#pragma once
#include <cstddef>
#include <vector>

namespace fathom {

/// Mean and variance of the samples of a pixel.
struct Spread {
    double mean = 0, variance = 0;
};
/// By pixel, of `samples` of each, pixel by pixel.
std::vector<Spread> spreads_of(const std::vector<float>& radiance, std::size_t samples);

/// The squares of how bright pixels are, by what they and those near them brought: a pixel's own few samples don't
/// tell, and dark ones that hit nothing yet would count as quiet. A hundredth of the mean's square is added, as where
/// errors are measured.
std::vector<double> brightness_squares(const std::vector<Spread>& along_rows);

/// Mean of the numbers but the largest, by which few would decide alone.
double mean_without_outliers(std::vector<double> numbers);

}  // namespace fathom
