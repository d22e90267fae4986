// SPDX-License-Identifier: Apache-2.0
#include "difference/student_t.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace fathom {
namespace {

TEST(StudentT, IsCauchysDistributionForOneDegreeOfFreedom)
{
    for (const double t : {0.0, 0.1, 1.0, 12.7, 1e4})
        EXPECT_NEAR(student_t_two_sided(t, 1), 1 - 2 / std::numbers::pi * std::atan(t), 1e-12) << t;
}

TEST(StudentT, HasAClosedFormForTwoDegreesOfFreedom)
{
    for (const double t : {0.01, 0.5, 3.0, 50.0})
        EXPECT_NEAR(student_t_two_sided(t, 2), 1 - t / std::sqrt(2 + t * t), 1e-12) << t;
}

TEST(StudentT, ApproachesTheNormalDistribution)
{
    for (const double t : {0.5, 2.0, 5.0}) {
        const double normal = std::erfc(t / std::numbers::sqrt2);
        EXPECT_NEAR(student_t_two_sided(t, 1e9) / normal, 1, 1e-6) << t;
    }
}

TEST(StudentT, KeepsSmallProbabilities)
{
    // The tail for three degrees of freedom is 4 sqrt(3) / (pi t^3) (1 + O(t^-2)).
    EXPECT_NEAR(student_t_two_sided(1e4, 3) / (4 * std::sqrt(3.0) / std::numbers::pi * 1e-12), 1, 1e-6);
    EXPECT_EQ(student_t_two_sided(std::numeric_limits<double>::infinity(), 3), 0);
}

}  // namespace
}  // namespace fathom
