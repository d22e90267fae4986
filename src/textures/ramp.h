// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "textures/node.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Maps a number to a color: linear between stops, constant beyond the first and last.
struct RampTexture {
    static constexpr TextureKind kind = TextureKind::ramp;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        const Float x = graph.factor(t, at, m);
        const RampStopRecord* stop = &graph.tables.ramp_stops[t.first_stop];
        Texel r;
        for (std::size_t c = 0; c < channels; ++c) r.c[c] = Float(stop->color[c]);
        r.c[3] = Float(1);
        for (const RampStopRecord* last = stop + t.stop_count - 1; stop != last; ++stop) {
            const Mask past = x >= Float(stop->position);
            const Float width(stop[1].position - stop->position);
            const Float share = clamp((x - Float(stop->position)) / width, Float(0), Float(1));
            for (std::size_t c = 0; c < channels; ++c)
                r.c[c] =
                    select(past, fma(share, Float(stop[1].color[c] - stop->color[c]), Float(stop->color[c])), r.c[c]);
        }
        return r;
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
