// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "closure_checks.h"
#include "materials/closures/closures.h"

// Tests of BSDFs against the formulas of their papers, reimplemented in double precision.
namespace fathom {
namespace {

using test::Direction;
using test::first;
using test::lane_direction;
using test::material;
using test::outgoing;

double dot3(Direction a, Direction b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Direction towards(double theta_degrees, double phi_degrees)
{
    const double t = theta_degrees * std::numbers::pi / 180, p = phi_degrees * std::numbers::pi / 180;
    return {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
}
Direction half_way(Direction a, Direction b)
{
    Direction h{a.x + b.x, a.y + b.y, a.z + b.z};
    const double l = std::sqrt(dot3(h, h));
    return {h.x / l, h.y / l, h.z / l};
}

/// GGX distribution in terms of the tangent: Walter et al. 2007, equation 33.
double ggx_d(Direction h, double alpha)
{
    const double c2 = h.z * h.z, t2 = (1 - c2) / c2;
    return alpha * alpha / (std::numbers::pi * c2 * c2 * (alpha * alpha + t2) * (alpha * alpha + t2));
}
double ggx_lambda(Direction w, double alpha)
{
    const double t2 = (1 - w.z * w.z) / (w.z * w.z);
    return (std::sqrt(1 + alpha * alpha * t2) - 1) / 2;
}
/// f cos of wi for perfectly reflecting microfacets.
double ggx_f_cos(Direction wo, Direction wi, double alpha)
{
    if (wi.z <= 0) return 0;
    const double g2 = 1 / (1 + ggx_lambda(wo, alpha) + ggx_lambda(wi, alpha));
    return ggx_d(half_way(wo, wi), alpha) * g2 / (4 * wo.z);
}
double schlick(double color, double cosine)
{
    return color + (1 - color) * std::pow(1 - cosine, 5);
}

const Direction some_directions[] = {towards(3, 10), towards(20, 200), towards(45, 100), towards(60, 330),
                                     towards(80, 45)};

TEST(Ggx, DistributionAndMasking)
{
    for (double alpha : {0.05, 0.3, 1.0}) {
        const Ggx ggx{Float(float(alpha))};
        // The projected area of all microfacets is 1.
        if (alpha > 0.1) {
            EXPECT_NEAR(test::integrate_sphere([&](Direction h) { return h.z > 0 ? ggx_d(h, alpha) * h.z : 0.0; }), 1,
                        1e-3);
        }
        for (const Direction& a : some_directions) {
            EXPECT_NEAR(first(ggx.d(lane_direction(a))) / ggx_d(a, alpha), 1, 2e-5);
            EXPECT_NEAR(first(ggx.g1(lane_direction(a))), 1 / (1 + ggx_lambda(a, alpha)), 1e-5);
            for (const Direction& b : some_directions)
                EXPECT_NEAR(first(ggx.g2(lane_direction(a), lane_direction(b))),
                            1 / (1 + ggx_lambda(a, alpha) + ggx_lambda(b, alpha)), 1e-5);
        }
    }
}

/// The tables of the single-scattering albedo agree with numerical integration.
TEST(Ggx, AlbedoTables)
{
    for (double roughness : {0.5, 0.7, 1.0})
        for (double degrees : {10.0, 50.0, 75.0}) {
            const Direction wo = towards(degrees, 0);
            const double alpha = roughness * roughness;
            const double albedo =
                test::integrate_sphere([&](Direction wi) { return ggx_f_cos(wo, wi, alpha); }, 256, 256);
            const double weighted = test::integrate_sphere(
                [&](Direction wi) {
                    return ggx_f_cos(wo, wi, alpha) * std::pow(1 - std::min(1.0, dot3(wo, half_way(wo, wi))), 5);
                },
                256, 256);
            EXPECT_NEAR(first(ggx_albedo(Float(float(wo.z)), Float(float(roughness)))), albedo, 3e-3);
            EXPECT_NEAR(first(albedo_lookup(ggx_schlick_table, Float(float(wo.z)), Float(float(roughness)))), weighted,
                        3e-3);
        }
}

/// Energy compensation factor for microfacets with Schlick's reflectance: Turquin 2019, equation 16.
double compensation_factor(double color, double albedo)
{
    return 1 + color * (1 - albedo) / albedo;
}

TEST(Metal, IsTheFormula)
{
    for (float roughness : {0.25f, 0.6f, 1.0f})
        for (const Direction& wo : some_directions)
            for (const Direction& wi : some_directions) {
                MetalPoint m = material(0, roughness);
                m.base_color.c[0] = Float(0.9f), m.base_color.c[1] = Float(0.5f), m.base_color.c[2] = Float(0.1f);
                const BsdfEval e = MetalBsdf(m).eval(lane_direction(wo), lane_direction(wi));
                const double alpha = double(roughness) * double(roughness);
                const double albedo = first(ggx_albedo(Float(float(wo.z)), Float(roughness)));
                const double colors[] = {0.9, 0.5, 0.1};
                for (int c = 0; c < 3; ++c) {
                    const double expected = schlick(colors[c], dot3(wo, half_way(wo, wi))) *
                                            compensation_factor(colors[c], albedo) * ggx_f_cos(wo, wi, alpha);
                    EXPECT_NEAR(first(e.f_cos.c[c]) / expected, 1, 1e-4);
                }
            }
}

/// The closure is the formula of glTF 2.0, appendix B: a mixture of a metal and of a dielectric whose base gets the
/// light that the specular layer leaves.
TEST(Principled, IsTheFormula)
{
    const double color = 0.6, roughness = 0.5;
    for (float metallic : {0.0f, 0.3f, 1.0f})
        for (float ior : {1.3f, 1.5f, 2.0f})
            for (const Direction& wo : some_directions)
                for (const Direction& wi : some_directions) {
                    const BsdfEval e = PrincipledBsdf(material(float(color), float(roughness), metallic, ior))
                                           .eval(lane_direction(wo), lane_direction(wi));
                    const double f0 = std::pow((double(ior) - 1) / (double(ior) + 1), 2);
                    const Float z(float(wo.z)), r { float(roughness) };
                    const double albedo = first(ggx_albedo(z, r)),
                                 weighted = first(albedo_lookup(ggx_schlick_table, z, r));
                    const double facets = ggx_f_cos(wo, wi, roughness * roughness), h = dot3(wo, half_way(wo, wi));
                    const double layer = (f0 * albedo + (1 - f0) * weighted) * compensation_factor(f0, albedo);
                    const double dielectric = schlick(f0, h) * compensation_factor(f0, albedo) * facets +
                                              color * (1 - std::min(1.0, layer)) * wi.z / std::numbers::pi;
                    const double metal = schlick(color, h) * compensation_factor(color, albedo) * facets,
                                 m = double(metallic);
                    EXPECT_NEAR(first(e.f_cos.c[0]) / (m * metal + (1 - m) * dielectric), 1, 2e-4)
                        << metallic << " " << ior;
                }
}

/// The closure is that of Portsmouth, Kutz, Hill 2024, "EON: A practical energy-preserving rough diffuse BRDF", with
/// its fitted albedo.
TEST(Diffuse, IsTheFormula)
{
    const double pi_d = std::numbers::pi;
    for (double r : {0.0, 0.4, 1.0})
        for (const Direction& wo : some_directions)
            for (const Direction& wi : some_directions) {
                const double color = 0.7;
                const double af = 1 / (1 + (0.5 - 2 / (3 * pi_d)) * r);
                const auto albedo = [&](double mu) {
                    const double m = 1 - mu;
                    const double g =
                        0.0571085289 * m + 0.491881867 * m * m - 0.332181442 * m * m * m + 0.0714429953 * m * m * m * m;
                    return (1 + r * g) * af;
                };
                const double s = wo.x * wi.x + wo.y * wi.y, st = s > 0 ? s / std::max(wo.z, wi.z) : s;
                const double mean = af * (1 + (2.0 / 3 - 28 / (15 * pi_d)) * r);
                const double many = color * color * mean / (1 - color * (1 - mean)) * (1 - albedo(wo.z)) *
                                    (1 - albedo(wi.z)) / std::max(1e-7, 1 - mean);
                const double expected = (color * af * (1 + r * st) + (r > 0 ? many : 0)) * wi.z / pi_d;
                const BsdfEval e =
                    DiffuseBsdf(material(float(color), float(r))).eval(lane_direction(wo), lane_direction(wi));
                EXPECT_NEAR(first(e.f_cos.c[1]) / expected, 1, 1e-4) << r;
            }
}

/// Reflectance follows from Fresnel's equations in sines and tangents of the angles, and the direction from Snell's
/// law.
TEST(Glass, FresnelAndSnellByAngles)
{
    for (double eta : {1 / 2.4, 1 / 1.5, 1.1, 1.5, 2.4})
        for (double degrees : {1.0, 20.0, 41.0, 56.0, 70.0, 89.0}) {
            const double i = degrees * std::numbers::pi / 180, sine = std::sin(i) / eta;
            Float cos_t;
            const double r = first(fresnel_dielectric(Float(float(std::cos(i))), Float(float(eta)), cos_t));
            if (sine >= 1) {
                EXPECT_EQ(r, 1);
                continue;
            }
            const double t = std::asin(sine);
            const double s = std::sin(i - t) / std::sin(i + t), p = std::tan(i - t) / std::tan(i + t);
            EXPECT_NEAR(r, (s * s + p * p) / 2, 2e-5) << eta << " " << degrees;
            EXPECT_NEAR(first(cos_t), std::cos(t), 2e-5);
            // The direction lies in the plane of incidence, on the other side of the normal.
            const Vec3 wi = refract(outgoing(degrees), lane_direction({0, 0, 1}), Float(float(std::cos(i))), cos_t,
                                    Float(float(eta)));
            EXPECT_NEAR(first(wi.x), -std::sin(t), 2e-5);
            EXPECT_NEAR(first(wi.y), 0, 1e-6);
            EXPECT_NEAR(first(wi.z), -std::cos(t), 2e-5);
        }
}

/// Smooth glass reflects with Fresnel's probability; otherwise it refracts, with radiance scaled by the squared ratio
/// of indices.
TEST(Glass, SmoothSplitsByFresnel)
{
    for (const bool entering : {true, false})
        for (double degrees : {0.0, 30.0, 60.0}) {
            GlassPoint m = material(1, 0, 0, 1.5f);
            m.entering = Mask(entering);
            const double eta = entering ? 1.5 : 1 / 1.5, i = degrees * std::numbers::pi / 180;
            Float cos_t;
            const double r = first(fresnel_dielectric(Float(float(std::cos(i))), Float(float(eta)), cos_t));
            int reflected = 0;
            constexpr int n = 1000;
            for (int k = 0; k < n; ++k) {
                const BsdfSample s =
                    GlassBsdf(m).sample(outgoing(degrees), {Float(0.3f), Float(0.7f)}, Float((float(k) + 0.5f) / n));
                const bool mirrors = first(s.wi.z) > 0;
                reflected += mirrors;
                EXPECT_NEAR(first(s.wi.x), mirrors ? -std::sin(i) : -std::sin(i) / eta, 1e-5);
                EXPECT_NEAR(first(s.weight.c[0]), mirrors ? 1 : 1 / (eta * eta), 1e-5);
                EXPECT_NEAR(first(s.eta), mirrors ? 1 : eta, 1e-6);
                EXPECT_TRUE(first(s.is_delta));
            }
            EXPECT_NEAR(reflected, r * n, 1);
        }
}

/// The closure is reciprocal up to the squared ratio of indices (Veach 1997, 5.2).
TEST(Glass, IsReciprocal)
{
    for (float roughness : {0.4f, 0.8f})
        for (double a : {10.0, 50.0})
            for (double b : {100.0, 130.0, 165.0, 20.0, 70.0}) {
                const Direction wo = towards(a, 0), wi = towards(b, 160);
                GlassPoint m = material(1, roughness);
                // Energy compensation depends on one direction only, so it is not reciprocal.
                m.compensated = Mask(false);
                const double there = first(GlassBsdf(m).eval(lane_direction(wo), lane_direction(wi)).f_cos.c[0]);
                const bool through = wi.z < 0;
                // The shading frame is flipped to the path's side.
                const double side = through ? -1 : 1;
                m.entering = Mask(!through);
                const double back = first(
                    GlassBsdf(m)
                        .eval(lane_direction({wi.x, wi.y, side * wi.z}), lane_direction({wo.x, wo.y, side * wo.z}))
                        .f_cos.c[0]);
                const double scale = through ? 1.5 * 1.5 : 1;
                if (there == 0) continue;
                EXPECT_NEAR(there * scale / std::abs(wi.z) / (back / wo.z), 1, 1e-3)
                    << roughness << " " << a << " " << b;
            }
}

/// Directional albedo of glass: mean weight of samples with the radiance scaling by eta^2 undone.
double mean_weight(const GlassPoint& m, double degrees, int n)
{
    const GlassBsdf bsdf(m);
    test::Random random;
    double sum = 0;
    int count = 0;
    for (; count < n; count += lanes) {
        const BsdfSample s = bsdf.sample(outgoing(degrees), random.next2(), random.next());
        float w[lanes];
        store(w, s.weight.c[0] * s.eta * s.eta);
        for (float x : w) sum += x;
    }
    return sum / count;
}

/// Single scattering by slightly rough microfacets loses almost nothing.
TEST(Glass, RoughKeepsNearlyAllEnergy)
{
    for (const bool entering : {true, false})
        for (double degrees : {0.0, 30.0}) {
            GlassPoint m = material(1, 0.25f);
            m.entering = Mask(entering);
            m.compensated = Mask(false);
            EXPECT_NEAR(mean_weight(m, degrees, 20000), 1, 0.01) << entering << " " << degrees;
        }
}

/// With energy compensation, white glass of any roughness and index is lossless from both sides at every angle.
TEST(Glass, CompensatedIsWhite)
{
    for (const float ior : {1.05f, 1.33f, 1.5f, 2.4f, 4.0f})
        for (const float roughness : {0.1f, 0.3f, 0.6f, 0.85f, 1.0f})
            for (const bool entering : {true, false})
                for (const double degrees : {0.0, 35.0, 60.0, 80.0}) {
                    GlassPoint m = material(1, roughness, 0, ior);
                    m.entering = Mask(entering);
                    EXPECT_NEAR(mean_weight(m, degrees, 20000), 1, 0.025)
                        << "index " << ior << ", roughness " << roughness
                        << (entering ? ", entering at " : ", leaving at ") << degrees;
                }
}

/// The albedo without energy compensation agrees with integration over visible normals in double precision.
TEST(Glass, LossOfASingleScatteringEvent)
{
    const struct {
        float roughness;
        bool entering;
        double degrees, albedo;
    } cases[] = {{0.5f, true, 0, 0.992},  {0.8f, true, 0, 0.950},  {1, true, 0, 0.894},  {1, true, 53.13, 0.770},
                 {0.5f, false, 0, 0.929}, {0.8f, false, 0, 0.646}, {1, false, 0, 0.417}, {1, false, 53.13, 0.514}};
    for (const auto& c : cases) {
        GlassPoint m = material(1, c.roughness);
        m.entering = Mask(c.entering);
        m.compensated = Mask(false);
        EXPECT_NEAR(mean_weight(m, c.degrees, 40000), c.albedo, 0.01)
            << c.roughness << " " << c.entering << " " << c.degrees;
    }
}

}  // namespace
}  // namespace fathom
