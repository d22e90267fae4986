// SPDX-License-Identifier: Apache-2.0
#include "lights/sky/hosek_sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lights/sky/hosek_sky_table.h"

namespace fathom {

namespace {

/// Bernstein polynomials of degree 5, by which coefficients depend on the sun's elevation.
void bernstein(double x, double (&weight)[6])
{
    constexpr double binomial[6] = {1, 5, 10, 10, 5, 1};
    for (int j = 0; j < 6; ++j) weight[j] = binomial[j] * std::pow(x, j) * std::pow(1 - x, 5 - j);
}

}  // namespace

HosekSky::HosekSky(const Vec3d& to_sun, double turbidity, double ground_albedo) : to_sun_(normalize(to_sun))
{
    const double t = std::clamp(turbidity, 1.0, 10.0) - 1, albedo = std::clamp(ground_albedo, 0.0, 1.0);
    const auto below = std::size_t(std::min(t, 8.0));
    const double part = t - double(below),
                 share[4] = {(1 - part) * (1 - albedo), (1 - part) * albedo, part * (1 - albedo), part * albedo};
    const double elevation = std::asin(std::clamp(to_sun_.y, 0.0, 1.0));
    double weight[6];
    bernstein(std::cbrt(elevation / (std::numbers::pi / 2)), weight);
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < coefficients; ++i) {
            double sum = 0;
            for (std::size_t k = 0; k < 4; ++k)
                for (std::size_t j = 0; j < 6; ++j)
                    sum += share[k] * weight[j] * double(hosek_sky_table[below + k / 2][k % 2][c][i][j]);
            coefficients_[c][i] = sum;
        }
}

Color HosekSky::radiance(const Vec3d& d) const
{
    if (!(d.y >= 0)) return {0, 0, 0};
    const double cosine = std::clamp(dot(d, to_sun_), -1.0, 1.0), gamma = std::acos(cosine), root = std::sqrt(d.y);
    const auto channel = [&](const double(&k)[coefficients]) {
        // Equation 8 of the paper; k[7] is the width of the glow around the sun.
        const double spread = 1 + k[7] * k[7] - 2 * k[7] * cosine;
        const double glow = (1 + cosine * cosine) / (spread * std::sqrt(spread));
        const double f = (1 + k[0] * std::exp(k[1] / (d.y + 0.01))) *
                         (k[2] + k[3] * std::exp(k[4] * gamma) + k[5] * cosine * cosine + k[6] * glow + k[8] * root);
        return float(std::max(0.0, f * k[9]));
    };
    return {channel(coefficients_[0]), channel(coefficients_[1]), channel(coefficients_[2])};
}

}  // namespace fathom
