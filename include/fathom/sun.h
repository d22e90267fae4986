// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <utility>

#include "fathom/api.h"

namespace fathom {

/// Returns the Julian day of a date: days since noon of January 1, 4713 BC, with a fraction for the time of day.
///
/// year     Year of the Gregorian calendar.
/// month    1 to 12.
/// day      1 to 31.
/// seconds  Seconds since midnight, in universal time.
FATHOM_API double julian_day(int year, int month, int day, double seconds);

/// Returns the sun's elevation above the horizon and its azimuth (clockwise from north), both in degrees, with an
/// accuracy of 0.01 degrees.
///
/// latitude_deg   Geographic latitude in degrees, positive to the north.
/// longitude_deg  Geographic longitude in degrees, positive to the east.
/// julian_day     Time, as returned by julian_day().
///
/// Atmospheric refraction, which raises the sun by half a degree at the horizon, is not included. J. Meeus 1998,
/// Astronomical Algorithms, chapters 12, 13 and 25 (low accuracy).
FATHOM_API std::pair<double, double> sun_position(double latitude_deg, double longitude_deg, double julian_day);

}  // namespace fathom
