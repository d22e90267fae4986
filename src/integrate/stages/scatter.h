// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "guiding/guidance.h"
#include "integrate/stages/path_end.h"
#include "integrate/stages/shading_point.h"
#include "kernel/camera_paths.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Random numbers of a gang of paths at a vertex.
struct VertexRandom {
    SampleKey key;
    UInt seed;   ///< seed for the bounce's group of dimensions
    UInt index;  ///< shuffled sample index; light samples and directions share it because they never enter one product

    VertexRandom(const SampleKey& sample_key, UInt group)
        : key(sample_key), seed(group_seed(key, group)), index(shuffled_index(key, seed))
    {
    }
    Sample2 light() const { return sample_2d(index, pair_seed(seed, pair_light)); }
    Sample2 direction() const { return sample_2d(index, pair_seed(seed, pair_bsdf)); }
};

/// Outcome of scattering at a surface.
struct Scattered {
    Vec3 wi;
    Spectrum throughput;
    Float pdf;
    Float scatter_pdf;  ///< of the closure alone, without guiding
    Mask is_delta;
    Float eta;               ///< relative index of refraction, see BsdfSample
    Mask enters_subsurface;  ///< lanes that enter the subsurface medium, see BsdfSample
};

/// One-sample MIS between the closure and the guiding distribution: each direction is weighted by the density of the
/// mixture. choice: selects the strategy and then the lobe.
template <class Closure>
[[gnu::always_inline]] inline Scattered scatter_guided(const Closure& closure, const ShadingPoint<Closure>& at,
                                                       const Guidance& guidance, Float choice, Sample2 random,
                                                       const Spectrum& throughput)
{
    const Float share = guidance.share();
    const Mask guided = choice < share;
    const Float rest = clamp((choice - share) / (Float(1) - share), Float(0), Float(1 - 0x1p-24f));
    const BsdfSample by_bsdf = closure.sample(at.wo, random, rest);
    const Vec3 wi = select(guided, guidance.sample(random), at.frame.to_world(by_bsdf.wi));
    const Vec3 local = select(guided, at.frame.to_local(wi), by_bsdf.wi);
    const BsdfEval e = closure.eval(at.wo, local);
    const Float pdf = guidance.pdf(wi, e.pdf), inverse_pdf = Float(1) / max(pdf, Float(1e-30f));
    const Spectrum weight = select(by_bsdf.is_delta, by_bsdf.weight, e.f_cos * inverse_pdf);
    const Mask same_side = equal(dot(wi, at.ng) > Float(0), local.z > Float(0));
    return {
        wi,         select(same_side, throughput * weight, Spectrum(Float(0))), pdf, e.pdf, by_bsdf.is_delta, Float(1),
        Mask(false)};
}

/// BSDF sampling, or guided sampling if the guidance is on: samples the next direction of paths.
template <class Closure>
[[gnu::always_inline]] inline Scattered scatter(const Closure& closure, const ShadingPoint<Closure>& at,
                                                const Guidance& guidance, const VertexRandom& numbers,
                                                const Spectrum& throughput)
{
    const Float choice = sample_2d(numbers.key, pair_seed(numbers.seed, pair_choice)).x;
    const Sample2 random = numbers.direction();
    if constexpr (Closure::is_guided)
        if (guidance.is_on()) return scatter_guided(closure, at, guidance, choice, random, throughput);
    const BsdfSample next = closure.sample(at.wo, random, choice);
    Scattered s{at.frame.to_world(next.wi), throughput * next.weight, next.pdf, next.pdf, next.is_delta, next.eta,
                next.enters_subsurface};
    // A shading normal must not change the side of the surface on which light leaves.
    const Float side = dot(s.wi, at.ng);
    s.throughput = select(equal(side > Float(0), next.wi.z > Float(0)), s.throughput, Spectrum(Float(0)));
    if (Closure::transmits && any(at.skips_interface)) {
        s.wi = select(at.skips_interface, at.d, s.wi);
        s.throughput = select(at.skips_interface, throughput, s.throughput);
        s.is_delta |= at.skips_interface;
        s.eta = select(at.skips_interface, Float(1), s.eta);
    }
    return s;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
