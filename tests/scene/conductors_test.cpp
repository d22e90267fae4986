// SPDX-License-Identifier: Apache-2.0
#include "scene/conductors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>

namespace fathom {
namespace {

/// Reflectance by Fresnel's amplitudes in complex numbers.
double exact(double cosine, double eta, double k)
{
    const std::complex<double> m(eta, k), beyond = std::sqrt(m * m - (1 - cosine * cosine));
    return (std::norm((cosine - beyond) / (cosine + beyond)) +
            std::norm((m * m * cosine - beyond) / (m * m * cosine + beyond))) /
           2;
}

/// Schlick's approximation with a factor at a cosine of 1/7, as in layered materials.
double as_shaded(double cosine, double base, double edge)
{
    const auto schlick = [&](double c) { return base + (1 - base) * std::pow(1 - c, 5); };
    const auto shape = [](double c) { return c * std::pow(1 - c, 6); };
    return schlick(cosine) - shape(cosine) / shape(1.0 / 7) * (1 - edge) * schlick(1.0 / 7);
}

TEST(Conductors, MatchFresnelEquations)
{
    for (const auto& [eta, k] : {std::pair{0.2, 3.9}, {1.5, 0.0}, {3.1, 3.3}})
        for (int i = 0; i <= 20; ++i)
            EXPECT_NEAR(conductor_reflectance(i / 20.0, eta, k), exact(i / 20.0, eta, k), 1e-12) << eta << " " << i;
}

/// Colors of each conductor come from its index, and shading deviates by at most 0.03 at any angle.
TEST(Conductors, ColorsOfNamedMetals)
{
    ASSERT_GE(conductors().size(), 9u);
    for (const Conductor& c : conductors()) {
        const ConductorColors colors = colors_of(c);
        const float channels[3][4] = {{c.eta.r, c.k.r, colors.base.r, colors.edge.r},
                                      {c.eta.g, c.k.g, colors.base.g, colors.edge.g},
                                      {c.eta.b, c.k.b, colors.base.b, colors.edge.b}};
        for (const auto& [eta, k, base, edge] : channels) {
            EXPECT_NEAR(base, exact(1, double(eta), double(k)), 1e-6) << c.name;
            for (int i = 1; i <= 100; ++i)
                EXPECT_NEAR(as_shaded(i / 100.0, double(base), double(edge)), exact(i / 100.0, double(eta), double(k)),
                            0.03)
                    << c.name << " " << i;
        }
    }
    // Visual check: gold is yellow, copper red, silver almost white.
    const auto base = [](const std::string& name) {
        for (const Conductor& c : conductors())
            if (name == c.name) return colors_of(c).base;
        return Color{};
    };
    EXPECT_NEAR(base("gold").b, 0.37f, 0.01f);
    EXPECT_NEAR(base("copper").g, 0.72f, 0.01f);
    EXPECT_GT(base("silver").b, 0.9f);
}

}  // namespace
}  // namespace fathom
