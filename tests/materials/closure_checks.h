// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Checks that tests of all closures use: sampling against pdf, and energy.
#include <gtest/gtest.h>

#include <cmath>
#include <concepts>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "materials/closures/closure.h"
#include "support/chi_square.h"
#include "support/lane_helpers.h"

namespace fathom::test {

/// Parameters that most closures have. It converts to those of a closure, which keep their defaults otherwise.
struct CommonPoint : PrincipledPoint {
    template <std::derived_from<MaterialPoint> Point>
    operator Point() const
    {
        Point p;
        static_cast<MaterialPoint&>(p) = *this;
        if constexpr (std::derived_from<Point, FacetsPoint>) static_cast<FacetsPoint&>(p) = *this;
        if constexpr (requires { p.roughness; }) p.roughness = roughness;
        if constexpr (requires { p.metallic; }) p.metallic = metallic;
        if constexpr (requires { p.ior; }) p.ior = ior;
        return p;
    }
};

inline CommonPoint material(float color, float roughness, float metallic = 0, float ior = 1.5f)
{
    CommonPoint m;
    m.base_color = Spectrum(Float(color));
    m.roughness = Float(roughness), m.metallic = Float(metallic), m.ior = Float(ior);
    m.entering = m.compensated = Mask(true), m.thin = Mask(false);
    return m;
}
inline Vec3 lane_direction(Direction d)
{
    return {Float(float(d.x)), Float(float(d.y)), Float(float(d.z))};
}
inline Vec3 outgoing(double degrees)
{
    const double t = degrees * std::numbers::pi / 180;
    return lane_direction({std::sin(t), 0, std::cos(t)});
}

/// Albedo: the mean weight of n samples, whose random numbers cover the unit cube evenly (Roberts 2018, a
/// generalization of the golden ratio). The error falls as 1/n, not as the root of it.
template <class Bsdf>
double albedo_of(const Bsdf& bsdf, Vec3 wo, int n = 30000)
{
    constexpr double steps[] = {0.8191725134, 0.6710436067, 0.5497004779};
    double sum = 0;
    int count = 0;
    while (count < n) {
        float u[3][lanes], weight[lanes];
        for (int i = 0; i < lanes; ++i, ++count)
            for (int k = 0; k < 3; ++k) u[k][i] = float(std::fmod(0.5 + count * steps[k], 1.0)) * (1 - 0x1p-23f);
        store(weight, bsdf.sample(wo, {load(u[0]), load(u[1])}, load(u[2])).weight.c[0]);
        for (const float w : weight) sum += double(w);
    }
    return sum / count;
}

struct Drawn {
    std::vector<Direction> directions;
    double worst_mismatch = 0;  ///< largest relative difference of weight * pdf and f_cos
};

template <class Bsdf>
Drawn draw(const Bsdf& bsdf, Vec3 wo, int n, unsigned seed = 1)
{
    Drawn drawn;
    Random random(seed);
    for (int count = 0; count < n; count += lanes) {
        const BsdfSample s = bsdf.sample(wo, random.next2(), random.next());
        const BsdfEval e = bsdf.eval(wo, s.wi);
        float x[3][lanes], weight[lanes], pdf[lanes], f[lanes], eval_pdf[lanes];
        store(x[0], s.wi.x), store(x[1], s.wi.y), store(x[2], s.wi.z);
        store(weight, s.weight.c[0]), store(pdf, s.pdf), store(f, e.f_cos.c[0]), store(eval_pdf, e.pdf);
        for (int i = 0; i < lanes; ++i) {
            EXPECT_TRUE(std::isfinite(weight[i]) && weight[i] >= 0);
            if (weight[i] == 0) continue;
            drawn.directions.push_back({x[0][i], x[1][i], x[2][i]});
            if (mask_bits(s.is_delta) & 1) continue;
            drawn.worst_mismatch = std::max({drawn.worst_mismatch,
                                             std::abs(double(weight[i]) * pdf[i] - f[i]) / std::max(double(f[i]), 1e-6),
                                             std::abs(double(eval_pdf[i]) - pdf[i]) / std::max(double(pdf[i]), 1e-6)});
        }
    }
    return drawn;
}

template <class Bsdf>
double pdf_at(const Bsdf& bsdf, Vec3 wo, Direction d)
{
    return first(bsdf.eval(wo, lane_direction(d)).pdf);
}

/// Checks that samples follow the pdf, and that sample, eval and pdf agree.
template <class Bsdf>
void check_sampling(const Bsdf& bsdf, double degrees, const char* what)
{
    SCOPED_TRACE(std::string(what) + " at " + std::to_string(degrees));
    const Vec3 wo = outgoing(degrees);
    const Drawn drawn = draw(bsdf, wo, 200000);
    EXPECT_LT(drawn.worst_mismatch, 2e-3);
    // Absorbed samples (weight 0) are excluded from the histogram.
    const std::vector<double> cells = integrate_cells([&](Direction d) { return pdf_at(bsdf, wo, d); });
    const double total = std::accumulate(cells.begin(), cells.end(), 0.0);
    EXPECT_LE(total, 1.002);
    const double kept = double(drawn.directions.size()) / 200000;
    EXPECT_NEAR(total, kept, 0.01);
    EXPECT_EQ(chi_square_of_cells(drawn.directions, cells), "");
}

}  // namespace fathom::test
