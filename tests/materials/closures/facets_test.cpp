// SPDX-License-Identifier: Apache-2.0
#include "materials/closures/layered.h"
#include "materials/facet_checks.h"
#include "materials/facet_reference.h"

// Tests of microfacets with separable shadowing-masking, and of those treated as mirrors, in every closure.
namespace fathom::test {
namespace {

CommonPoint separable(float color, float roughness, float metallic = 0)
{
    return with_facets(&FacetsPoint::separable, color, roughness, metallic);
}

LayeredMaterialPoint layered(float roughness, float coat_roughness)
{
    LayeredMaterialPoint m = material(0.5f, roughness);
    LayersPoint& l = m.layers;
    l.features = LayersRecord::with_coat | LayersRecord::with_transmission;
    l.transmission_color = l.diffuse_transmission_color = l.coat_color = Spectrum(Float(1));
    l.tangent = Vec3(Float(1), Float(0), Float(0));
    l.coat_normal = Vec3(Float(0), Float(0), Float(1));
    l.coat = Float(1), l.coat_roughness = Float(coat_roughness), l.coat_f0 = Float(0.04f);
    l.coat_inner = Float(0.6f), l.coat_darkening = Float(0);
    return m;
}

double fresnel(double cosine, double ior, double& beyond)
{
    beyond = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
    const double p = (ior * cosine - beyond) / (ior * cosine + beyond),
                 s = (cosine - ior * beyond) / (cosine + ior * beyond);
    return (p * p + s * s) / 2;
}

/// Transmittance of a microfacet boundary for a direction, integrated over the distribution of normals.
double transmittance(double z, double alpha, bool is_beckmann, double ior)
{
    constexpr int slopes = 400, turns = 200;
    const double sine = std::sqrt(1 - z * z);
    double sum = 0;
    for (int i = 0; i < slopes; ++i) {
        // Slopes are stratified by projected area, with finer strata for steep slopes.
        const double w = (i + 0.5) / slopes, area = 2 * w / slopes;
        const double slope = alpha * std::sqrt(is_beckmann ? -2 * std::log(w) : 1 / (w * w) - 1);
        const double nz = 1 / std::sqrt(1 + slope * slope);
        for (int k = 0; k < turns; ++k) {
            const double nx = slope * nz * std::cos(std::numbers::pi * (k + 0.5) / turns), c = sine * nx + z * nz;
            if (c <= 0) continue;
            double t;
            const double f = fresnel(c, ior, t), down = z / ior - (c / ior - t) * nz;
            if (down > 0) sum += (1 - f) * smith_g1(std::min(1.0, down), alpha, is_beckmann) * c / nz * area / turns;
        }
    }
    return smith_g1(z, alpha, is_beckmann) / z * sum;
}

TEST(SeparableShadowing, Sampling)
{
    for (double degrees : {0.0, 45.0, 75.0}) check_facet_sampling(separable(0.6f, 0.7f, 0.5f), degrees);
}

/// A plastic with a black base and a white metal of layers reduce to F D G / 4, in double precision.
TEST(SeparableShadowing, IsTheFormula)
{
    RandomDirections direction;
    for (int k = 0; k < 1000; ++k) {
        const UnitVector o = direction(), i = direction(), h = half_vector(o, i);
        const float roughness = float(direction.number(0.3, 0.9));
        const double alpha = double(roughness) * double(roughness);
        double t;
        const double f = fresnel(o.x * h.x + o.y * h.y + o.z * h.z, 1.5, t);
        const double e = 1 + h.z * h.z * (alpha * alpha - 1), d = alpha * alpha / (std::numbers::pi * e * e);
        const double facets = d * smith_g1(o.z, alpha, false) * smith_g1(i.z, alpha, false) / (4 * o.z);
        const Vec3 wo = lane_direction({o.x, o.y, o.z}), wi = lane_direction({i.x, i.y, i.z});
        EXPECT_NEAR(first(PlasticBsdf(separable(0, roughness)).eval(wo, wi).f_cos.c[0]), f * facets,
                    3e-4 * f * facets + 1e-6);
        LayeredMaterialPoint metal = layered(roughness, 0.5f);
        static_cast<PrincipledPoint&>(metal) = separable(1, roughness, 1);
        metal.layers.features = 0, metal.layers.compensation = Float(0);
        EXPECT_NEAR(first(LayeredBsdf<false>(metal).eval(wo, wi).f_cos.c[0]), facets, 3e-4 * facets + 1e-6);
    }
}

/// A diffuse base below microfacets has the BRDF color / pi / (1 - color inner) / ior^2 times the transmittances of
/// both directions.
TEST(SeparableShadowing, OfWhatPassesABoundary)
{
    constexpr double inner = 0.4;
    for (const bool is_beckmann : {false, true})
        for (const double alpha : {0.1, 0.36, 0.8})
            for (const double degrees : {5.0, 50.0, 75.0}) {
                PlasticPoint body = separable(0.5f, float(std::sqrt(alpha)));
                body.internal_absorption = Float(float(-inner));
                body.beckmann = Mask(is_beckmann);
                PlasticPoint none = body;
                none.base_color = Spectrum(Float(0));
                const Vec3 wo = outgoing(degrees), wi = outgoing(-20);
                const double found =
                    first(PlasticBsdf(body).eval(wo, wi).f_cos.c[0]) - first(PlasticBsdf(none).eval(wo, wi).f_cos.c[0]);
                const auto passes = [&](double angle) {
                    return transmittance(std::cos(angle * std::numbers::pi / 180), alpha, is_beckmann, 1.5);
                };
                const double expected =
                    0.5 / std::numbers::pi / 2.25 / (1 - 0.5 * inner) * passes(degrees) * passes(20) * first(wi.z);
                EXPECT_NEAR(found, expected, 0.004 * expected) << is_beckmann << ' ' << alpha << ' ' << degrees;
            }
}

/// Separable shadowing never creates energy: a white base below smooth microfacets loses nothing, and rougher ones lose
/// more.
TEST(SeparableShadowing, LosesAndNeverGains)
{
    for (const bool is_beckmann : {false, true})
        for (const double degrees : {5.0, 60.0}) {
            double before = 1.005;
            for (const float roughness : {0.05f, 0.45f, 0.7f, 0.95f}) {
                CommonPoint m = separable(1, roughness);
                m.beckmann = Mask(is_beckmann);
                const double albedo = albedo_of(PlasticBsdf(m), outgoing(degrees));
                EXPECT_LT(albedo, before) << roughness;
                if (roughness < 0.1f) EXPECT_GT(albedo, 0.99);
                before = albedo - 0.02;
            }
        }
}

/// Microfacets treated as mirrors show no specular reflection of lights without extent.
TEST(Mirrors, ShowNoLightsWithoutExtent)
{
    const Vec3 wo = outgoing(40), mirrored = outgoing(-40);
    const auto check = [&](const auto& smooth, const auto& black, const char* what) {
        const double all = first(smooth.eval(wo, mirrored).f_cos.c[0]),
                     body = first(smooth.eval(wo, mirrored, Mask(true)).f_cos.c[0]);
        EXPECT_GT(all, 100) << what;
        EXPECT_LT(body, 0.5 / std::numbers::pi) << what;
        EXPECT_GT(body, 0.05) << what;
        EXPECT_EQ(first(black.eval(wo, mirrored, Mask(true)).f_cos.c[0]), 0) << what;
        EXPECT_GT(first(black.eval(wo, mirrored).f_cos.c[0]), 100) << what;
    };
    check(PlasticBsdf(material(0.5f, 0)), PlasticBsdf(material(0, 0)), "plastic");
    check(PrincipledBsdf(material(0.5f, 0)), PrincipledBsdf(material(0.5f, 0, 1)), "principled");
    LayeredMaterialPoint black = layered(0, 0);
    black.metallic = Float(1);
    check(LayeredBsdf<false>(layered(0, 0)), LayeredBsdf<false>(black), "layered");
    // Rough microfacets do show them, in each closure.
    const auto shown = [&](const auto& bsdf) { return first(bsdf.eval(wo, mirrored, Mask(true)).f_cos.c[0]); };
    EXPECT_GT(shown(PlasticBsdf(material(0, 0.1f))), 1);
    EXPECT_GT(shown(PrincipledBsdf(material(0, 0.1f))), 1);
    EXPECT_GT(shown(LayeredBsdf<false>(layered(0.1f, 0))), 1);
    EXPECT_GT(shown(LayeredBsdf<false>(layered(0, 0.1f))), 1);
}

/// Microfacets treated as mirrors transmit no lights without extent.
TEST(Mirrors, LetNoLightsWithoutExtentThrough)
{
    LayeredMaterialPoint m = layered(0, 0.3f);
    m.thin = Mask(true);
    m.layers.transmission = Float(1);
    const LayeredBsdf<true> pane(m);
    const Vec3 wo = outgoing(40), beyond{-wo.x, -wo.y, -wo.z};
    EXPECT_GT(first(pane.eval(wo, beyond).f_cos.c[0]), 100);
    EXPECT_EQ(first(pane.eval(wo, beyond, Mask(true)).f_cos.c[0]), 0);
}

/// Separate roughness along and across the tangent; either may be the smaller one.
TEST(TwoRoughnesses, AreThatAlongTheTangentAndThatAcross)
{
    for (const auto& [along, across] : {std::pair(0.3f, 0.6f), std::pair(0.7f, 0.4f)}) {
        LayeredMaterialPoint m = layered(across, 0.5f);
        m.metallic = Float(1), m.base_color = Spectrum(Float(1));
        m.layers.features = LayersRecord::anisotropic;
        m.layers.compensation = Float(0);
        m.layers.anisotropy = Float(along), m.layers.two_roughnesses = Mask(true);
        const LayeredBsdf<false> bsdf(m);
        const Vec3 up = lane_direction({0, 0, 1});
        const double alpha_x = double(along) * double(along), alpha_y = double(across) * double(across);
        const double d = 1 / (std::numbers::pi * alpha_x * alpha_y);
        EXPECT_NEAR(first(bsdf.eval(up, up).f_cos.c[0]), d / 4, 1e-3 * d);
        // D at a normal with slope s along x equals D of the isotropic case divided by (1 + (s / alpha)^2)^2.
        const double slope = 0.3, z = 1 / std::sqrt(1 + slope * slope);
        const auto normals = [&](double x, double y) {
            const Vec3 w = lane_direction({2 * z * z * x, 2 * z * z * y, 2 * z * z - 1});
            return first(bsdf.eval(up, w).f_cos.c[0]);
        };
        const auto expected = [&](double alpha) {
            const double e = 1 + slope * slope / (alpha * alpha), tangent = 2 * z * z * slope / (2 * z * z - 1);
            const double lambda = (std::sqrt(1 + alpha * alpha * tangent * tangent) - 1) / 2;
            return d / (e * e * z * z * z * z) / (1 + lambda) / 4;
        };
        EXPECT_NEAR(normals(slope, 0), expected(alpha_x), 2e-3 * expected(alpha_x));
        EXPECT_NEAR(normals(0, slope), expected(alpha_y), 2e-3 * expected(alpha_y));
    }
}

}  // namespace
}  // namespace fathom::test
