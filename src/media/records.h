// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Media as the kernel reads them.
#include <cstdint>
#include <vector>

#include "math/rgb.h"

namespace fathom {

/// The medium inside a solid.
struct MediumRecord {
    Rgb extinction{};      ///< absorption plus scattering coefficient, per unit of render space
    Rgb scattering{};      ///< scattering coefficient, per unit of render space
    float anisotropy = 0;  ///< mean cosine of the phase function, see sample_phase
    /// Extinction and scattering are evaluated from textures where a path enters, and kept per path: see
    /// PathPool::walk_extinction.
    std::uint32_t is_textured = 0;
    float ior = 1;  ///< index of refraction
    std::uint32_t priority =
        0;  ///< where media overlap, the one of highest priority applies (nested dielectrics); above 0 and below 2^31
    /// Index-matched medium, such as fog: light enters without refraction. Next event estimation is done at scattering
    /// events, which count as bounces.
    std::uint32_t is_index_matched = 0;
    std::uint32_t counts = 0;  ///< scattering events count as bounces against the maximum depth

    bool operator==(const MediumRecord&) const = default;
};

/// Minimum mean free path of subsurface media in render space, where a scene has a radius of 512 to 1024. Shorter ones
/// look the same, but steps of that size vanish in float.
constexpr float min_mean_free_path = 1.0f / 512;

/// All media of a scene.
struct MediaTables {
    /// Entry 0 is empty space, which surrounds all solids and has the lowest priority.
    std::vector<MediumRecord> media = std::vector<MediumRecord>(1);
    static constexpr std::size_t max_media = 1u << 16;
};

}  // namespace fathom
