// SPDX-License-Identifier: Apache-2.0
#include "fathom/sun.h"

#include <cmath>

#include "scene/units.h"

namespace fathom {

namespace {

constexpr double julian_day_1970 = 2440587.5;

/// Days from 1970-01-01 to a date of the Gregorian calendar: H. Hinnant, "chrono-Compatible Low-Level Date Algorithms".
long days_since_1970(long year, long month, long day)
{
    year -= month <= 2;
    const long era = (year >= 0 ? year : year - 399) / 400, of_era = year - era * 400;
    const long of_year = (153 * (month > 2 ? month - 3 : month + 9) + 2) / 5 + day - 1;
    return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
}

}  // namespace

double julian_day(int year, int month, int day, double seconds)
{
    return julian_day_1970 + double(days_since_1970(year, month, day)) + seconds / 86400;
}

std::pair<double, double> sun_position(double latitude_deg, double longitude_deg, double julian_day)
{
    const double days = julian_day - 2451545, t = days / 36525;
    // Meeus 1998 (see fathom/sun.h), equations 25.2 to 25.4, and the apparent longitude.
    const double mean_longitude = 280.46646 + t * (36000.76983 + t * 0.0003032);
    const double anomaly = (357.52911 + t * (35999.05029 - t * 0.0001537)) * radians_per_degree;
    const double centre = (1.914602 - t * (0.004817 + t * 0.000014)) * std::sin(anomaly) +
                          (0.019993 - t * 0.000101) * std::sin(2 * anomaly) + 0.000289 * std::sin(3 * anomaly);
    const double node = (125.04 - 1934.136 * t) * radians_per_degree;
    const double longitude = (mean_longitude + centre - 0.00569 - 0.00478 * std::sin(node)) * radians_per_degree;
    const double obliquity = (23.4392911 - 0.0130042 * t + 0.00256 * std::cos(node)) * radians_per_degree;
    const double declination = std::asin(std::sin(obliquity) * std::sin(longitude));
    const double right_ascension = std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude));
    // The position follows from Meeus 1998, equations 12.4, 13.5 and 13.6.
    const double sidereal = 280.46061837 + 360.98564736629 * days + 0.000387933 * t * t;
    const double hour = (std::fmod(sidereal, 360) + longitude_deg) * radians_per_degree - right_ascension;
    const double latitude = latitude_deg * radians_per_degree;
    const double elevation = std::asin(std::sin(latitude) * std::sin(declination) +
                                       std::cos(latitude) * std::cos(declination) * std::cos(hour));
    const double azimuth =
        std::atan2(std::sin(hour), std::cos(hour) * std::sin(latitude) - std::tan(declination) * std::cos(latitude));
    return {elevation / radians_per_degree, 180 + azimuth / radians_per_degree};
}

}  // namespace fathom
