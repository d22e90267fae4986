// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

namespace fathom {

/// Returns the shape of the generalized Pareto distribution that fits the largest 3 sqrt(n) of n numbers >= 0, by the
/// method of Zhang and Stephens (2009, "A New and Efficient Estimation Method for the Generalized Pareto Distribution")
/// with the weak prior of Vehtari et al. (2024, "Pareto Smoothed Importance Sampling"). Numbers whose tail has a shape
/// of 0.5 or more have no finite variance, and from 1 on no finite mean. Returns 0 if too few numbers differ.
double pareto_tail_shape(std::vector<float> numbers);

}  // namespace fathom
