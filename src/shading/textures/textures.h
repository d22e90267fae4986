#pragma once
/// All textures: the list that lookups are made from.
#include "shading/textures/checker.h"
#include "shading/textures/coordinates.h"
#include "shading/textures/dots.h"
#include "shading/textures/facing.h"
#include "shading/textures/fractal.h"
#include "shading/textures/image.h"
#include "shading/textures/limits.h"
#include "shading/textures/mix.h"
#include "shading/textures/noise.h"
#include "shading/textures/ramp.h"
#include "shading/textures/scale.h"
#include "shading/textures/uv_transform.h"
#include "shading/textures/vertex_color.h"

namespace fathom::inline FATHOM_LANES {

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

/// A texture of each lane's own; 1 where there is none.
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

}  // namespace fathom::inline FATHOM_LANES
