// SPDX-License-Identifier: Apache-2.0
#include "materials/closures/diffuse.h"

#include "materials/closure_checks.h"

namespace fathom::test {
namespace {

TEST(Diffuse, SamplingAndFurnace)
{
    for (double degrees : {0.0, 45.0, 85.0}) {
        check_sampling(DiffuseBsdf(material(0.7f, 0)), degrees, "Lambert");
        check_sampling(DiffuseBsdf(material(0.7f, 0.8f)), degrees, "rough");
        // Energy conservation: albedo 1 reflects everything.
        for (float roughness : {0.0f, 0.5f, 1.0f})
            EXPECT_NEAR(albedo_of(DiffuseBsdf(material(1, roughness)), outgoing(degrees)), 1, 0.01);
    }
}

TEST(Diffuse, IsReciprocal)
{
    const DiffuseBsdf bsdf(material(0.7f, 0.9f));
    const Vec3 a = outgoing(20), b = lane_direction({0.3, 0.8, std::sqrt(1 - 0.09 - 0.64)});
    EXPECT_NEAR(first(bsdf.eval(a, b).f_cos.c[0] / b.z), first(bsdf.eval(b, a).f_cos.c[0] / a.z), 1e-5);
}

}  // namespace
}  // namespace fathom::test
