// SPDX-License-Identifier: Apache-2.0
#include "materials/closures/metal.h"

#include "materials/closure_checks.h"

namespace fathom::test {
namespace {

TEST(Metal, SamplingAndFurnace)
{
    for (double degrees : {0.0, 45.0, 80.0})
        for (float roughness : {0.3f, 0.6f, 1.0f})
            check_sampling(MetalBsdf(material(0.9f, roughness)), degrees, "metal");
    // A white metal is lossless, including multiple scattering between microfacets.
    for (double degrees : {0.0, 30.0, 60.0, 85.0})
        for (float roughness : {0.0f, 0.1f, 0.3f, 0.5f, 0.8f, 1.0f})
            EXPECT_NEAR(albedo_of(MetalBsdf(material(1, roughness)), outgoing(degrees)), 1, 0.012)
                << degrees << " " << roughness;
}

TEST(Metal, SmoothIsAMirror)
{
    const MetalBsdf bsdf(material(0.8f, 0));
    const BsdfSample s = bsdf.sample(outgoing(30), {Float(0.3f), Float(0.7f)}, Float(0.5f));
    EXPECT_TRUE(first(s.is_delta));
    EXPECT_NEAR(first(s.wi.x), -0.5, 1e-6);
    EXPECT_NEAR(first(s.wi.z), std::sqrt(0.75), 1e-6);
    EXPECT_FALSE(first(bsdf.has_non_delta()));
    EXPECT_EQ(first(bsdf.eval(outgoing(30), s.wi).f_cos.c[0]), 0);
}

}  // namespace
}  // namespace fathom::test
