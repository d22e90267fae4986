#pragma once
#include <algorithm>

#include "integrate/camera_paths.h"

namespace fathom::inline FATHOM_LANES {

/// Bounces are counted in 15 bits: a path that got there is one in a number too large to be met.
inline constexpr std::uint32_t max_bounces = 0x7ff0;

/// Paths that lose nothing go on for sure up to this bounce: through stacks of glass, roulette would only add noise.
/// From there on one in twenty ends, or in a closed white room none ever would.
inline constexpr std::uint32_t sure_bounces = 64;

/// Lanes that may scatter where they are, `bounce` bounces from the camera: there they have a light sampled, too.
[[gnu::always_inline]] inline Mask may_scatter(const KernelSettings& settings, UInt bounce)
{
    const std::uint32_t limit =
        settings.max_depth >= 0 ? std::min(std::uint32_t(settings.max_depth), max_bounces) : max_bounces;
    return less(bounce, UInt(limit));
}

/// Lanes whose path ends after this bounce: nothing is left, or Russian roulette. Those that survive the roulette carry
/// more.
///
/// bounce: how many came before this one. eta_scale: undoes refraction's scaling of radiance, which is no loss.
[[gnu::always_inline]] inline Mask apply_roulette(const KernelSettings& settings, const SampleKey& key, UInt seed,
                                                  UInt bounce, Float eta_scale, Spectrum& throughput)
{
    const Float largest = max_component(throughput);
    Mask ends = !(largest > Float(0));
    const Mask roulette = !less(bounce + UInt(1u), UInt(std::uint32_t(settings.roulette_depth)));
    if (any(roulette)) {
        const Float most = select(less(bounce, UInt(sure_bounces)), Float(1), Float(0.95f));
        const Float survival = clamp(largest * eta_scale, Float(1e-3f), most);
        ends |= roulette & (sample_hash(key, pair_seed(seed, pair_roulette)) >= survival);
        throughput = throughput * select(roulette, reciprocal(survival), Float(1));
    }
    return ends;
}

}  // namespace fathom::inline FATHOM_LANES
