#pragma once
#include "kernel/lane_scene.h"
#include "kernel/pool.h"
#include "media/distance.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Of the lanes of m, those that are in a medium with textures and came in by a surface that has them; a path that
/// began inside did not.
inline Mask has_own_medium(const LaneScene& scene, const PathPool& p, std::size_t i, UInt medium, Mask m)
{
    return m & (p.walk_extinction.c[0].load(i) >= Float(0)) &
           (gather(scene.tables.media, &MediumRecord::is_textured, medium, m) != UInt(0u));
}

/// What is lost per unit of way in the medium, as the paths from number i on have come into it.
inline Spectrum extinction_of(const LaneScene& scene, const PathPool& p, std::size_t i, UInt medium, Mask m)
{
    const Spectrum extinction = gather(scene.tables.media, &MediumRecord::extinction, medium, m);
    if (!scene.textured_media) return extinction;
    return select(has_own_medium(scene, p, i, medium, m), p.walk_extinction.load(i), extinction);
}

/// Of that, what is scattered.
inline Spectrum scattering_of(const LaneScene& scene, const PathPool& p, std::size_t i, UInt medium, Mask m)
{
    const Spectrum scattering = gather(scene.tables.media, &MediumRecord::scattering, medium, m);
    if (!scene.textured_media) return scattering;
    return select(has_own_medium(scene, p, i, medium, m), p.walk_extinction.load(i) * p.walk_albedo.load(i),
                  scattering);
}

/// Paths from number i on have come into nothing yet.
inline void forget_medium(PathPool& p, std::size_t i)
{
    p.walk_extinction.store(i, Spectrum(Float(-1)));
    p.walk_albedo.store(i, Spectrum(Float(0)));
}

}  // namespace FATHOM_LANES
}  // namespace fathom
