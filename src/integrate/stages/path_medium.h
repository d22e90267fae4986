// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/lane_scene.h"
#include "kernel/pool.h"
#include "media/distance.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Lanes of m whose coefficients come from textures: they are in a textured medium and entered it through a textured
/// surface. A path that began inside did not.
inline Mask has_own_medium(const LaneScene& scene, const PathPool& p, std::size_t i, UInt medium, Mask m)
{
    return m & (p.walk_extinction.c[0].load(i) >= Float(0)) &
           (gather(scene.tables.media, &MediumRecord::is_textured, medium, m) != UInt(0u));
}

/// Extinction coefficient of the medium per unit of distance, for the paths from number i on.
inline Spectrum extinction_of(const LaneScene& scene, const PathPool& p, std::size_t i, UInt medium, Mask m)
{
    const Spectrum extinction = gather(scene.tables.media, &MediumRecord::extinction, medium, m);
    if (!scene.has(Feature::textured_media)) return extinction;
    return select(has_own_medium(scene, p, i, medium, m), p.walk_extinction.load(i), extinction);
}

/// Scattering coefficient of the medium per unit of distance, for the paths from number i on.
inline Spectrum scattering_of(const LaneScene& scene, const PathPool& p, std::size_t i, UInt medium, Mask m)
{
    const Spectrum scattering = gather(scene.tables.media, &MediumRecord::scattering, medium, m);
    if (!scene.has(Feature::textured_media)) return scattering;
    return select(has_own_medium(scene, p, i, medium, m), p.walk_extinction.load(i) * p.walk_albedo.load(i),
                  scattering);
}

/// Marks the paths from number i on as having no textured coefficients.
inline void forget_medium(PathPool& p, std::size_t i)
{
    p.walk_extinction.store(i, Spectrum(Float(-1)));
    p.walk_albedo.store(i, Spectrum(Float(0)));
}

}  // namespace FATHOM_LANES
}  // namespace fathom
