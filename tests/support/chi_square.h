// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace fathom::test {

struct Direction {
    double x, y, z;
};

/// Integrals of f over the cells of a grid that covers the sphere of directions, 7.5 degrees wide in the polar angle
/// and the azimuth. Their sum is the integral over the sphere. Where f varies within a cell, more of its points count.
std::vector<double> integrate_cells(const std::function<double(Direction)>& f);

/// Pearson's chi-squared test of sampled directions against integrate_cells() of their pdf with respect to solid angle,
/// scaled so that they sum to 1. Cells that expect less than five samples are pooled. A sample where the pdf is zero
/// fails.
///
/// Returns "" if the samples may follow the pdf, at an error rate of one in a million per test, else a description of
/// the mismatch.
std::string chi_square_of_cells(const std::vector<Direction>& samples, const std::vector<double>& cells);

/// Pearson's chi-squared test of sampled directions against a pdf that integrates to 1: see chi_square_of_cells().
std::string chi_square_directions(const std::vector<Direction>& samples, const std::function<double(Direction)>& pdf);

/// Pearson's chi-squared test of observed cell counts against expected counts.
std::string chi_square(const std::vector<double>& observed, const std::vector<double>& expected);

/// Integral of f over the sphere of directions, by the midpoint rule.
double integrate_sphere(const std::function<double(Direction)>& f, int theta_steps = 512, int phi_steps = 1024);

}  // namespace fathom::test
