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

}  // namespace
}  // namespace fathom
