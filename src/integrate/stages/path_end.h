// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>

#include "kernel/camera_paths.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Bounces are counted in 15 bits; paths that long are too rare to matter.
inline constexpr std::uint32_t max_bounces = 0x7ff0;

/// Paths without loss of throughput always survive up to this bounce: through stacks of glass, roulette would only add
/// noise. Beyond it, 5 % end at each bounce; otherwise paths in a closed white room would never end.
inline constexpr std::uint32_t sure_bounces = 64;

/// Lanes that may scatter (and sample a light) at their vertex. bounce: number of bounces before it.
[[gnu::always_inline]] inline Mask may_scatter(const KernelSettings& settings, UInt bounce)
{
    const std::uint32_t limit =
        settings.max_depth >= 0 ? std::min(std::uint32_t(settings.max_depth), max_bounces) : max_bounces;
    return less(bounce, UInt(limit));
}

/// Russian roulette: which paths take part, and their survival probabilities.
struct Roulette {
    Mask plays;
    Float survival;
};

/// Upper limit on the survival probability at a bounce.
inline Float max_survival(UInt bounce)
{
    return select(less(bounce, UInt(sure_bounces)), Float(1), Float(0.95f));
}

/// Russian roulette by throughput, from bounce settings.roulette_depth on.
///
/// bounce: number of bounces before this one. eta_scale: cancels the scaling of radiance by refraction, which is no
/// loss.
[[gnu::always_inline]] inline Roulette roulette_by_throughput(const KernelSettings& settings, UInt bounce,
                                                              Float eta_scale, const Spectrum& throughput)
{
    return {!less(bounce + UInt(1u), UInt(std::uint32_t(settings.roulette_depth))),
            clamp(max_component(throughput) * eta_scale, Float(1e-3f), max_survival(bounce))};
}

/// Efficiency-aware roulette in the lanes of `known`, with the survival probability `chance` (see
/// session/efficiency_roulette.h); `otherwise` in other lanes.
[[gnu::always_inline]] inline Roulette efficiency_roulette(Mask known, Float chance, UInt bounce,
                                                           const Roulette& otherwise)
{
    constexpr float least = 0.1f;
    return {Mask(known | otherwise.plays),
            select(known, clamp(chance, Float(least), max_survival(bounce)), otherwise.survival)};
}

/// Plays Russian roulette. Returns the lanes whose path ends, by roulette or because its throughput is 0; scales up the
/// throughput of the others.
[[gnu::always_inline]] inline Mask apply_roulette(const Roulette& roulette, const SampleKey& key, UInt seed,
                                                  Spectrum& throughput)
{
    Mask ends = !(max_component(throughput) > Float(0));
    if (any(roulette.plays)) {
        ends |= roulette.plays & (sample_hash(key, pair_seed(seed, pair_roulette)) >= roulette.survival);
        throughput = throughput * select(roulette.plays, reciprocal(roulette.survival), Float(1));
    }
    return ends;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
