#pragma once
#include <string>

#include "fathom/description.h"

namespace fathom {

/// A measured surface as a file of the RGL's format, with colours: what formats/common/measured_file.h reads, bit for
/// bit.
std::string measured_file(const MeasuredBrdf& brdf);

}  // namespace fathom
