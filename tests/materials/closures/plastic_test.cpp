// SPDX-License-Identifier: Apache-2.0
#include "materials/closures/plastic.h"

#include <random>

#include "materials/closure_checks.h"

namespace fathom::test {
namespace {

PlasticPoint plastic(float color, float roughness, float ior = 1.5f, bool compensated = true)
{
    PlasticPoint m = material(color, roughness, 0, ior);
    m.compensated = Mask(compensated);
    return m;
}

double albedo(const PlasticPoint& m, double degrees)
{
    return albedo_of(PlasticBsdf(m), outgoing(degrees));
}

TEST(Plastic, Sampling)
{
    for (double degrees : {0.0, 45.0, 80.0})
        for (bool compensated : {false, true})
            check_sampling(PlasticBsdf(plastic(0.6f, 0.5f, 1.5f, compensated)), degrees, "plastic");
}

/// A white base is lossless, and no energy is created.
TEST(Plastic, WhiteFurnace)
{
    for (double degrees : {0.0, 45.0, 75.0})
        for (float roughness : {0.0f, 0.2f, 0.45f, 0.7f, 1.0f})
            for (float ior : {1.0f, 1.3f, 1.5f, 1.9f})
                EXPECT_NEAR(albedo(plastic(1, roughness, ior), degrees), 1, 0.012)
                    << degrees << " " << roughness << " " << ior;
}

/// A tint scales only the boundary's reflection.
TEST(Plastic, TintOfTheBoundary)
{
    PlasticPoint black = plastic(0, 0.4f), white = plastic(1, 0.4f), tinted = white;
    tinted.reflection_color = Spectrum(Float(0.25f));
    const Vec3 wo = outgoing(30), wi = outgoing(-50);
    const auto value = [&](const PlasticPoint& m) { return double(first(PlasticBsdf(m).eval(wo, wi).f_cos.c[0])); };
    EXPECT_NEAR(value(tinted), value(white) - 0.75 * value(black), 1e-6);
    EXPECT_GT(value(black), 0.01);
}

/// The BSDF is reciprocal: f is equal for swapped directions.
TEST(Plastic, IsReciprocal)
{
    for (float roughness : {0.3f, 0.8f})
        for (bool compensated : {false, true}) {
            const PlasticBsdf bsdf(plastic(0.5f, roughness, 1.5f, compensated));
            const Vec3 a = outgoing(20), b = outgoing(-65);
            const double there = first(bsdf.eval(a, b).f_cos.c[0]) / first(b.z),
                         back = first(bsdf.eval(b, a).f_cos.c[0]) / first(a.z);
            EXPECT_NEAR(there, back, 1e-5 * there);
        }
}

/// Fresnel reflectance of a dielectric.
double fresnel(double cosine, double ior)
{
    const double t = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
    const double p = (ior * cosine - t) / (ior * cosine + t), s = (cosine - ior * t) / (cosine + ior * t);
    return (p * p + s * s) / 2;
}

/// A smooth boundary has a closed form: F + (1 - F) color (1 - inner) / (1 - color inner), where inner follows from the
/// mean of F by reciprocity.
TEST(Plastic, SmoothIsTheClosedForm)
{
    for (double ior : {1.33, 1.5, 1.8}) {
        double mean = 0;
        constexpr int steps = 4000;
        for (int i = 0; i < steps; ++i) {
            const double c = (i + 0.5) / steps;
            mean += 2 * fresnel(c, ior) * c / steps;
        }
        const double inner = 1 - (1 - mean) / (ior * ior);
        for (double degrees : {0.0, 40.0, 70.0})
            for (double color : {0.0, 0.3, 0.8}) {
                const double f = fresnel(std::cos(degrees * std::numbers::pi / 180), ior);
                const double nonlinear = f + (1 - f) * color * (1 - inner) / (1 - color * inner);
                PlasticPoint m = plastic(float(color), 0, float(ior));
                EXPECT_NEAR(albedo(m, degrees), nonlinear, 0.004) << ior << " " << degrees << " " << color;
                m.nonlinear = Mask(false);
                EXPECT_NEAR(albedo(m, degrees), f + (1 - f) * color, 0.004) << ior << " " << degrees << " " << color;
            }
    }
}

/// An absorbing layer attenuates light on the way in, on the way out, and between base and boundary.
TEST(Plastic, LayersAbsorb)
{
    constexpr double ior = 1.5, thickness = 0.2, color = 0.8;
    double out = 0, inner = 0, inner_all = 0;
    constexpr int steps = 4000;
    for (int i = 0; i < steps; ++i) {
        const double c = (i + 0.5) / steps, s2 = (1 - c * c) * ior * ior;
        const double back = s2 < 1 ? fresnel(std::sqrt(1 - s2), ior) : 1;
        out += 2 * (1 - back) * std::exp(-thickness / c) * c / steps;
        inner += 2 * back * std::exp(-2 * thickness / c) * c / steps;
        inner_all += 2 * back * c / steps;
    }
    PlasticPoint m = plastic(float(color), 0, float(ior));
    m.optical_thickness = Float(float(thickness)), m.internal_absorption = Float(float(1 - inner / inner_all));
    for (const double degrees : {0.0, 40.0, 70.0}) {
        const double c = std::cos(degrees * std::numbers::pi / 180), f = fresnel(c, ior);
        const double in = (1 - f) * std::exp(-thickness / std::sqrt(1 - (1 - c * c) / (ior * ior)));
        EXPECT_NEAR(albedo(m, degrees), f + in * color * out / (1 - color * inner), 0.004) << degrees;
    }
    check_sampling(PlasticBsdf(m), 40, "a layer that absorbs");
}

/// Albedo by a random walk between microfacets and base, with sampled normals and Fresnel's equations. Samples on a
/// facet's wrong side are lost, as in pbrt's layered BxDFs.
double random_walk_albedo(double alpha, double color, double ior, double degrees)
{
    std::mt19937_64 engine(3);
    std::uniform_real_distribution<double> uniform;
    struct V {
        double x, y, z;
    };
    const auto lambda = [&](double z) { return (std::sqrt(1 + alpha * alpha * (1 - z * z) / (z * z)) - 1) / 2; };
    // The sampled normal is a visible normal of an ellipsoid (Heitz 2018).
    const auto normal = [&](const V& w) {
        const double x = alpha * w.x, y = alpha * w.y, l = std::sqrt(x * x + y * y + w.z * w.z);
        const V h{x / l, y / l, w.z / l};
        const double s = std::hypot(h.x, h.y);
        const V t1 = s > 1e-9 ? V{-h.y / s, h.x / s, 0} : V{1, 0, 0};
        const V t2{h.y * t1.z - h.z * t1.y, h.z * t1.x - h.x * t1.z, h.x * t1.y - h.y * t1.x};
        const double r = std::sqrt(uniform(engine)), phi = 2 * std::numbers::pi * uniform(engine);
        const double a = r * std::cos(phi);
        const double mix = (1 + h.z) / 2, b = (1 - mix) * std::sqrt(1 - a * a) + mix * r * std::sin(phi);
        const double c = std::sqrt(std::max(0.0, 1 - a * a - b * b));
        const V n{alpha * (a * t1.x + b * t2.x + c * h.x), alpha * (a * t1.y + b * t2.y + c * h.y),
                  std::max(1e-9, a * t1.z + b * t2.z + c * h.z)};
        const double k = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
        return V{n.x / k, n.y / k, n.z / k};
    };
    constexpr int paths = 100000;
    double sum = 0;
    for (int i = 0; i < paths; ++i) {
        const double t = degrees * std::numbers::pi / 180;
        V w{std::sin(t), 0, std::cos(t)};  // the direction is towards the boundary at z = 0, from either side
        double left = 1, eta = ior;
        bool inside = false;
        for (int step = 0; step < 200 && left > 0; ++step) {
            const V n = normal(w);
            const double c = w.x * n.x + w.y * n.y + w.z * n.z, s2 = (1 - c * c) / (eta * eta);
            const double f = s2 >= 1 ? 1 : fresnel(c, eta);
            const bool reflected = uniform(engine) < f;
            const double beyond = std::sqrt(std::max(0.0, 1 - s2)), k = c / eta - beyond;
            const double z = reflected ? 2 * c * n.z - w.z : -(k * n.z - w.z / eta);
            left = z > 1e-9 ? left * (1 + lambda(w.z)) / (1 + lambda(w.z) + lambda(z)) : 0;
            if (reflected != inside) {  // the walk is outside now
                sum += left;
                break;
            }
            inside = true, eta = 1 / ior, left *= color;
            const double u = uniform(engine), phi = 2 * std::numbers::pi * uniform(engine);
            w = {std::sqrt(u) * std::cos(phi), std::sqrt(u) * std::sin(phi), std::sqrt(1 - u)};
        }
    }
    return sum / paths;
}

TEST(Plastic, WithoutCompensationAsAWalkBetweenFacetsAndBody)
{
    for (double ior : {1.5, 1.7})
        for (double roughness : {0.25, 0.4, 0.6})
            for (double color : {0.2, 0.8})
                for (double degrees : {10.0, 55.0, 75.0})
                    EXPECT_NEAR(albedo(plastic(float(color), float(roughness), float(ior), false), degrees),
                                random_walk_albedo(roughness * roughness, color, ior, degrees), 0.007)
                        << ior << " " << roughness << " " << color << " " << degrees;
}

}  // namespace
}  // namespace fathom::test
