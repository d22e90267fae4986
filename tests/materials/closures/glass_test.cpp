// SPDX-License-Identifier: Apache-2.0
#include "materials/closures/glass.h"

#include "materials/closure_checks.h"

namespace fathom::test {
namespace {

TEST(Glass, SamplingAgreesWithItsDensity)
{
    for (double degrees : {0.0, 45.0, 75.0})
        for (float roughness : {0.4f, 0.8f}) {
            GlassPoint m = material(1, roughness);
            check_sampling(GlassBsdf(m), degrees, "glass from outside");
            m.entering = Mask(false);
            check_sampling(GlassBsdf(m), degrees, "glass from inside");
        }
}

TEST(Glass, SmoothKeepsAllEnergy)
{
    // Radiance scales by 1 / eta^2 on refraction; with that undone every sample has weight 1.
    for (bool entering : {true, false})
        for (double degrees : {0.0, 30.0, 60.0, 85.0}) {
            GlassPoint m = material(1, 0);
            m.entering = Mask(entering);
            const GlassBsdf bsdf(m);
            Random random;
            for (int i = 0; i < 100; ++i) {
                const BsdfSample s = bsdf.sample(outgoing(degrees), random.next2(), random.next());
                EXPECT_NEAR(first(s.weight.c[0] * s.eta * s.eta), 1, 1e-5);
                EXPECT_NEAR(first(dot(s.wi, s.wi)), 1, 1e-5);
            }
        }
}

TEST(Glass, ColorIsTransmittanceOfEnteringAndLeaving)
{
    GlassPoint m = material(0.25f, 0);
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

/// A tint scales reflection but not transmission.
TEST(Glass, TintOfReflections)
{
    for (const float roughness : {0.f, 0.5f}) {
        GlassPoint white = material(1, roughness), tinted = white;
        tinted.reflection_color = Spectrum(Float(0.25f));
        for (const float u1 : {0.001f, 0.999f}) {
            const Sample2 u{Float(0.3f), Float(0.6f)};
            const BsdfSample a = GlassBsdf(white).sample(outgoing(40), u, Float(u1)),
                             b = GlassBsdf(tinted).sample(outgoing(40), u, Float(u1));
            const double factor = first(a.wi.z) > 0 ? 0.25 : 1;
            EXPECT_EQ(first(a.wi.z) > 0, u1 < 0.5f);
            EXPECT_NEAR(first(b.weight.c[0]), factor * first(a.weight.c[0]), 1e-6) << roughness << ' ' << u1;
        }
    }
}

GlassPoint sheet(float color, float roughness)
{
    GlassPoint m = material(color, roughness);
    m.thin = m.sheet = Mask(true);
    return m;
}

TEST(ThinGlass, SamplingAgreesWithItsDensity)
{
    for (double degrees : {0.0, 45.0, 75.0})
        for (float roughness : {0.4f, 0.8f}) check_sampling(GlassBsdf(sheet(0.7f, roughness)), degrees, "thin glass");
}

TEST(ThinGlass, LetsLightStraightOnFromBothSides)
{
    GlassPoint m = sheet(0.5f, 0);
    for (const bool entering : {true, false}) {
        m.entering = Mask(entering);
        const GlassBsdf bsdf(m);
        // A boundary reflects 4 %, so the sheet reflects 2 * 0.04 / 1.04 = 1 / 13.
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
    // White glass loses nothing, including multiple scattering between microfacets.
    for (double degrees : {0.0, 30.0, 60.0, 85.0})
        for (float roughness : {0.1f, 0.5f, 0.8f, 1.0f})
            EXPECT_NEAR(albedo_of(GlassBsdf(sheet(1, roughness)), outgoing(degrees)), 1, 0.012)
                << degrees << " " << roughness;
}

/// Thin glass as in glTF has one boundary with one reflection and loses what its microfacets lose.
TEST(ThinGlass, OfOneBoundary)
{
    GlassPoint m = sheet(0.5f, 0);
    m.sheet = m.compensated = Mask(false);
    for (const auto& [choice, reflects] : {std::pair{0.04 - 1e-4, true}, {0.04 + 1e-4, false}})
        EXPECT_EQ(first(GlassBsdf(m).sample(outgoing(0), {Float(0.5f), Float(0.5f)}, Float(float(choice))).wi.z) > 0,
                  reflects);
    m.roughness = Float(0.8f);
    const double scaled = albedo_of(GlassBsdf(sheet(1, 0.8f)), outgoing(60));
    m.base_color = Spectrum(Float(1));
    EXPECT_NEAR(albedo_of(GlassBsdf(m), outgoing(60)) / scaled, first(ggx_albedo(outgoing(60).z, Float(0.8f))), 0.01);
}

TEST(Glass, FresnelAtNormalIncidenceAndBeyondTheCriticalAngle)
{
    Float cos_t;
    EXPECT_NEAR(first(fresnel_dielectric(Float(1), Float(1.5f), cos_t)), 0.04, 1e-6);
    EXPECT_EQ(first(fresnel_dielectric(Float(0.5f), Float(1 / 1.5f), cos_t)), 1);
    // At Brewster's angle only perpendicular polarization is reflected, so the mean is half of it.
    const double brewster = std::atan(1.5), ct = std::cos(std::asin(std::sin(brewster) / 1.5));
    const double perpendicular = (std::cos(brewster) - 1.5 * ct) / (std::cos(brewster) + 1.5 * ct);
    EXPECT_NEAR(first(fresnel_dielectric(Float(float(std::cos(brewster))), Float(1.5f), cos_t)),
                perpendicular * perpendicular / 2, 1e-6);
}

}  // namespace
}  // namespace fathom::test
