// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "textures/node.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Linear interpolation between two colors by a factor.
struct MixTexture {
    static constexpr TextureKind kind = TextureKind::mix;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        return graph.mix(t, graph.factor(t, at, m), at, m);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
