#pragma once
#include "kernel/pool.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// What KernelSettings::clamp_indirect leaves of light that a path is to bring: of what came by two surfaces or more,
/// so much that the largest channel of all of it stays within the limit. 1, exactly, for all else.
///
/// surfaces: how many scattered the light on its way to the camera
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

/// The same for the paths of a mask's lanes. One by one: it runs only where it is asked for.
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
