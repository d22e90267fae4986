// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "scene/parameters.h"

namespace fathom {

/// Every kind of texture, in the order of TextureKind.
std::span<const KindName<TextureKind>> texture_kinds();
/// Every parameter of textures. A key may appear several times, for different kinds.
std::span<const Parameter<Texture>> texture_parameters();
/// Whether the texture reads the surface's uv coordinates.
bool reads_uv(const Texture& texture);
/// Whether the texture reads the position in the space of Texture::world_from_texture.
bool reads_position(const Texture& texture);

}  // namespace fathom
