#pragma once
#include <functional>
#include <string_view>

#include "formats/mitsuba/elements.h"

namespace fathom::mitsuba {

struct SunAngles {
    double elevation, azimuth;  ///< radians, the latter clockwise from north
};

/// Where the date and the place that a sky tells put the sun; Tokyo on an afternoon in July where it tells nothing.
/// number  a parameter of the sky by its name, or what it is otherwise
/// Throws Error of the sky if there is no such date.
SunAngles sun_of_date(const Element& sky, const std::function<double(std::string_view, double)>& number);

}  // namespace fathom::mitsuba
