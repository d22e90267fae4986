#pragma once
#include <utility>

#include "fathom/api.h"

namespace fathom {

/// Days since noon of the first of January 4713 BC, of a date of the Gregorian calendar from 1900 on.
/// seconds  since its midnight, in universal time
FATHOM_API double julian_day(int year, int month, int day, double seconds);

/// Elevation and azimuth (clockwise from north) of the sun, degrees, to 0.01: J. Meeus, Astronomical Algorithms, 1998,
/// chapters 12, 13 and 25, the low accuracy; air, which lifts the sun at the horizon by half a degree, is left out.
/// longitude_deg  to the east
FATHOM_API std::pair<double, double> sun_position(double latitude_deg, double longitude_deg, double julian_day);

}  // namespace fathom
