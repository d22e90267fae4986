// SPDX-License-Identifier: Apache-2.0
#include "materials/closures/hair.h"

#include <random>

#include "materials/closure_checks.h"

namespace fathom::test {
namespace {

constexpr double pi_ = std::numbers::pi, degree = pi_ / 180;

struct Fibre {
    double beta_m = 0.3, beta_n = 0.3, tilt = 2 * degree, eta = 1.55, sigma = 0, h = 0;

    double fit() const
    {
        const double n = beta_n;
        return 5.969 - 0.215 * n + 2.532 * n * n - 10.73 * std::pow(n, 3) + 5.574 * std::pow(n, 4) +
               0.245 * std::pow(n, 5);
    }
    HairBsdf bsdf() const
    {
        HairPoint m = material(float(std::exp(-std::sqrt(sigma) * fit())), 0, 0, float(eta));
        m.beta_m = Float(float(beta_m)), m.beta_n = Float(float(beta_n));
        m.scale_tilt = Float(float(tilt)), m.across = Float(float(h));
        return HairBsdf(m);
    }
};

Direction direction(double theta, double phi)
{
    return {std::sin(theta), std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi)};
}

double f_at(const HairBsdf& bsdf, Direction wo, Direction wi)
{
    return first(bsdf.eval(lane_direction(wo), lane_direction(wi)).f_cos.c[0]);
}

/// Fractions of R, TT, TRT and the rest in double precision, by a geometric series of internal reflections.
std::vector<double> lobe_weights(const Fibre& x, double theta)
{
    const double cos_theta = std::cos(theta), s = std::sin(theta);
    const double cosine = cos_theta * std::sqrt(1 - x.h * x.h);
    const double t = std::sqrt(1 - (1 - cosine * cosine) / (x.eta * x.eta));
    const double p = (x.eta * cosine - t) / (x.eta * cosine + t), q = (cosine - x.eta * t) / (cosine + x.eta * t);
    const double f = (p * p + q * q) / 2;
    const double eta_p = std::sqrt(x.eta * x.eta - s * s) / cos_theta, sin_t = x.h / eta_p;
    const double way = 2 * std::sqrt(1 - sin_t * sin_t) / std::sqrt(1 - s * s / (x.eta * x.eta));
    const double left = std::exp(-x.sigma * way);
    std::vector<double> a{f, (1 - f) * (1 - f) * left, (1 - f) * (1 - f) * left * left * f, 0};
    double part = a[2];
    for (int i = 0; i < 1000; ++i) a[3] += part *= left * f;
    return a;
}

/// The complete hair model from the papers' formulas in double precision, with sums and the series of Bessel's
/// function.
double formula(const Fibre& x, double theta_o, double phi_o, double theta_i, double phi_i)
{
    const std::vector<double> a = lobe_weights(x, theta_o);
    const double v0 = std::pow(0.726 * x.beta_m + 0.812 * x.beta_m * x.beta_m + 3.7 * std::pow(x.beta_m, 20), 2);
    const double v[] = {v0, v0 / 4, 4 * v0, 4 * v0};
    const double s =
        std::sqrt(pi_ / 8) * (0.265 * x.beta_n + 1.194 * x.beta_n * x.beta_n + 5.372 * std::pow(x.beta_n, 22));
    const double tilt[] = {-2 * x.tilt, x.tilt, 4 * x.tilt, 0};
    const double eta_p = std::sqrt(x.eta * x.eta - std::pow(std::sin(theta_o), 2)) / std::cos(theta_o);
    const double gamma = std::asin(x.h), gamma_t = std::asin(x.h / eta_p);
    double sum = 0;
    for (int p = 0; p < 4; ++p) {
        const double o = theta_o + tilt[p], arg = std::cos(theta_i) * std::abs(std::cos(o)) / v[p];
        double i0 = 0, term = 1;
        for (int k = 1; k < 400 && term > 0; ++k) i0 += term, term *= arg * arg / (4.0 * k * k);
        const double m = std::exp(-std::sin(theta_i) * std::sin(o) / v[p]) * i0 / (2 * v[p] * std::sinh(1 / v[p]));
        double n = 1 / (2 * pi_);
        if (p < 3) {
            const double off = std::remainder(phi_i - phi_o - (2 * p * gamma_t - 2 * gamma + p * pi_), 2 * pi_);
            const auto cdf = [&](double y) { return 1 / (1 + std::exp(-y / s)); };
            n = std::exp(-std::abs(off) / s) / (s * std::pow(1 + std::exp(-std::abs(off) / s), 2)) /
                (cdf(pi_) - cdf(-pi_));
        }
        sum += a[std::size_t(p)] * m * n;
    }
    return sum;
}

TEST(Hair, IsThePapersFormula)
{
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> u;
    for (int i = 0; i < 4000; ++i) {
        const Fibre x{0.12 + 0.88 * u(engine), 0.1 + 0.9 * u(engine),      (u(engine) - 0.3) * 0.2,
                      1.2 + u(engine),         2 * std::pow(u(engine), 3), 1.98 * u(engine) - 0.99};
        const double theta_o = (u(engine) - 0.5) * 3, phi_o = u(engine) * pi_, theta_i = (u(engine) - 0.5) * 3,
                     phi_i = u(engine) * 2 * pi_;
        const double expected = formula(x, theta_o, phi_o, theta_i, phi_i);
        EXPECT_NEAR(f_at(x.bsdf(), direction(theta_o, phi_o), direction(theta_i, phi_i)), expected,
                    1e-3 * expected + 1e-5)
            << i;
    }
}

TEST(Hair, Sampling)
{
    for (double degrees : {10.0, -70.0})
        for (double h : {0.6, -0.95}) {
            check_sampling(Fibre{.h = h}.bsdf(), degrees, "hair");
            check_sampling(Fibre{.beta_m = 0.8, .beta_n = 0.9, .sigma = 0.4, .h = h}.bsdf(), degrees, "rough hair");
            check_sampling(Fibre{.beta_m = 0.2, .beta_n = 0.15, .tilt = 0.1, .sigma = 2, .h = h}.bsdf(), degrees,
                           "smooth hair");
        }
}

/// Albedo is the sum over all internal paths: 1 without absorption.
TEST(Hair, Energy)
{
    const auto integral = [](const HairBsdf& bsdf, Direction wo) {
        constexpr int rows = 160, columns = 400;
        double sum = 0;
        for (int i = 0; i < rows; ++i)
            for (int k = 0; k < columns; ++k) {
                const double theta = pi_ * ((i + 0.5) / rows - 0.5);
                sum += std::cos(theta) * f_at(bsdf, wo, direction(theta, 2 * pi_ * (k + 0.5) / columns));
            }
        return sum * 2 * pi_ * pi_ / (rows * columns);
    };
    for (double sigma : {0.0, 0.3, 3.0})
        for (double beta_m : {0.1, 0.3, 1.0})
            for (double beta_n : {0.1, 0.3, 1.0})
                for (double theta : {0.0, 0.5, -1.2})
                    for (double h : {-0.9, 0.2}) {
                        const Fibre x{beta_m, beta_n, 2 * degree, 1.55, sigma, h};
                        const std::vector<double> a = lobe_weights(x, theta);
                        const double expected = a[0] + a[1] + a[2] + a[3];
                        if (sigma == 0) EXPECT_NEAR(expected, 1, 1e-9);
                        EXPECT_NEAR(integral(x.bsdf(), direction(theta, pi_ / 2)), expected, 0.001 * expected)
                            << sigma << " " << beta_m << " " << beta_n << " " << theta << " " << h;
                    }
}

/// Samples in a white furnace have weight 1 over the whole width, also for narrow lobes.
TEST(Hair, WhiteFurnaceAcrossTheWidth)
{
    for (double beta : {0.0, 0.02, 0.3, 1.0})
        for (double degrees : {0.0, 60.0, 88.0}) {
            double sum = 0;
            constexpr int steps = 32;
            for (int i = 0; i < steps; ++i)
                sum += albedo_of(Fibre{.beta_m = beta, .beta_n = beta, .h = (i + 0.5) * 2 / steps - 1}.bsdf(),
                                 outgoing(degrees), 4000);
            EXPECT_NEAR(sum / steps, 1, 1e-3) << beta << " " << degrees;
        }
}

/// Narrow lobes follow a mirror reflection at the cylinder, and refraction through it by Snell's law.
TEST(Hair, NarrowLobesGoWhereACylinderSendsLight)
{
    for (double h : {-0.8, -0.3, 0.5}) {
        const Fibre x{.beta_m = 0.05, .beta_n = 0.05, .tilt = 0, .h = h};
        const double c = std::sqrt(1 - h * h);
        // The direction is reflected about the normal at height y = h.
        const Direction reflected{0, 2 * c * h, 2 * c * c - 1};
        // The direction is refracted into the cylinder, to its far side and out again, in the cross-sectional plane.
        const double in = std::asin(h), within = std::asin(h / x.eta);
        const double normal = pi_ / 2 - in;             // angle of the entry point, from y to z
        const double exit = normal + pi_ + 2 * within;  // angle of the exit point
        const double through = exit - in;               // light leaves at the angle to the normal at which it entered
        const Direction passed{0, std::cos(through), std::sin(through)};
        const HairBsdf bsdf = x.bsdf();
        for (const Direction& d : {reflected, passed}) {
            const double top = f_at(bsdf, {0, 0, 1}, d);
            for (double off : {-0.05, 0.05}) {
                const Direction beside{0, d.y * std::cos(off) - d.z * std::sin(off),
                                       d.y * std::sin(off) + d.z * std::cos(off)};
                EXPECT_GT(top, 1.2 * f_at(bsdf, {0, 0, 1}, beside)) << h << " " << d.y << " " << d.z;
                const Direction along{std::sin(off), std::cos(off) * d.y, std::cos(off) * d.z};
                EXPECT_GT(top, 1.2 * f_at(bsdf, {0, 0, 1}, along));
            }
        }
    }
}

/// Cuticle scales shift reflections towards the root by twice their tilt.
TEST(Hair, ScalesAreTilted)
{
    const HairBsdf bsdf = Fibre{.beta_m = 0.05, .beta_n = 0.3, .tilt = 5 * degree, .sigma = 50}.bsdf();
    double best = 0, at = 0;
    for (int i = -400; i <= 400; ++i) {
        const double theta = i * 0.1 * degree, f = f_at(bsdf, direction(0.2, pi_ / 2), direction(theta, pi_ / 2));
        if (f > best) best = f, at = theta;
    }
    EXPECT_NEAR(at, -0.2 + 10 * degree, 0.2 * degree);
}

TEST(Hair, ColorAndAbsorptionAreInverse)
{
    for (float beta_n : {0.05f, 0.3f, 0.9f})
        for (float c : {0.0f, 0.01f, 0.3f, 0.9f, 1.0f}) {
            const Spectrum sigma = hair_absorption(Spectrum(Float(c)), Float(beta_n));
            const Fibre x{.beta_n = beta_n};
            if (c > 0) EXPECT_NEAR(first(sigma.c[0]), std::pow(std::log(double(c)) / x.fit(), 2), 1e-5 * (1 + 1 / c));
            EXPECT_NEAR(first(hair_color(sigma, Float(beta_n)).c[0]), c, 2e-6);
        }
    EXPECT_EQ(first(hair_absorption(Spectrum(Float(1)), Float(0.3f)).c[0]), 0);
}

TEST(Hair, BesselFunction)
{
    for (double x : {0.0, 0.01, 1.0, 3.7, 3.8, 10.0, 80.0}) {
        double sum = 0;
        constexpr int steps = 20000;
        for (int i = 0; i < steps; ++i) sum += std::exp(x * (std::cos(pi_ * (i + 0.5) / steps) - 1)) / steps;
        EXPECT_NEAR(first(scaled_bessel_i0(Float(float(x)))), sum, 1e-6 * sum) << x;
    }
}

}  // namespace
}  // namespace fathom::test
