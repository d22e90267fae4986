// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace fathom::test {

struct Direction {
    double x, y, z;
};

/// Pearson's chi-squared test of sampled directions against a pdf with respect to solid angle. The pdf is integrated
/// over cells of the sphere; cells that expect less than five samples are pooled. A sample where the pdf is zero fails.
///
/// Returns "" if the samples may follow the pdf, at an error rate of one in a million per test, else a description of
/// the mismatch.
std::string chi_square_directions(const std::vector<Direction>& samples, const std::function<double(Direction)>& pdf);

/// Pearson's chi-squared test of observed cell counts against expected counts.
std::string chi_square(const std::vector<double>& observed, const std::vector<double>& expected);

/// Integral of f over the sphere of directions.
double integrate_sphere(const std::function<double(Direction)>& f, int theta_steps = 512, int phi_steps = 1024);

}  // namespace fathom::test
