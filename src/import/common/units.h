#pragma once

namespace fathom {

/// The one rule of units: radiance 1 is 1 nit (candela per square metre), intensity 1 is 1 candela (nit times square
/// metre), irradiance 1 is 1 lux (nit times steradian). Watts are radiant power and become lumens by the peak of
/// luminous efficacy, in every channel alike: colour multiplies afterwards.
constexpr double lumens_per_watt = 683;

}  // namespace fathom
