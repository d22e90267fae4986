#pragma once
#include "kernel/camera_paths.h"
#include "materials/closures/closure.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Where a surface refracts each colour its own way, a path follows one: red, green or blue by chance, which then
/// carries three times as much, or the one that it has followed so far. The index is the channel's, at the wavelengths
/// between which KHR_materials_dispersion spreads it.
inline void choose_channel(const SampleKey& key, UInt seed, LayeredMaterialPoint& material, Spectrum& throughput)
{
    const LayersPoint& layers = material.layers;
    if (!layers.has(LayersRecord::disperses)) return;
    const Mask splits = (layers.dispersion > Float(0)) & (layers.transmission > Float(0));
    const Float pick = sample_hash(key, pair_seed(seed, pair_channel)) * Float(float(channels));
    // The channel that is there alone, or else the picked one.
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
