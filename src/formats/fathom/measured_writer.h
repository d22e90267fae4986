// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "fathom/description.h"

namespace fathom {

/// Writes a measured BRDF in the RGL's format with colors in place of spectra. The reader in
/// formats/common/measured_file.h restores it bit for bit.
std::string measured_file(const MeasuredBrdf& brdf);

}  // namespace fathom
