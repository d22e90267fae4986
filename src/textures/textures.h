// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The list of all textures, from which the evaluation of graphs is generated.
#include "textures/coordinates.h"
#include "textures/fractal.h"
#include "textures/image.h"
#include "textures/noise.h"
#include "textures/operations.h"
#include "textures/patterns.h"
#include "textures/ramp.h"
#include "textures/surface.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Evaluates a texture by the node class of its kind.
template <class... Node>
struct TextureList {
    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        Texel r;
        const auto is_of = [&]<class One>(One) {
            if (TextureKind(t.kind) != One::kind) return false;
            r = One::evaluate(graph, t, at, m);
            return true;
        };
        static_cast<void>((is_of(Node()) || ...));
        return r;
    }
};

using Textures = TextureList<ImageTexture, CheckerUvTexture, CheckerSpaceTexture, NoiseTexture, TurbulenceTexture,
                             MarbleTexture, MixTexture, ScaleTexture, UvTransformTexture, RampTexture,
                             VertexColorTexture, FbmTexture, WrinkledTexture, WindyTexture, VeinedMarbleTexture,
                             DotsTexture, CoordinatesTexture, FacingTexture, InvertTexture, ClampTexture>;

[[gnu::noinline]] inline Texel TextureGraph::evaluate(const TextureRecord& t, const TexturePoint& at, Mask m) const
{
    return Textures::evaluate(*this, t, at, m);
}

/// Evaluates the texture of each lane; 1 in lanes without a texture.
inline Texel evaluate_textures(const ShadingTables& tables, UInt texture, const TexturePoint& at, Mask m)
{
    const TextureGraph graph(tables);
    Texel r;
    for (Float& c : r.c) c = Float(1);
    for_each_unique(m & (texture != UInt(no_index)), texture, [&](std::uint32_t index, Mask same) {
        const Texel t = graph.evaluate(tables.textures[index], at, same);
        for (int c = 0; c < 4; ++c) r.c[c] = select(same, t.c[c], r.c[c]);
    });
    return r;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
