// SPDX-License-Identifier: Apache-2.0
#include "chi_square.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <sstream>

namespace fathom::test {

namespace {

constexpr int theta_cells = 24, phi_cells = 48;

// Cells are uniform in the polar angle, which resolves narrow lobes about the pole.
Direction direction(double theta, double phi)
{
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

int cell_of(const Direction& d)
{
    const double theta = std::atan2(std::hypot(d.x, d.y), d.z), phi = std::atan2(d.y, d.x);
    const int i = std::min(int(theta / std::numbers::pi * theta_cells), theta_cells - 1);
    const int j =
        std::min(int((phi < 0 ? phi + 2 * std::numbers::pi : phi) / (2 * std::numbers::pi) * phi_cells), phi_cells - 1);
    return i * phi_cells + j;
}

/// Midpoint rule over a cell with sub * sub points.
double midpoints(const std::function<double(Direction)>& f, int i, int j, int sub)
{
    double sum = 0;
    for (int a = 0; a < sub; ++a) {
        const double theta = std::numbers::pi * (i + (a + 0.5) / sub) / theta_cells;
        for (int b = 0; b < sub; ++b)
            sum += std::sin(theta) * f(direction(theta, 2 * std::numbers::pi * (j + (b + 0.5) / sub) / phi_cells));
    }
    return sum / (sub * sub) * 2 * std::numbers::pi * std::numbers::pi / (theta_cells * phi_cells);
}

/// True if a cell at (i, j) is zero and one beside it is not, so that an edge of the support may run through it.
bool is_at_edge(const std::vector<double>& cells, int i, int j)
{
    const auto at = [&](int row, int column) {
        return cells[std::size_t(row * phi_cells + (column + phi_cells) % phi_cells)];
    };
    if (at(i, j) != 0) return false;
    return at(i, j - 1) != 0 || at(i, j + 1) != 0 || (i > 0 && at(i - 1, j) != 0) ||
           (i + 1 < theta_cells && at(i + 1, j) != 0);
}

}  // namespace

std::vector<double> integrate_cells(const std::function<double(Direction)>& f)
{
    std::vector<double> coarse, finer;
    for (int i = 0; i < theta_cells; ++i)
        for (int j = 0; j < phi_cells; ++j) {
            coarse.push_back(midpoints(f, i, j, 5));
            finer.push_back(midpoints(f, i, j, 8));
        }
    std::vector<double> cells = finer;
    for (std::size_t cell = 0; cell < cells.size(); ++cell) {
        const int i = int(cell) / phi_cells, j = int(cell) % phi_cells;
        const bool is_smooth = std::abs(coarse[cell] - finer[cell]) <= 5e-4 * finer[cell];
        if (!is_smooth || is_at_edge(finer, i, j)) cells[cell] = midpoints(f, i, j, 24);
    }
    return cells;
}

double integrate_sphere(const std::function<double(Direction)>& f, int theta_steps, int phi_steps)
{
    double sum = 0;
    for (int i = 0; i < theta_steps; ++i)
        for (int j = 0; j < phi_steps; ++j) {
            const double theta = std::numbers::pi * (i + 0.5) / theta_steps;
            sum += std::sin(theta) * f(direction(theta, 2 * std::numbers::pi * (j + 0.5) / phi_steps));
        }
    return sum * 2 * std::numbers::pi * std::numbers::pi / theta_steps / phi_steps;
}

std::string chi_square(const std::vector<double>& observed, const std::vector<double>& expected)
{
    std::vector<std::size_t> order(expected.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return expected[a] < expected[b]; });
    double statistic = 0, pooled_observed = 0, pooled_expected = 0;
    int freedom = -1;
    for (std::size_t i : order) {
        if (expected[i] == 0) {
            if (observed[i] > 0) return "samples where the density is zero";
        } else if (expected[i] < 5 || (pooled_expected > 0 && pooled_expected < 5)) {
            pooled_observed += observed[i];
            pooled_expected += expected[i];
        } else {
            statistic += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
            ++freedom;
        }
    }
    if (pooled_expected > 0) {
        statistic += (pooled_observed - pooled_expected) * (pooled_observed - pooled_expected) / pooled_expected;
        ++freedom;
    }
    if (freedom < 1) return "";
    // Wilson and Hilferty 1931: the cube root is nearly normal. 4.75 sigma is one in a million.
    const double k = freedom;
    const double sigma = (std::cbrt(statistic / k) - (1 - 2 / (9 * k))) / std::sqrt(2 / (9 * k));
    if (sigma < 4.75) return "";
    std::ostringstream text;
    text << "chi-square " << statistic << " with " << freedom << " degrees of freedom: " << sigma << " sigma";
    return text.str();
}

std::string chi_square_of_cells(const std::vector<Direction>& samples, const std::vector<double>& cells)
{
    std::vector<double> observed(cells.size()), expected;
    for (const Direction& d : samples) ++observed[std::size_t(cell_of(d))];
    const double total = std::accumulate(cells.begin(), cells.end(), 0.0);
    for (const double cell : cells) expected.push_back(cell / total * double(samples.size()));
    return chi_square(observed, expected);
}

std::string chi_square_directions(const std::vector<Direction>& samples, const std::function<double(Direction)>& pdf)
{
    return chi_square_of_cells(samples, integrate_cells(pdf));
}

}  // namespace fathom::test
