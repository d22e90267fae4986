#pragma once
#include <algorithm>

#include "kernel/camera_paths.h"

namespace fathom {
inline namespace FATHOM_LANES {

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

/// Russian roulette: which paths play, and with what probability they go on.
struct Roulette {
    Mask plays;
    Float survival;
};

inline Float max_survival(UInt bounce)
{
    return select(less(bounce, UInt(sure_bounces)), Float(1), Float(0.95f));
}

/// By the throughput, from a bounce on.
///
/// bounce: how many came before this one. eta_scale: undoes refraction's scaling of radiance, which is no loss.
[[gnu::always_inline]] inline Roulette roulette_by_throughput(const KernelSettings& settings, UInt bounce,
                                                              Float eta_scale, const Spectrum& throughput)
{
    return {!less(bounce + UInt(1u), UInt(std::uint32_t(settings.roulette_depth))),
            clamp(max_component(throughput) * eta_scale, Float(1e-3f), max_survival(bounce))};
}

/// Where it is known what paths bring from there on, and what that takes (session/efficiency_roulette.h): with the
/// chance that is worth it. otherwise: in other lanes.
[[gnu::always_inline]] inline Roulette roulette_by_need(Mask known, Float chance, UInt bounce,
                                                        const Roulette& otherwise)
{
    constexpr float least = 0.1f;
    return {Mask(known | otherwise.plays),
            select(known, clamp(chance, Float(least), max_survival(bounce)), otherwise.survival)};
}

/// Lanes whose path ends after this bounce: nothing is left, or it has lost. Those that survive carry more.
[[gnu::always_inline]] inline Mask play(const Roulette& roulette, const SampleKey& key, UInt seed, Spectrum& throughput)
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
