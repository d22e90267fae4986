#pragma once
#include "integrate/camera_paths.h"
#include "integrate/stages/path_end.h"
#include "integrate/stages/shading_point.h"

namespace fathom::inline FATHOM_LANES {

/// Where a path goes from a surface.
struct Scattered {
    Vec3 wi;
    Spectrum throughput;
    Float pdf;
    Mask is_delta;
    Float eta;               ///< see BsdfSample
    Mask enters_subsurface;  ///< the same
};

/// key, seed: of the path and its bounce. index: of the order in which this bounce's directions come.
template <class Closure>
[[gnu::always_inline]] inline Scattered scatter(const Closure& closure, const ShadingPoint& at, const SampleKey& key,
                                                UInt seed, UInt index, const Spectrum& throughput)
{
    const Float choice = sample_2d(key, pair_seed(seed, pair_choice)).x;
    const BsdfSample next = closure.sample(at.wo, sample_2d(index, pair_seed(seed, pair_bsdf)), choice);
    Scattered s{at.frame.to_world(next.wi), throughput * next.weight, next.pdf, next.is_delta, next.eta,
                next.enters_subsurface};
    // A shading normal must not send light through the surface, nor keep it from passing.
    const Float side = dot(s.wi, at.ng);
    s.throughput = select(equal(side > Float(0), next.wi.z > Float(0)), s.throughput, Spectrum(Float(0)));
    if (Closure::transmits && any(at.passes_on)) {
        s.wi = select(at.passes_on, at.d, s.wi);
        s.throughput = select(at.passes_on, throughput, s.throughput);
        s.is_delta |= at.passes_on;
        s.eta = select(at.passes_on, Float(1), s.eta);
    }
    return s;
}

}  // namespace fathom::inline FATHOM_LANES
