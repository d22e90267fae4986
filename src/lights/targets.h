// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <vector>

namespace fathom {

/// Spheres that light paths are aimed at, in render space, because light that arrives there makes caustics; learned by
/// session/light_targets.h.
struct LightTargets {
    static constexpr std::size_t max_targets = 8;

    struct Target {
        float center[3];
        float radius;
        float share;  ///< of the light paths
    };
    std::vector<Target> targets;
    /// Share of the light paths that follow the light's own emission.
    float own_share = 1;
    /// Cumulative selection probabilities of the lights, lights + 1 values from 0 to 1: first for paths by the light's
    /// own emission, then for each target.
    std::vector<float> light_cdf;
    /// Probability of selecting a light for a target divided by LightRecord::pmf: lights values for each target. 0 for
    /// lights that cannot be aimed.
    std::vector<float> light_ratios;
};

}  // namespace fathom
