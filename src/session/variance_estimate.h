#pragma once
#include <cstddef>
#include <vector>

namespace fathom {

/// Mean and variance of the paths of a pixel: as far as these are spread evenly, they vary less together.
struct Spread {
    double mean = 0, variance = 0;
};
/// By pixel, of sets of `samples` of each, pixel by pixel, that know nothing of each other: by how far the sets' means
/// are apart, which is all that tells how much is left of the noise of samples that are spread evenly.
std::vector<Spread> spreads_of(const std::vector<std::vector<float>>& sets, std::size_t samples);

/// The squares of how bright pixels are, by what they and those near them brought: a pixel's own few samples don't
/// tell, and dark ones that hit nothing yet would count as quiet. A tenth of the mean's square is added: noise in the
/// dark is seen less than beside its own brightness.
std::vector<double> brightness_squares(const std::vector<Spread>& along_rows);

/// Mean of the numbers but the largest, by which few would decide alone.
double mean_without_outliers(std::vector<double> numbers);

}  // namespace fathom
