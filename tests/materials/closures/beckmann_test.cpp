// SPDX-License-Identifier: Apache-2.0
#include "materials/closures/layered.h"
#include "materials/facet_checks.h"
#include "materials/facet_reference.h"

// Tests of Beckmann microfacets in every closure with microfacets.
namespace fathom::test {
namespace {

CommonPoint beckmann(float color, float roughness, float metallic = 0)
{
    return with_facets(&FacetsPoint::beckmann, color, roughness, metallic);
}

TEST(Beckmann, Sampling)
{
    for (double degrees : {0.0, 45.0, 75.0})
        for (float roughness : {0.6f, 0.85f}) check_facet_sampling(beckmann(0.6f, roughness, 0.5f), degrees);
}

/// The projected area of all microfacets is 1.
TEST(Beckmann, NormalsCoverTheSurface)
{
    for (const auto& [alpha_x, alpha_y] : {std::pair(0.2, 0.2), std::pair(0.5, 0.5), std::pair(0.6, 0.25)}) {
        const Facets<AnisotropicGgx> facets(
            {Float(float(alpha_x * ggx_of_beckmann)), Float(float(alpha_y * ggx_of_beckmann))}, Mask(true));
        double sum = 0;
        constexpr int rows = 600, columns = 120;
        for (int i = 0; i < rows; ++i)
            for (int j = 0; j < columns; ++j) {
                const double z = (i + 0.5) / rows, phi = 2 * std::numbers::pi * (j + 0.5) / columns,
                             s = std::sqrt(1 - z * z);
                const Vec3 h = lane_direction({s * std::cos(phi), s * std::sin(phi), z});
                sum += first(facets.value(h, facets.d(h))) * z * 2 * std::numbers::pi / (rows * columns);
            }
        EXPECT_NEAR(sum, 1, 2e-3) << alpha_x << ' ' << alpha_y;
    }
}

/// A plastic with a black base reduces to its boundary, F D G / 4, in double precision.
TEST(Beckmann, IsTheFormula)
{
    RandomDirections direction;
    for (int k = 0; k < 2000; ++k) {
        const UnitVector o = direction(), i = direction(), h = half_vector(o, i);
        const float roughness = float(direction.number(0.3, 0.9));
        const double alpha = double(roughness) * double(roughness);
        const double c = o.x * h.x + o.y * h.y + o.z * h.z, t = std::sqrt(1 - (1 - c * c) / 2.25),
                     p = (1.5 * c - t) / (1.5 * c + t), s = (c - 1.5 * t) / (c + 1.5 * t);
        const double expected = (p * p + s * s) / 2 * beckmann_d(h, alpha, alpha) * smith_g1(o.z, alpha, true) *
                                smith_g1(i.z, alpha, true) / (4 * o.z);
        const double found = first(PlasticBsdf(beckmann(0, roughness))
                                       .eval(lane_direction({o.x, o.y, o.z}), lane_direction({i.x, i.y, i.z}))
                                       .f_cos.c[0]);
        EXPECT_NEAR(found, expected, 2e-4 * expected + 1e-6) << roughness;
    }
}

/// Layered materials support anisotropic Beckmann microfacets.
TEST(Beckmann, OfLayers)
{
    const auto layered = [](float metallic) {
        LayeredMaterialPoint m = beckmann(0.8f, 0.5f, metallic);
        m.layers.features = LayersRecord::anisotropic;
        m.layers.anisotropy = Float(0.5f);
        m.layers.tangent = Vec3{Float(1), Float(0), Float(0)};
        m.layers.compensation = Float(0);
        m.layers.coat_normal = Vec3{Float(0), Float(0), Float(1)};
        return LayeredBsdf<false>(m);
    };
    // A pure metal underflows to 0 where microfacets are rarest, and such samples would count as absorbed.
    for (double degrees : {0.0, 50.0}) check_sampling(layered(0.5f), degrees, "layered");
    // At normal incidence and exitance the value is D / 4 times the reflectance.
    const double alpha = 0.25, alpha_x = alpha + (1 - alpha) * 0.25;
    const Vec3 up = lane_direction({0, 0, 1});
    EXPECT_NEAR(first(layered(1).eval(up, up).f_cos.c[0]), 0.8 * beckmann_d({0, 0, 1}, alpha_x, alpha) / 4, 1e-3);
}

}  // namespace
}  // namespace fathom::test
