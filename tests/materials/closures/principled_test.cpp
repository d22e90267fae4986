// SPDX-License-Identifier: Apache-2.0
#include "materials/closures/principled.h"

#include "materials/closure_checks.h"

namespace fathom::test {
namespace {

TEST(Principled, SamplingAndEnergy)
{
    for (double degrees : {0.0, 45.0, 80.0})
        for (float metallic : {0.0f, 0.5f, 1.0f}) {
            check_sampling(PrincipledBsdf(material(0.6f, 0.5f, metallic)), degrees, "principled");
            for (float roughness : {0.1f, 0.5f, 1.0f}) {
                const double albedo = albedo_of(PrincipledBsdf(material(1, roughness, metallic)), outgoing(degrees));
                EXPECT_LT(albedo, 1.02) << degrees << " " << metallic << " " << roughness;
                EXPECT_GT(albedo, metallic == 1 ? 0.98 : 0.7) << degrees << " " << metallic << " " << roughness;
            }
        }
}

/// Albedo from samples, and its standard error.
template <class Bsdf>
std::pair<double, double> mean_weight(const Bsdf& bsdf, Vec3 wo, int n)
{
    Random random;
    double sum = 0, squares = 0;
    int count = 0;
    for (; count < n; count += lanes) {
        float weight[lanes];
        store(weight, bsdf.sample(wo, random.next2(), random.next()).weight.c[0]);
        for (float w : weight) sum += w, squares += double(w) * w;
    }
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / count)};
}

/// White mixtures of any weights are lossless.
TEST(Principled, WhiteFurnaceOfEveryMixture)
{
    for (double degrees : {0.0, 30.0, 60.0, 80.0})
        for (float metallic : {0.0f, 0.25f, 0.5f, 0.75f, 1.0f})
            for (float roughness : {0.0f, 0.05f, 0.12f, 0.25f, 0.4f, 0.6f, 0.85f, 1.0f})
                for (float ior : {1.0f, 1.3f, 1.5f, 2.0f, 3.0f}) {
                    const PrincipledBsdf bsdf(material(1, roughness, metallic, ior));
                    const auto [albedo, error] = mean_weight(bsdf, outgoing(degrees), 20000);
                    EXPECT_NEAR(albedo, 1, 0.005 + 4 * error) << degrees << " degrees, metallic " << metallic
                                                              << ", roughness " << roughness << ", ior " << ior;
                }
}

}  // namespace
}  // namespace fathom::test
