// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Shading of quads that are not plain (QuadColumns::plain) in the loop for scenes of quads: next event estimation and
/// sampling of the next direction by their closures.
#include "integrate/stages/direct.h"
#include "integrate/stages/scatter.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Vertices of a gang of paths on quads.
struct QuadVertex {
    Vec3 p;        ///< position on the quad
    Float offset;  ///< distance from the quad at which rays leave it
    Vec3 d;        ///< direction along which each path arrived
    Vec3 eye;      ///< point from which lights are sampled
    UInt quad;
    VertexRandom random;
    Spectrum throughput;
};

/// Result of scattering: the next direction, and the light sample with its shadow ray.
struct QuadScatter {
    Scattered by;
    Vec3 start;
    Mask lit{false};  ///< lanes that receive `direct` if the shadow ray is not blocked
    Spectrum direct;
    Ray shadow;
};

/// Shades the quads that are not plain.
class QuadClosures {
public:
    QuadClosures(const LaneScene& scene, StageClock& clock) : surfaces_(scene), materials_(scene), clock_(clock) {}

    /// Scatters the lanes of m, whose quads all have this kind of closure. sample: returns the light sample for a mask.
    template <class LightOf>
    [[gnu::always_inline]] void scatter(ClosureKind kind, const QuadVertex& place, Mask m, bool lights_are_sampled,
                                        const LightOf& sample, QuadScatter& next) const
    {
        Closures::visit(kind, [&]<class Closure>() {
            if constexpr (is_small<Closure>) scatter_by<Closure>(place, m, lights_are_sampled, sample, next);
        });
    }

private:
    template <class Closure, class LightOf>
    [[gnu::noinline, gnu::flatten]] void scatter_by(const QuadVertex& place, Mask m, bool lights_are_sampled,
                                                    const LightOf& sample, QuadScatter& next) const
    {
        clock_.enter(RenderStage::surface);
        const SurfaceHit hit{place.p, place.d, Float(0), Float(0), Float(0), Float(0), place.quad, UInt(no_index)};
        ShadingPoint<Closure> at = read_shading_point<Closure>(surfaces_, materials_, hit, nullptr, m, clock_);
        at.offset = place.offset;
        const Closure closure(at.material);
        const Mask smooth = m & closure.has_non_delta();
        if (lights_are_sampled && any(smooth)) {
            clock_.enter(RenderStage::light);
            const LightSample light = sample(smooth);
            Mask lit = smooth & (light.inverse_pdf > Float(0));
            Float scatter_pdf;
            next.direct = direct_light(closure, at, Guidance{}, light, place.throughput, lit, scatter_pdf);
            next.shadow = shadow_ray(at, place.eye, light, Float(0));
            next.lit = lit;
        }
        clock_.enter(RenderStage::scatter);
        next.by = fathom::scatter(closure, at, Guidance{}, place.random, place.throughput);
        next.start = at.start(next.by.wi);
    }

    const SurfaceReader surfaces_;
    const MaterialReader materials_;
    StageClock& clock_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
