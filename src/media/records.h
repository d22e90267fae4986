#pragma once
/// Media as the kernel reads them.
#include <cstdint>
#include <vector>

#include "math/rgb.h"

namespace fathom {

/// What a solid is filled with.
struct MediumRecord {
    Rgb extinction{};      ///< what is absorbed or scattered, per unit of render space
    Rgb scattering{};      ///< of that, what is scattered
    float anisotropy = 0;  ///< mean cosine of what is scattered, see sample_phase
    /// Paths have extinction and scattering of their own, by textures where they came in: see
    /// PathPool::walk_extinction.
    std::uint32_t is_textured = 0;
    float ior = 1;               ///< index of refraction
    std::uint32_t priority = 0;  ///< where media overlap, the one with the greatest is there; above 0, below 2^31
    /// Light comes in without being refracted, like into fog: paths have lights sampled where they are scattered, and
    /// that is a bounce.
    std::uint32_t is_open = 0;
    std::uint32_t counts = 0;  ///< where there is a longest depth, each scattering is a bounce, too

    bool operator==(const MediumRecord&) const = default;
};

/// Mean free paths of subsurfaces are at least so long, in units of render space, where a scene is some 1000 large:
/// shorter ones look the same, but floats no longer tell the steps of a path apart.
constexpr float shortest_free_path = 1.0f / 512;

struct MediaTables {
    /// The first is empty space, which is everywhere, with a priority below all others.
    std::vector<MediumRecord> media = std::vector<MediumRecord>(1);
    static constexpr std::size_t max_media = 1u << 16;
};

}  // namespace fathom
