// SPDX-License-Identifier: Apache-2.0
#include "sampling/filter.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace fathom {
inline namespace FATHOM_LANES {

namespace {

/// Tabulates a filter f that is even and 0 beyond the radius, and the inverse of its cumulative distribution.
template <class F>
void tabulate(FilterTable& table, double radius, F f)
{
    constexpr int size = FilterTable::size;
    constexpr int steps = 1 << 15;
    std::vector<double> sum(steps + 1);
    for (int i = 0; i < steps; ++i) sum[std::size_t(i) + 1] = sum[std::size_t(i)] + f(radius * ((i + 0.5) / steps - 1));
    int at = 0;
    for (int i = 0; i <= size; ++i) {
        const double root = double(i) / size, wanted = sum[steps] * root * root * root * root;
        while (at + 1 < steps && sum[std::size_t(at) + 1] < wanted) ++at;
        const double width = sum[std::size_t(at) + 1] - sum[std::size_t(at)];
        const double part = width > 0 ? (wanted - sum[std::size_t(at)]) / width : 0;
        table.inverse[i] = float(radius * ((at + part) / steps - 1));
    }
    const double integral = 2 * sum[steps] * radius / steps;
    table.half_width = float(radius);
    constexpr int last = FilterTable::density_size;
    for (int i = 0; i <= last; ++i) table.density_at[i] = float(f(-radius * i / last) / integral);
}

}  // namespace

void FilterTable::make_gaussian()
{
    tabulate(*this, 2, [](double x) { return std::exp(-2 * x * x) - std::exp(-8.0); });
}

void FilterTable::make_blackman_harris()
{
    // Four-term Blackman-Harris window with side lobes at -92 dB: Harris 1978.
    constexpr double radius = 1.65;
    tabulate(*this, radius, [](double x) {
        const double t = std::numbers::pi * (x / radius + 1);
        return 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) - 0.01168 * std::cos(3 * t);
    });
}

void FilterTable::make_tent()
{
    tabulate(*this, 1, [](double x) { return 1 + x; });
}

}  // namespace FATHOM_LANES
}  // namespace fathom
