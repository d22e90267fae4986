// SPDX-License-Identifier: Apache-2.0
#include "difference/student_t.h"

#include <cmath>

namespace fathom {

namespace {

/// The continued fraction of the incomplete beta function (DLMF 8.17.22) by Lentz's method.
double beta_fraction(double x, double a, double b)
{
    constexpr double tiny = 1e-300, precision = 1e-14;
    constexpr int max_terms = 10000;
    const auto nonzero = [](double v) { return std::abs(v) < tiny ? tiny : v; };
    double c = 1, d = 1 / nonzero(1 - (a + b) * x / (a + 1)), result = d;
    for (int m = 1; m < max_terms; ++m) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        double factor = 1;
        for (const double term : {even, odd}) {
            d = 1 / nonzero(1 + term * d);
            c = nonzero(1 + term / c);
            factor = c * d;
            result *= factor;
        }
        if (std::abs(factor - 1) < precision) break;
    }
    return result;
}

/// The regularized incomplete beta function I_x(a, b), DLMF 8.17.
double incomplete_beta(double x, double a, double b)
{
    if (x <= 0) return 0;
    if (x >= 1) return 1;
    const double front =
        std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
    // The fraction converges quickly on this side only.
    if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(x, a, b) / a;
    return 1 - front * beta_fraction(1 - x, b, a) / b;
}

}  // namespace

double student_t_two_sided(double t, double freedom)
{
    if (std::isinf(t)) return 0;
    return incomplete_beta(freedom / (freedom + t * t), freedom / 2, 0.5);
}

}  // namespace fathom
