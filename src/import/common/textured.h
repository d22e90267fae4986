#pragma once
#include <algorithm>

#include "fathom/description.h"
#include "scene/material_table.h"

namespace fathom {

/// Whether a material, or one it is mixed of, looks different in different places of a shape. m: may stand outside of
/// the scene, whose materials it refers to.
inline bool is_textured(const SceneDescription& scene, const Material& m)
{
    bool found = false;
    for_each_texture(m, material_parameters(), [&](int texture, const char*) { found |= texture >= 0; });
    for (const int part : {m.material_a, m.material_b})
        found = found || (part >= 0 && is_textured(scene, scene.materials[std::size_t(part)]));
    return found;
}

}  // namespace fathom
