#pragma once
#include "fathom/description.h"
#include "scene/material_table.h"
#include "scene/texture_table.h"

namespace fathom {

/// Whether a texture, or one that it refers to, looks at the texture coordinates of surfaces.
inline bool reaches_uv(const SceneDescription& scene, const Texture& texture)
{
    bool found = looks_at_uv(texture);
    for_each_texture(texture, texture_parameters(), [&](int other, const char*) {
        found = found || (other >= 0 && reaches_uv(scene, scene.textures[std::size_t(other)]));
    });
    return found;
}

/// The same of a material, or of one that it is mixed of; or whether its facets are drawn out along them. m: may stand
/// outside of the scene, whose materials it refers to.
inline bool reaches_uv(const SceneDescription& scene, const Material& m)
{
    bool found = m.anisotropy.value != 0;
    for_each_texture(m, material_parameters(), [&](int texture, const char*) {
        found = found || (texture >= 0 && reaches_uv(scene, scene.textures[std::size_t(texture)]));
    });
    for (const int part : {m.material_a, m.material_b})
        found = found || (part >= 0 && reaches_uv(scene, scene.materials[std::size_t(part)]));
    return found;
}

}  // namespace fathom
