#pragma once
#include <numbers>

namespace fathom {

/// The one rule of units: radiance 1 is 1 nit (candela per square metre), intensity 1 is 1 candela (nit times square
/// metre), irradiance 1 is 1 lux (nit times steradian). Watts are radiant power and become lumens by the peak of
/// luminous efficacy, in every channel alike: colour multiplies afterwards.
constexpr double lumens_per_watt = 683;
/// The one factor by which angles of files become radians: a writer looks for the number that gives the same bits.
constexpr double radians_per_degree = std::numbers::pi / 180;

}  // namespace fathom
