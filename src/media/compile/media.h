// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Compilation of media: the interiors of solids.
#include "compile/compiler.h"

namespace fathom {

/// Index in MediaTables of the medium for light refracted into a solid of a material; solids with equal interiors share
/// one. is_index_matched: see MediumRecord.
std::uint32_t volume_medium(Compiler& c, const Material& m, bool is_index_matched);

/// Index of the medium for light that enters through the subsurface lobe.
std::uint32_t subsurface_medium(Compiler& c, const Material& m);

}  // namespace fathom
