// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <numbers>

namespace fathom {

/// Conversion of radiometric units: radiance 1 is 1 nit (cd/m2), intensity 1 is 1 candela and irradiance 1 is 1 lux.
/// Watts are radiant power and become lumens by the maximal luminous efficacy, equally in all channels; color
/// multiplies afterwards.
constexpr double lumens_per_watt = 683;
/// All readers convert degrees with this factor, so that writers can find a number that reads back to the same bits.
constexpr double radians_per_degree = std::numbers::pi / 180;

}  // namespace fathom
