// SPDX-License-Identifier: Apache-2.0
#include "materials/closures/fuzz_metal.h"

#include "materials/closure_checks.h"

namespace fathom::test {
namespace {

TEST(FuzzMetal, HasTheDensityOfItsRecipe)
{
    for (double degrees : {0.0, 40.0, 75.0})
        for (float fuzz : {0.1f, 0.5f, 1.0f})
            check_sampling(FuzzMetalBsdf(material(0.9f, 0, 0, 1.5f, fuzz)), degrees, "fuzz");
    // At normal incidence, fuzz below 1 scatters nothing below the surface.
    EXPECT_NEAR(draw(FuzzMetalBsdf(material(1, 0, 0, 1.5f, 0.9f)), outgoing(0), 100000).albedo, 1, 1e-6);
}

}  // namespace
}  // namespace fathom::test
