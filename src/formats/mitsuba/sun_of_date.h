// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string_view>

#include "formats/mitsuba/elements.h"

namespace fathom::mitsuba {

/// Direction of the sun.
struct SunAngles {
    double elevation, azimuth;  ///< in radians; azimuth is clockwise from north
};

/// Direction of the sun from the date and place of a sky emitter, with Mitsuba's defaults: an afternoon in July in
/// Tokyo. Throws Error naming the sky if the date is invalid.
///
/// number  returns a parameter of the sky by name, or the given default
SunAngles sun_of_date(const Element& sky, const std::function<double(std::string_view, double)>& number);

}  // namespace fathom::mitsuba
