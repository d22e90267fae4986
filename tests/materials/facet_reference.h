// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Microfacet formulas in double precision, to which closures are compared.
#include <cmath>
#include <numbers>
#include <random>

namespace fathom::test {

struct UnitVector {
    double x, y, z;
};

/// Normalized half vector.
inline UnitVector half_vector(const UnitVector& a, const UnitVector& b)
{
    const UnitVector h{a.x + b.x, a.y + b.y, a.z + b.z};
    const double length = std::sqrt(h.x * h.x + h.y * h.y + h.z * h.z);
    return {h.x / length, h.y / length, h.z / length};
}

/// Random directions on the upper hemisphere, down to 3 degrees above the horizon.
class RandomDirections {
public:
    UnitVector operator()()
    {
        const double z = number(0.05, 1), phi = number(0, 2 * std::numbers::pi), s = std::sqrt(1 - z * z);
        return {s * std::cos(phi), s * std::sin(phi), z};
    }
    double number(double min, double max) { return min + (max - min) * uniform_(engine_); }

private:
    std::mt19937_64 engine_{7};
    std::uniform_real_distribution<double> uniform_;
};

/// Beckmann distribution of normals, Walter et al. 2007, eq. 25.
inline double beckmann_d(const UnitVector& h, double alpha_x, double alpha_y)
{
    const double x = h.x / alpha_x, y = h.y / alpha_y, z2 = h.z * h.z;
    return std::exp(-(x * x + y * y) / z2) / (std::numbers::pi * alpha_x * alpha_y * z2 * z2);
}

/// Smith masking function, Walter et al. 2007, eq. 27 and 34.
inline double smith_g1(double z, double alpha, bool is_beckmann)
{
    const double slope = std::sqrt(std::max(0.0, 1 - z * z)) / z;
    if (!is_beckmann) return 2 / (1 + std::sqrt(1 + alpha * alpha * slope * slope));
    const double a = 1 / (alpha * slope);
    return a < 1.6 ? (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a) : 1;
}

}  // namespace fathom::test
