#pragma once
#include <functional>
#include <string>
#include <vector>

namespace fathom::test {

struct Direction {
    double x, y, z;
};

/// Pearson's test of sampled directions against a density per solid angle: the sphere is cut into cells, the density is
/// integrated over each, cells expecting less than five samples are pooled. A sample where the density is zero fails.
///
/// Returns "" if the samples may be of that density, at an error rate of one in a million per test; else what is wrong.
std::string chi_square_directions(const std::vector<Direction>& samples, const std::function<double(Direction)>& pdf);

/// The same for numbers of cells with expected counts.
std::string chi_square(const std::vector<double>& observed, const std::vector<double>& expected);

/// Integral of f over the sphere of directions.
double integrate_sphere(const std::function<double(Direction)>& f, int theta_steps = 512, int phi_steps = 1024);

}  // namespace fathom::test
