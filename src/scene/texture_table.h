#pragma once
#include "scene/parameters.h"

namespace fathom {

/// Every kind of texture, in the order of TextureKind.
std::span<const KindName<TextureKind>> texture_kinds();
/// Every parameter of textures. A key may stand there several times, for different kinds.
std::span<const Parameter<Texture>> texture_parameters();
/// Whether it looks at the texture coordinates of the surface, or at the place in Texture::world_from_texture's space.
bool looks_at_uv(const Texture& texture);
bool looks_at_space(const Texture& texture);

}  // namespace fathom
