// SPDX-License-Identifier: Apache-2.0
#include "integrate/stages/light_tracing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/lane_helpers.h"

namespace fathom {
namespace {

using test::first;

TEST(LightTracingWeights, AddUpToOne)
{
    for (const float connection : {1e-3f, 1.f, 300.f})
        for (const float emission : {1e-4f, 2.f, 1e3f})
            for (const float ratio : {0.f, 0.5f, 20.f})
                for (const bool unhittable : {false, true}) {
                    const Float v = path_variants(Float(ratio), Float(1), Mask(false), Mask(unhittable));
                    if (!(first(v) > 0)) continue;
                    const Float by_path = path_tracing_weight(Float(connection), Float(emission), v);
                    const Float by_light = light_tracing_weight(Float(connection), light_end(Float(emission), v));
                    EXPECT_NEAR(first(by_path) + first(by_light), 1, 1e-5);
                }
}

/// The densities of such a path, such as after scattering by a medium, are not known.
TEST(LightTracingWeights, OfPathsThatLightTracingCannotFind)
{
    for (const float variants : {0.f, 1.f, std::numeric_limits<float>::infinity(), std::nanf("")})
        EXPECT_EQ(first(path_tracing_weight(Float(infinity), Float(3), Float(variants))), 1);
}

TEST(LightTracingWeights, AreFiniteForAllDensities)
{
    for (const float scatter : {0.f, 1e-35f, 1e-12f})
        for (const float nee : {1e-10f, 1.f, 1e20f}) {
            const Float v = path_variants(Float(nee), Float(scatter), Mask(true), Mask(false));
            for (const float connection : {0.f, 1e-20f, 1.f, 1e30f}) {
                const float weight = first(path_tracing_weight(Float(connection), Float(1e10f), v));
                EXPECT_TRUE(weight >= 0 && weight <= 1) << weight;
            }
        }
}

}  // namespace
}  // namespace fathom
