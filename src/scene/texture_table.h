#pragma once
#include "scene/parameters.h"

namespace fathom {

/// Every kind of texture, in the order of TextureKind.
std::span<const KindName<TextureKind>> texture_kinds();
/// Every parameter of textures. A key may stand there several times, for different kinds.
std::span<const Parameter<Texture>> texture_parameters();

}  // namespace fathom
