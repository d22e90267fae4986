#pragma once
#include "fathom/description.h"

namespace fathom {

/// What rays pass as if it were not there.
inline bool is_nothing(const Material& m)
{
    return m.kind == MaterialKind::none && m.alpha.value == 0;
}

/// The material as often as the weight says, or (of_nothing) as it doesn't, and else nothing.
inline Material blend_with_nothing(SceneDescription& scene, Material m, FloatInput weight, bool of_nothing)
{
    if (of_nothing && weight.texture < 0) weight.value = 1 - weight.value;
    if (of_nothing && weight.texture >= 0) {
        Texture inverse;
        inverse.kind = TextureKind::mix;
        inverse.color_a = {{1, 1, 1}, -1}, inverse.color_b = {{0, 0, 0}, -1}, inverse.factor = weight;
        weight = {1, int(scene.textures.size()), 1};
        scene.textures.push_back(inverse);
    }
    if (m.alpha_mode == AlphaMode::opaque) m.alpha = {1, -1, weight.channel};
    m.alpha_mode = AlphaMode::blend;
    m.alpha.value *= weight.value;
    // Of two pictures the blend's is what artists see first.
    if (weight.texture >= 0) m.alpha.texture = weight.texture, m.alpha.channel = weight.channel;
    return m;
}

}  // namespace fathom
