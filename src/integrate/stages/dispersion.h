// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/camera_paths.h"
#include "materials/closures/closure.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Chooses the channel that a path follows at a dispersive surface. A path with several channels picks one at random,
/// which is then weighted by `channels`; a path of a single channel keeps it. The channel selects the index of
/// refraction, at the wavelengths between which KHR_materials_dispersion defines the spread.
inline void choose_channel(const SampleKey& key, UInt seed, LayeredMaterialPoint& material, Spectrum& throughput)
{
    const LayersPoint& layers = material.layers;
    if (!layers.has(LayersRecord::disperses)) return;
    const Mask splits = (layers.dispersion > Float(0)) & (layers.transmission > Float(0));
    const Float pick = sample_hash(key, pair_seed(seed, pair_channel)) * Float(float(channels));
    // A path with a single positive channel keeps that channel; others get the picked one.
    Float alive(0), alone(0);
    for (int c = 0; c < channels; ++c) {
        const Mask lives = throughput.c[c] > Float(0);
        alive = alive + select(lives, Float(1), Float(0));
        alone = select(lives, Float(float(c)), alone);
    }
    const Mask is_white = alive > Float(1);
    const Float channel = select(is_white, min(floor(pick), Float(float(channels - 1))), alone);
    for (int c = 0; c < channels; ++c) {
        const Mask is_it = channel == Float(float(c));
        const Float share = select(is_it, select(is_white, Float(float(channels)), Float(1)), Float(0));
        throughput.c[c] = select(splits, throughput.c[c] * share, throughput.c[c]);
    }
    const Float spread = (material.ior - Float(1)) * Float(0.025f) * layers.dispersion;
    material.ior = select(splits, max(fma(channel - Float(1), spread, material.ior), Float(1)), material.ior);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
