// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "fathom/vector.h"

namespace fathom::pbrt {

/// A measured medium: coefficients per millimeter, with isotropic scattering.
struct MeasuredMedium {
    const char* name;
    Color scattering, absorption;
};

/// Looks up a medium by its name in pbrt-v4; null if there is none.
const MeasuredMedium* find_medium(const std::string& name);
std::vector<std::string> medium_names();

}  // namespace fathom::pbrt
