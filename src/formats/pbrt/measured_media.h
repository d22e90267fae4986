#pragma once
#include <string>
#include <vector>

#include "fathom/vector.h"

namespace fathom::pbrt {

/// What light meets in stuff that was measured: coefficients of a millimetre, of scattering that goes evenly all round.
struct MeasuredMedium {
    const char* name;
    Color scattering, absorption;
};

/// By the names that pbrt-v4 has for them; null if there is none.
const MeasuredMedium* find_medium(const std::string& name);
std::vector<std::string> medium_names();

}  // namespace fathom::pbrt
