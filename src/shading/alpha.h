#pragma once
#include "shading/texture.h"

namespace fathom::inline FATHOM_LANES {

/// The share of the rays to a place of a material that its alpha stops, 0 to 1.
///
/// material      of each lane
/// vertex_alpha  of the mesh's colours there; 1 where it has none
inline Float alpha_share(const ShadingTables& tables, UInt material, const TexturePoint& at, Float vertex_alpha, Mask m)
{
    Float share(1.f);
    for_each_unique(m, material, [&](std::uint32_t index, Mask same) {
        const MaterialRecord& record = tables.materials[index];
        if (record.alpha_mode == std::uint32_t(AlphaMode::opaque)) return;
        Float alpha(record.alpha);
        if (record.flags & MaterialRecord::vertex_colored) alpha = alpha * vertex_alpha;
        if (record.alpha_texture != no_index) {
            const Texel texel = evaluate_texture(tables, tables.textures[record.alpha_texture], at, same);
            alpha = alpha * texel.c[record.alpha_channel];
        }
        if (record.alpha_mode == std::uint32_t(AlphaMode::mask))
            alpha = select(alpha >= Float(record.alpha_cutoff), Float(1), Float(0));
        share = select(same, clamp(alpha, Float(0), Float(1)), share);
    });
    return share;
}

}  // namespace fathom::inline FATHOM_LANES
