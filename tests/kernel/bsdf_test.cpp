#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "chi_square.h"
#include "lane_helpers.h"
#include "shading/bsdf.h"

namespace fathom {
namespace {

using test::Direction;
using test::first;

MaterialPoint material(float color, float roughness, float metallic = 0, float ior = 1.5f, float fuzz = 0)
{
    return {
        Spectrum(Float(color)), Float(roughness), Float(metallic), Float(ior), Float(fuzz), Mask(true), Mask(false)};
}
Vec3 lane_direction(Direction d)
{
    return {Float(float(d.x)), Float(float(d.y)), Float(float(d.z))};
}
Vec3 outgoing(double degrees)
{
    const double t = degrees * std::numbers::pi / 180;
    return lane_direction({std::sin(t), 0, std::cos(t)});
}

struct Drawn {
    std::vector<Direction> directions;
    double albedo = 0;          ///< mean weight
    double worst_mismatch = 0;  ///< of weight * pdf against f_cos, relative
};

template <class Bsdf>
Drawn draw(const Bsdf& bsdf, Vec3 wo, int n, unsigned seed = 1)
{
    Drawn drawn;
    test::Random random(seed);
    int count = 0;
    for (; count < n; count += lanes) {
        const BsdfSample s = bsdf.sample(wo, random.next2(), random.next());
        const BsdfEval e = bsdf.eval(wo, s.wi);
        float x[3][lanes], weight[lanes], pdf[lanes], f[lanes], eval_pdf[lanes];
        store(x[0], s.wi.x), store(x[1], s.wi.y), store(x[2], s.wi.z);
        store(weight, s.weight.c[0]), store(pdf, s.pdf), store(f, e.f_cos.c[0]), store(eval_pdf, e.pdf);
        for (int i = 0; i < lanes; ++i) {
            EXPECT_TRUE(std::isfinite(weight[i]) && weight[i] >= 0);
            drawn.albedo += weight[i];
            if (weight[i] == 0) continue;
            drawn.directions.push_back({x[0][i], x[1][i], x[2][i]});
            if (mask_bits(s.is_delta) & 1) continue;
            drawn.worst_mismatch = std::max({drawn.worst_mismatch,
                                             std::abs(double(weight[i]) * pdf[i] - f[i]) / std::max(double(f[i]), 1e-6),
                                             std::abs(double(eval_pdf[i]) - pdf[i]) / std::max(double(pdf[i]), 1e-6)});
        }
    }
    drawn.albedo /= count;
    return drawn;
}

template <class Bsdf>
double pdf_at(const Bsdf& bsdf, Vec3 wo, Direction d)
{
    return first(bsdf.eval(wo, lane_direction(d)).pdf);
}

/// Sampling follows the density, and sample, eval and pdf agree.
template <class Bsdf>
void check_sampling(const Bsdf& bsdf, double degrees, const char* what)
{
    SCOPED_TRACE(std::string(what) + " at " + std::to_string(degrees));
    const Vec3 wo = outgoing(degrees);
    const Drawn drawn = draw(bsdf, wo, 200000);
    EXPECT_LT(drawn.worst_mismatch, 2e-3);
    // Samples that are absorbed (weight 0) are missing: the test is of those that go on.
    const double total = test::integrate_sphere([&](Direction d) { return pdf_at(bsdf, wo, d); });
    EXPECT_LE(total, 1.002);
    const double kept = double(drawn.directions.size()) / 200000;
    EXPECT_NEAR(total, kept, 0.01);
    EXPECT_EQ(test::chi_square_directions(drawn.directions, [&](Direction d) { return pdf_at(bsdf, wo, d) / total; }),
              "");
}

TEST(Diffuse, SamplingAndFurnace)
{
    for (double degrees : {0.0, 45.0, 85.0}) {
        check_sampling(DiffuseBsdf(material(0.7f, 0)), degrees, "Lambert");
        check_sampling(DiffuseBsdf(material(0.7f, 0.8f)), degrees, "rough");
        // Nothing is lost or made: albedo 1 reflects all.
        for (float roughness : {0.0f, 0.5f, 1.0f})
            EXPECT_NEAR(draw(DiffuseBsdf(material(1, roughness)), outgoing(degrees), 400000).albedo, 1, 0.01);
    }
}

TEST(Diffuse, IsReciprocal)
{
    const DiffuseBsdf bsdf(material(0.7f, 0.9f));
    const Vec3 a = outgoing(20), b = lane_direction({0.3, 0.8, std::sqrt(1 - 0.09 - 0.64)});
    EXPECT_NEAR(first(bsdf.eval(a, b).f_cos.c[0] / b.z), first(bsdf.eval(b, a).f_cos.c[0] / a.z), 1e-5);
}

TEST(Metal, SamplingAndFurnace)
{
    for (double degrees : {0.0, 45.0, 80.0})
        for (float roughness : {0.3f, 0.6f, 1.0f})
            check_sampling(MetalBsdf(material(0.9f, roughness)), degrees, "metal");
    // A white metal reflects all light, also what facets scatter more than once.
    for (double degrees : {0.0, 30.0, 60.0, 85.0})
        for (float roughness : {0.0f, 0.1f, 0.3f, 0.5f, 0.8f, 1.0f})
            EXPECT_NEAR(draw(MetalBsdf(material(1, roughness)), outgoing(degrees), 200000).albedo, 1, 0.012)
                << degrees << " " << roughness;
}

TEST(Metal, SmoothIsAMirror)
{
    const MetalBsdf bsdf(material(0.8f, 0));
    const BsdfSample s = bsdf.sample(outgoing(30), {Float(0.3f), Float(0.7f)}, Float(0.5f));
    EXPECT_TRUE(first(s.is_delta));
    EXPECT_NEAR(first(s.wi.x), -0.5, 1e-6);
    EXPECT_NEAR(first(s.wi.z), std::sqrt(0.75), 1e-6);
    EXPECT_FALSE(first(bsdf.has_smooth()));
    EXPECT_EQ(first(bsdf.eval(outgoing(30), s.wi).f_cos.c[0]), 0);
}

TEST(FuzzMetal, HasTheDensityOfItsRecipe)
{
    for (double degrees : {0.0, 40.0, 75.0})
        for (float fuzz : {0.1f, 0.5f, 1.0f})
            check_sampling(FuzzMetalBsdf(material(0.9f, 0, 0, 1.5f, fuzz)), degrees, "fuzz");
    // At normal incidence with fuzz below 1 nothing goes below the surface.
    EXPECT_NEAR(draw(FuzzMetalBsdf(material(1, 0, 0, 1.5f, 0.9f)), outgoing(0), 100000).albedo, 1, 1e-6);
}

TEST(Glass, SamplingAgreesWithItsDensity)
{
    for (double degrees : {0.0, 45.0, 75.0})
        for (float roughness : {0.4f, 0.8f}) {
            MaterialPoint m = material(1, roughness);
            check_sampling(GlassBsdf(m), degrees, "glass from outside");
            m.entering = Mask(false);
            check_sampling(GlassBsdf(m), degrees, "glass from inside");
        }
}

TEST(Glass, SmoothKeepsAllEnergy)
{
    // Radiance is scaled by 1 / eta^2 when refracted: undone, every sample has weight 1.
    for (bool entering : {true, false})
        for (double degrees : {0.0, 30.0, 60.0, 85.0}) {
            MaterialPoint m = material(1, 0);
            m.entering = Mask(entering);
            const GlassBsdf bsdf(m);
            test::Random random;
            for (int i = 0; i < 100; ++i) {
                const BsdfSample s = bsdf.sample(outgoing(degrees), random.next2(), random.next());
                EXPECT_NEAR(first(s.weight.c[0] * s.eta * s.eta), 1, 1e-5);
                EXPECT_NEAR(first(dot(s.wi, s.wi)), 1, 1e-5);
            }
        }
}

TEST(Glass, ColourIsWhatASolidLeavesOfLightThatWentInAndOut)
{
    MaterialPoint m = material(0.25f, 0);
    for (const bool entering : {true, false}) {
        m.entering = Mask(entering);
        const GlassBsdf bsdf(m);
        const BsdfSample reflected = bsdf.sample(outgoing(20), {Float(0.5f), Float(0.5f)}, Float(0));
        const BsdfSample refracted = bsdf.sample(outgoing(20), {Float(0.5f), Float(0.5f)}, Float(0.99f));
        EXPECT_FLOAT_EQ(first(reflected.weight.c[0]), 1);
        EXPECT_LT(first(refracted.wi.z), 0);
        EXPECT_NEAR(first(refracted.weight.c[0] * refracted.eta * refracted.eta), 0.5f, 1e-6);
    }
}

MaterialPoint sheet(float color, float roughness)
{
    MaterialPoint m = material(color, roughness);
    m.thin = Mask(true);
    return m;
}

TEST(ThinGlass, SamplingAgreesWithItsDensity)
{
    for (double degrees : {0.0, 45.0, 75.0})
        for (float roughness : {0.4f, 0.8f}) check_sampling(GlassBsdf(sheet(0.7f, roughness)), degrees, "thin glass");
}

TEST(ThinGlass, LetsLightStraightOnFromBothSides)
{
    MaterialPoint m = sheet(0.5f, 0);
    for (const bool entering : {true, false}) {
        m.entering = Mask(entering);
        const GlassBsdf bsdf(m);
        // 4 % of each boundary: 2 * 0.04 / 1.04 = 1 / 13 of both.
        for (const auto& [choice, reflects] : {std::pair{1 / 13.0 - 1e-4, true}, {1 / 13.0 + 1e-4, false}}) {
            const BsdfSample s = bsdf.sample(outgoing(0), {Float(0.5f), Float(0.5f)}, Float(float(choice)));
            EXPECT_NEAR(first(s.wi.z), reflects ? 1 : -1, 1e-6);
            EXPECT_FLOAT_EQ(first(s.weight.c[0]), reflects ? 1 : 0.5f);
            EXPECT_EQ(first(s.eta), 1);
        }
        const Vec3 wo = outgoing(60);
        const BsdfSample through = bsdf.sample(wo, {Float(0.5f), Float(0.5f)}, Float(0.99f));
        EXPECT_NEAR(first(dot(through.wi, wo)), -1, 1e-6);
    }
    // White: nothing is lost, also of what facets scatter more than once.
    for (double degrees : {0.0, 30.0, 60.0, 85.0})
        for (float roughness : {0.1f, 0.5f, 0.8f, 1.0f})
            EXPECT_NEAR(draw(GlassBsdf(sheet(1, roughness)), outgoing(degrees), 200000).albedo, 1, 0.012)
                << degrees << " " << roughness;
}

TEST(Glass, FresnelAtNormalIncidenceAndBeyondTheCriticalAngle)
{
    Float cos_t;
    EXPECT_NEAR(first(fresnel_dielectric(Float(1), Float(1.5f), cos_t)), 0.04, 1e-6);
    EXPECT_EQ(first(fresnel_dielectric(Float(0.5f), Float(1 / 1.5f), cos_t)), 1);
    // Brewster's angle has no parallel part: half the perpendicular one.
    const double brewster = std::atan(1.5), ct = std::cos(std::asin(std::sin(brewster) / 1.5));
    const double perpendicular = (std::cos(brewster) - 1.5 * ct) / (std::cos(brewster) + 1.5 * ct);
    EXPECT_NEAR(first(fresnel_dielectric(Float(float(std::cos(brewster))), Float(1.5f), cos_t)),
                perpendicular * perpendicular / 2, 1e-6);
}

TEST(Principled, SamplingAndEnergy)
{
    for (double degrees : {0.0, 45.0, 80.0})
        for (float metallic : {0.0f, 0.5f, 1.0f}) {
            check_sampling(PrincipledBsdf(material(0.6f, 0.5f, metallic)), degrees, "principled");
            for (float roughness : {0.1f, 0.5f, 1.0f}) {
                const double albedo =
                    draw(PrincipledBsdf(material(1, roughness, metallic)), outgoing(degrees), 200000).albedo;
                EXPECT_LT(albedo, 1.02) << degrees << " " << metallic << " " << roughness;
                EXPECT_GT(albedo, metallic == 1 ? 0.98 : 0.7) << degrees << " " << metallic << " " << roughness;
            }
        }
}

// ---- against the papers' formulae, written again in double

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

/// Walter et al. 2007, equation 33, by the tangent.
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
/// Facets that reflect all: the bsdf times the cosine of wi.
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

const Direction some_directions[] = {towards(3, 10), towards(20, 200), towards(45, 100), towards(60, 330), towards(80, 45)};

TEST(Ggx, DistributionAndMasking)
{
    for (double alpha : {0.05, 0.3, 1.0}) {
        const Ggx ggx{Float(float(alpha))};
        // Facets cover the surface: the projected area of all is 1.
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

/// The tables of what facets give back in one bounce, by integration.
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
            EXPECT_NEAR(first(ggx_lookup(ggx_schlick_table, Float(float(wo.z)), Float(float(roughness)))), weighted, 3e-3);
        }
}

/// How much light facets with Schlick's reflectance make up for: Turquin 2019, equation 16.
double made_up(double color, double albedo)
{
    return 1 + color * (1 - albedo) / albedo;
}

TEST(Metal, IsTheFormula)
{
    for (float roughness : {0.25f, 0.6f, 1.0f})
        for (const Direction& wo : some_directions)
            for (const Direction& wi : some_directions) {
                MaterialPoint m = material(0, roughness);
                m.base_color.c[0] = Float(0.9f), m.base_color.c[1] = Float(0.5f), m.base_color.c[2] = Float(0.1f);
                const BsdfEval e = MetalBsdf(m).eval(lane_direction(wo), lane_direction(wi));
                const double alpha = double(roughness) * double(roughness);
                const double albedo = first(ggx_albedo(Float(float(wo.z)), Float(roughness)));
                const double colors[] = {0.9, 0.5, 0.1};
                for (int c = 0; c < 3; ++c) {
                    const double expected = schlick(colors[c], dot3(wo, half_way(wo, wi))) *
                                            made_up(colors[c], albedo) * ggx_f_cos(wo, wi, alpha);
                    EXPECT_NEAR(first(e.f_cos.c[c]) / expected, 1, 1e-4);
                }
            }
}

/// glTF 2.0, appendix B, with a base that gets what the layer leaves.
TEST(Principled, IsTheFormula)
{
    const double color = 0.6, roughness = 0.5;
    for (float metallic : {0.0f, 0.3f, 1.0f})
        for (float ior : {1.3f, 1.5f, 2.0f})
            for (const Direction& wo : some_directions)
                for (const Direction& wi : some_directions) {
                    const BsdfEval e = PrincipledBsdf(material(float(color), float(roughness), metallic, ior))
                                           .eval(lane_direction(wo), lane_direction(wi));
                    const double dielectric = std::pow((double(ior) - 1) / (double(ior) + 1), 2);
                    const double f0 = dielectric + (color - dielectric) * double(metallic);
                    const Float z(float(wo.z)), r{float(roughness)};
                    const double albedo = first(ggx_albedo(z, r)), weighted = first(ggx_lookup(ggx_schlick_table, z, r));
                    const double layer =
                        (dielectric * albedo + (1 - dielectric) * weighted) * made_up(dielectric, albedo);
                    const double specular = schlick(f0, dot3(wo, half_way(wo, wi))) * made_up(f0, albedo) *
                                            ggx_f_cos(wo, wi, roughness * roughness);
                    const double base =
                        color * (1 - double(metallic)) * (1 - std::min(1.0, layer)) * wi.z / std::numbers::pi;
                    EXPECT_NEAR(first(e.f_cos.c[0]) / (specular + base), 1, 2e-4) << metallic << " " << ior;
                }
}

/// Portsmouth, Kutz, Hill 2024, "EON: A practical energy-preserving rough diffuse BRDF", with the fit for the albedo.
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
                    const double g = 0.0571085289 * m + 0.491881867 * m * m - 0.332181442 * m * m * m +
                                     0.0714429953 * m * m * m * m;
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

/// By angles: Fresnel's laws with sines and tangents, and Snell's for the direction.
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
            // In the plane of incidence, on the other side of the normal.
            const Vec3 wi = refract(outgoing(degrees), lane_direction({0, 0, 1}), Float(float(std::cos(i))), cos_t,
                                    Float(float(eta)));
            EXPECT_NEAR(first(wi.x), -std::sin(t), 2e-5);
            EXPECT_NEAR(first(wi.y), 0, 1e-6);
            EXPECT_NEAR(first(wi.z), -std::cos(t), 2e-5);
        }
}

/// Smooth: reflected by Fresnel's share, mirrored; else refracted, with radiance scaled by the square of the indices'
/// ratio.
TEST(Glass, SmoothSplitsByFresnel)
{
    for (const bool entering : {true, false})
        for (double degrees : {0.0, 30.0, 60.0}) {
            MaterialPoint m = material(1, 0, 0, 1.5f);
            m.entering = Mask(entering);
            const double eta = entering ? 1.5 : 1 / 1.5, i = degrees * std::numbers::pi / 180;
            Float cos_t;
            const double r = first(fresnel_dielectric(Float(float(std::cos(i))), Float(float(eta)), cos_t));
            int reflected = 0;
            constexpr int n = 1000;
            for (int k = 0; k < n; ++k) {
                const BsdfSample s = GlassBsdf(m).sample(outgoing(degrees), {Float(0.3f), Float(0.7f)},
                                                         Float((float(k) + 0.5f) / n));
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

/// Light that goes the other way: as much, but for the square of the indices' ratio (Veach 1997, 5.2).
TEST(Glass, IsReciprocal)
{
    for (float roughness : {0.4f, 0.8f})
        for (double a : {10.0, 50.0})
            for (double b : {100.0, 130.0, 165.0, 20.0, 70.0}) {
                const Direction wo = towards(a, 0), wi = towards(b, 160);
                MaterialPoint m = material(1, roughness);
                const double there = first(GlassBsdf(m).eval(lane_direction(wo), lane_direction(wi)).f_cos.c[0]);
                const bool through = wi.z < 0;
                // Frames are turned to the side that the path is on.
                const double side = through ? -1 : 1;
                m.entering = Mask(!through);
                const double back = first(GlassBsdf(m)
                                              .eval(lane_direction({wi.x, wi.y, side * wi.z}),
                                                    lane_direction({wo.x, wo.y, side * wo.z}))
                                              .f_cos.c[0]);
                const double scale = through ? 1.5 * 1.5 : 1;
                if (there == 0) continue;
                EXPECT_NEAR(there * scale / std::abs(wi.z) / (back / wo.z), 1, 1e-3) << roughness << " " << a << " " << b;
            }
}

/// Facets of little roughness lose next to nothing: reflected and refracted light together are all.
TEST(Glass, RoughKeepsNearlyAllEnergy)
{
    for (const bool entering : {true, false})
        for (double degrees : {0.0, 30.0}) {
            MaterialPoint m = material(1, 0.25f);
            m.entering = Mask(entering);
            const GlassBsdf bsdf(m);
            test::Random random;
            double sum = 0;
            int n = 0;
            for (; n < 20000; n += lanes) {
                const BsdfSample s = bsdf.sample(outgoing(degrees), random.next2(), random.next());
                float w[lanes];
                store(w, s.weight.c[0] * s.eta * s.eta);
                for (float x : w) sum += x;
            }
            EXPECT_NEAR(sum / n, 1, 0.01) << entering << " " << degrees;
        }
}

}  // namespace
}  // namespace fathom
