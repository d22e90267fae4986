#pragma once
/// What solids are filled with, as the kernel reads it.
#include "compile/compiler.h"

namespace fathom {

/// The number of what fills a solid of a material, for light that is refracted into it, among the media of the tables;
/// solids that are filled alike share one. is_open: see MediumRecord.
std::uint32_t volume_medium(Compiler& c, const Material& m, bool is_open);

/// The same for light that enters by the subsurface.
std::uint32_t subsurface_medium(Compiler& c, const Material& m);

}  // namespace fathom
