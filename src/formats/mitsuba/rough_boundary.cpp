// SPDX-License-Identifier: Apache-2.0
#include "formats/mitsuba/rough_boundary.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fathom::mitsuba {

namespace {

/// Fresnel reflectance for light inside that reaches the boundary; `ior` is the inner index over the outer one.
double internal_fresnel(double cosine, double ior)
{
    const double sine2 = (1 - cosine * cosine) * ior * ior;
    if (sine2 >= 1) return 1;
    const double t = std::sqrt(1 - sine2);
    const double s = (cosine - ior * t) / (cosine + ior * t), p = (ior * cosine - t) / (ior * cosine + t);
    return (s * s + p * p) / 2;
}

/// Smith's masking term G1 for Beckmann or GGX (Walter et al. 2007).
double smith_masking(double cosine, double alpha, bool beckmann)
{
    const double tangent = std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine;
    if (!beckmann) return 2 / (1 + std::sqrt(1 + alpha * alpha * tangent * tangent));
    const double a = 1 / std::max(1e-9, alpha * tangent);
    return a < 1.6 ? (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a) : 1;
}

/// Fraction of light from a direction inside that the facets reflect back inside, without interreflection.
double facet_reflectance(double cosine, double alpha, bool beckmann, double ior)
{
    constexpr int slopes = 48, turns = 48;
    const double sine = std::sqrt(1 - cosine * cosine);
    double sum = 0;
    for (int i = 0; i < slopes; ++i) {
        // Facet normals follow the projected area of the distribution; sampling in w is denser at steep normals, which
        // matter at grazing angles.
        const double w = (i + 0.5) / slopes, area = 2 * w / slopes;
        const double slope = alpha * std::sqrt(beckmann ? -2 * std::log(w) : 1 / (w * w) - 1);
        const double z = 1 / std::sqrt(1 + slope * slope), across = slope * z;
        for (int k = 0; k < turns; ++k) {
            const double x = across * std::cos(std::numbers::pi * (k + 0.5) / turns);
            const double towards = sine * x + cosine * z, up = 2 * towards * z - cosine;
            if (towards > 0 && up > 0)
                sum += internal_fresnel(std::min(1.0, towards), ior) * smith_masking(up, alpha, beckmann) * towards /
                       z * area / turns;
        }
    }
    return smith_masking(cosine, alpha, beckmann) / cosine * sum;
}

}  // namespace

double inner_reflectance(double alpha, bool beckmann, double ior)
{
    constexpr int cosines = 64;
    double sum = 0;
    for (int i = 0; i < cosines; ++i) {
        const double cosine = std::max(1e-6, double(i) / (cosines - 1));
        sum += 2 * cosine * facet_reflectance(cosine, alpha, beckmann, ior) / cosines;
    }
    return sum;
}

}  // namespace fathom::mitsuba
