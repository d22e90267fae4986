// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "fathom/description.h"

namespace fathom {

/// Describes the part of a measured BRDF that can't be rendered, such as `'vndf': ...`; empty if nothing is wrong.
std::string problem_of(const MeasuredBrdf& brdf);

/// Approximate reflectance for an outgoing direction at 45 degrees under uniform illumination.
Color reflectance_of(const MeasuredBrdf& brdf);

}  // namespace fathom
