#pragma once
#include "textures/mapping.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Where it is looked up, as a colour: what goes from corner to corner is mixed by it.
struct CoordinatesTexture {
    static constexpr TextureKind kind = TextureKind::coordinates;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask)
    {
        const TextureUv uv(graph.tables, t, at);
        return {{uv.u, uv.v, Float(0), Float(1)}};
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
