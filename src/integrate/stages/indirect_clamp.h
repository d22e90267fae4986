// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/pool.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Scale that KernelSettings::clamp_indirect imposes on a contribution of a path. Contributions by two or more surfaces
/// share a budget: the largest channel of their sum stays within the limit. Exactly 1 for all other light.
///
/// surfaces: number of surfaces that scattered the light on its way to the camera.
inline float indirect_scale(PathPool& paths, std::size_t path, std::uint32_t surfaces, const float (&light)[channels])
{
    if (surfaces < 2) return 1;
    float largest = 0;
    for (const float c : light) largest = c > largest ? c : largest;
    float& left = paths.indirect_left[path];
    const float scale = largest > left ? left / largest : 1;
    left = largest > left ? 0 : left - largest;
    return scale;
}

/// Scale for the paths of the lanes of m, one by one: clamping is rare, so speed matters little.
[[gnu::noinline]] inline Float indirect_scale(PathPool& paths, UInt path, UInt surfaces, Spectrum light, Mask m)
{
    std::uint32_t paths_of[lanes], surfaces_of[lanes];
    float values[channels][lanes], scales[lanes];
    store(paths_of, path), store(surfaces_of, surfaces), store(scales, Float(1));
    for (int c = 0; c < channels; ++c) store(values[c], light.c[c]);
    for_each_active(m, [&](int lane) {
        float one[channels];
        for (int c = 0; c < channels; ++c) one[c] = values[c][lane];
        scales[lane] = indirect_scale(paths, paths_of[lane], surfaces_of[lane], one);
    });
    return load(scales);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
