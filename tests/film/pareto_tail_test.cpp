// SPDX-License-Identifier: Apache-2.0
#include "film/pareto_tail.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fathom {
namespace {

/// Evenly spaced quantiles of a generalized Pareto distribution.
std::vector<float> quantiles(double shape, int count)
{
    std::vector<float> numbers;
    for (int i = 0; i < count; ++i) numbers.push_back(float((std::pow(1 - (i + 0.5) / count, -shape) - 1) / shape));
    return numbers;
}

/// The fit finds the shape of the distribution, up to the pull of its prior towards 0.5.
TEST(ParetoTail, FindsTheShape)
{
    for (const double shape : {0.1, 0.3, 0.5, 0.8, 1.2, 2.0})
        EXPECT_NEAR(pareto_tail_shape(quantiles(shape, 20000)), shape, 0.03 + 0.05 * shape) << shape;
}

TEST(ParetoTail, DoesNotDependOnScaleOrOrder)
{
    std::vector<float> numbers = quantiles(0.8, 5000);
    const double shape = pareto_tail_shape(numbers);
    std::vector<float> other(numbers.rbegin(), numbers.rend());
    for (float& number : other) number *= 1024;
    EXPECT_NEAR(pareto_tail_shape(other), shape, 1e-6);
}

/// A tail that ends is lighter than any with a positive shape.
TEST(ParetoTail, IsLightForUniformNumbers)
{
    std::vector<float> numbers;
    for (int i = 0; i < 10000; ++i) numbers.push_back(float(i));
    EXPECT_LT(pareto_tail_shape(numbers), 0);
}

/// Only the largest numbers count, three times the root of their number: 4,788 small ones say nothing about the tail.
TEST(ParetoTail, IsThatOfTheLargestNumbers)
{
    std::vector<float> numbers;
    for (int i = 0; i < 4788; ++i) numbers.push_back(float(i) / 4788);
    for (const float number : quantiles(0.8, 212)) numbers.push_back(1 + 0.2f * number);
    EXPECT_NEAR(pareto_tail_shape(numbers), 0.8, 0.1);
}

TEST(ParetoTail, IsZeroWithoutATail)
{
    EXPECT_EQ(pareto_tail_shape({}), 0);
    EXPECT_EQ(pareto_tail_shape({1, 2, 3}), 0);
    EXPECT_EQ(pareto_tail_shape(std::vector<float>(1000, 0.5f)), 0);
}

}  // namespace
}  // namespace fathom
