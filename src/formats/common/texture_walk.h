// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/description.h"
#include "scene/material_table.h"
#include "scene/texture_table.h"

namespace fathom {

/// Calls visit(index) for a texture and all textures that it refers to.
template <class Visit>
void for_each_reached_by_texture(const SceneDescription& scene, int texture, const Visit& visit)
{
    if (texture < 0) return;
    visit(texture);
    for_each_texture(scene.textures[std::size_t(texture)], texture_parameters(),
                     [&](int other, const char*) { for_each_reached_by_texture(scene, other, visit); });
}

/// Calls visit(index) for all textures that a material and its mixed materials refer to. `m` need not be part of the
/// scene whose materials and textures it refers to.
template <class Visit>
void for_each_reached(const SceneDescription& scene, const Material& m, const Visit& visit)
{
    for_each_texture(m, material_parameters(),
                     [&](int texture, const char*) { for_each_reached_by_texture(scene, texture, visit); });
    for (const int part : {m.mixture.material_a, m.mixture.material_b})
        if (part >= 0) for_each_reached(scene, scene.materials[std::size_t(part)], visit);
}

/// Whether a material, or one that it mixes, is anisotropic along the texture coordinates: by its parameters or by
/// measured data.
inline bool has_anisotropy(const SceneDescription& scene, const Material& m)
{
    bool found = m.microfacets.anisotropy.value != 0;
    if (m.kind == MaterialKind::measured) found = !scene.measured[std::size_t(m.measured)].is_isotropic();
    for (const int part : {m.mixture.material_a, m.mixture.material_b})
        found = found || (part >= 0 && has_anisotropy(scene, scene.materials[std::size_t(part)]));
    return found;
}

/// Whether a material depends on the surface's texture coordinates.
inline bool reaches_uv(const SceneDescription& scene, const Material& m)
{
    bool found = has_anisotropy(scene, m);
    for_each_reached(scene, m, [&](int texture) { found |= reads_uv(scene.textures[std::size_t(texture)]); });
    return found;
}

}  // namespace fathom
