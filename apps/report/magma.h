// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fathom::cli {

/// A color as sRGB codes.
using Codes = std::array<double, 3>;

/// The color of a value from 0 to 1 in magma, a map of matplotlib by S. van der Walt and N. Smith that FLIP uses.
inline Codes magma(double value)
{
    constexpr std::array<Codes, 10> colors{{{0, 0, 4},
                                            {24, 15, 62},
                                            {69, 16, 119},
                                            {114, 31, 129},
                                            {159, 47, 127},
                                            {205, 64, 113},
                                            {241, 96, 93},
                                            {253, 149, 103},
                                            {254, 201, 141},
                                            {252, 253, 191}}};
    const double place = std::clamp(value, 0.0, 1.0) * (colors.size() - 1);
    const auto index = std::min(std::size_t(place), colors.size() - 2);
    Codes result;
    for (std::size_t c = 0; c < 3; ++c)
        result[c] = std::lerp(colors[index][c], colors[index + 1][c], place - double(index));
    return result;
}

/// Linear value of an sRGB code from 0 to 255.
inline float linear_from_code(double code)
{
    const double v = code / 255;
    return float(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
}

}  // namespace fathom::cli
