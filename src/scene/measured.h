#pragma once
#include <string>

#include "fathom/description.h"

namespace fathom {

/// What of a measured surface can't be rendered: `'vndf': ...`. Empty if nothing is wrong.
std::string problem_of(const MeasuredBrdf& brdf);

/// About what it reflects of light from everywhere, seen at 45 degrees.
Color reflectance_of(const MeasuredBrdf& brdf);

}  // namespace fathom
