// SPDX-License-Identifier: Apache-2.0
#include "materials/closures/fuzz_metal.h"

#include "materials/closure_checks.h"

namespace fathom::test {
namespace {

FuzzMetalPoint fuzzy(float color, float fuzz)
{
    FuzzMetalPoint m = material(color, 0);
    m.fuzz = Float(fuzz);
    return m;
}

TEST(FuzzMetal, HasTheDensityOfItsRecipe)
{
    for (double degrees : {0.0, 40.0, 75.0})
        for (float fuzz : {0.1f, 0.5f, 1.0f}) check_sampling(FuzzMetalBsdf(fuzzy(0.9f, fuzz)), degrees, "fuzz");
    // At normal incidence, fuzz below 1 scatters nothing below the surface.
    EXPECT_NEAR(albedo_of(FuzzMetalBsdf(fuzzy(1, 0.9f)), outgoing(0)), 1, 1e-6);
}

}  // namespace
}  // namespace fathom::test
