// SPDX-License-Identifier: Apache-2.0
#include "film/pareto_tail.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace fathom {

namespace {

/// Mean of log(1 - b x): the shape that is most likely for a given ratio b of shape and scale, with a minus sign.
double shape_for(double b, const std::vector<double>& excesses)
{
    double sum = 0;
    for (const double x : excesses) sum += std::log1p(-b * x);
    return sum / double(excesses.size());
}

/// Shape of the distribution of excesses, which are positive and in ascending order.
double fit_shape(const std::vector<double>& excesses)
{
    const double n = double(excesses.size());
    const int count = 30 + int(std::sqrt(n));
    const double quartile = excesses[std::size_t(n / 4 + 0.5) - 1];
    std::vector<double> ratios, likelihoods;
    for (int i = 1; i <= count; ++i) {
        const double b = 1 / excesses.back() + (1 - std::sqrt(count / (i - 0.5))) / (3 * quartile);
        const double k = shape_for(b, excesses);
        ratios.push_back(b);
        likelihoods.push_back(n * (std::log(-b / k) - k - 1));
    }
    const double most = *std::max_element(likelihoods.begin(), likelihoods.end());
    double weights = 0, mean = 0;
    for (std::size_t i = 0; i < ratios.size(); ++i) {
        const double weight = std::exp(likelihoods[i] - most);
        weights += weight, mean += weight * ratios[i];
    }
    constexpr double prior = 10, prior_shape = 0.5;
    return (n * shape_for(mean / weights, excesses) + prior * prior_shape) / (n + prior);
}

}  // namespace

double pareto_tail_shape(std::vector<float> numbers)
{
    constexpr std::size_t fewest = 8;
    const std::size_t count = std::min(std::size_t(3 * std::sqrt(double(numbers.size()))), numbers.size() / 5);
    if (count < fewest) return 0;
    const auto threshold = numbers.end() - std::ptrdiff_t(count) - 1;
    std::nth_element(numbers.begin(), threshold, numbers.end());
    std::vector<double> excesses;
    for (auto number = threshold + 1; number != numbers.end(); ++number)
        if (*number > *threshold) excesses.push_back(double(*number) - double(*threshold));
    if (excesses.size() < fewest) return 0;
    std::sort(excesses.begin(), excesses.end());
    return fit_shape(excesses);
}

}  // namespace fathom
