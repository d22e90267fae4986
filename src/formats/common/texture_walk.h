#pragma once
#include "fathom/description.h"
#include "scene/material_table.h"
#include "scene/texture_table.h"

namespace fathom {

/// Calls visit(number) of a texture and of all that it is made of.
template <class Visit>
void for_each_reached_by_texture(const SceneDescription& scene, int texture, const Visit& visit)
{
    if (texture < 0) return;
    visit(texture);
    for_each_texture(scene.textures[std::size_t(texture)], texture_parameters(),
                     [&](int other, const char*) { for_each_reached_by_texture(scene, other, visit); });
}

/// The same of a material's textures, and of the materials that it is mixed of. m: may stand outside of the scene,
/// whose materials it refers to.
template <class Visit>
void for_each_reached(const SceneDescription& scene, const Material& m, const Visit& visit)
{
    for_each_texture(m, material_parameters(),
                     [&](int texture, const char*) { for_each_reached_by_texture(scene, texture, visit); });
    for (const int part : {m.material_a, m.material_b})
        if (part >= 0) for_each_reached(scene, scene.materials[std::size_t(part)], visit);
}

/// Whether facets of a material, or of one that it is mixed of, are drawn out along texture coordinates, or were
/// measured along them.
inline bool has_anisotropy(const SceneDescription& scene, const Material& m)
{
    bool found = m.anisotropy.value != 0;
    if (m.kind == MaterialKind::measured) found = !scene.measured[std::size_t(m.measured)].is_isotropic();
    for (const int part : {m.material_a, m.material_b})
        found = found || (part >= 0 && has_anisotropy(scene, scene.materials[std::size_t(part)]));
    return found;
}

/// Whether a material looks at the texture coordinates of surfaces.
inline bool reaches_uv(const SceneDescription& scene, const Material& m)
{
    bool found = has_anisotropy(scene, m);
    for_each_reached(scene, m, [&](int texture) { found |= looks_at_uv(scene.textures[std::size_t(texture)]); });
    return found;
}

}  // namespace fathom
