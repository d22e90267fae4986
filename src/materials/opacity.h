// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "textures/textures.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Opacity of a surface: the fraction of rays that its alpha stops, 0 to 1. Alpha modes opaque, mask and blend are
/// those of glTF.
///
/// material  index into ShadingTables::materials, for each lane
inline Float opacity(const ShadingTables& tables, UInt material, const TexturePoint& at, Mask m)
{
    Float share(1.f);
    for_each_unique(m, material, [&](std::uint32_t index, Mask same) {
        const MaterialRecord& record = tables.materials[index];
        if (record.alpha_mode == std::uint32_t(AlphaMode::opaque)) return;
        Float alpha(record.alpha);
        if (record.features.has(MaterialFeature::vertex_colored)) alpha = alpha * at.vertex_color[3];
        if (record.alpha_texture != no_index) {
            const Texel texel = TextureGraph(tables).evaluate(tables.textures[record.alpha_texture], at, same);
            alpha = alpha * texel.common_channel(record.alpha_channel);
        }
        if (record.alpha_mode == std::uint32_t(AlphaMode::mask))
            alpha = select(alpha >= Float(record.alpha_cutoff), Float(1), Float(0));
        share = select(same, clamp(alpha, Float(0), Float(1)), share);
    });
    return share;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
