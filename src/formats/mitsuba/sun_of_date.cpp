// SPDX-License-Identifier: Apache-2.0
#include "formats/mitsuba/sun_of_date.h"
#include "scene/units.h"

#include <cmath>

#include "fathom/sun.h"

namespace fathom::mitsuba {

SunAngles sun_of_date(const Element& sky, const std::function<double(std::string_view, double)>& number)
{
    const auto whole = [&](std::string_view name, int otherwise, int least, int most) {
        const double value = number(name, otherwise);
        if (!(value >= least && value <= most) || value != std::floor(value))
            sky.fail("the sun's date must have a year of at least 1900, a month from 1 to 12 and a day from 1 to 31");
        return int(value);
    };
    const int year = whole("year", 2010, 1900, 9999), month = whole("month", 7, 1, 12), day = whole("day", 10, 1, 31);
    const double hours = number("hour", 15) - number("timezone", 9),
                 seconds = 3600 * hours + 60 * number("minute", 0) + number("second", 0);
    const double latitude = number("latitude", 35.6894), longitude = number("longitude", 139.6917);
    const auto [elevation, azimuth] = sun_position(latitude, longitude, julian_day(year, month, day, seconds));
    return {elevation * radians_per_degree, azimuth * radians_per_degree};
}

}  // namespace fathom::mitsuba
