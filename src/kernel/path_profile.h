// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Records of a profile: what paths contribute and cost, with the place that each part is charged to.
#include <cstdint>
#include <vector>

#include "base/no_index.h"

namespace fathom {

/// How a path is scattered at a vertex, in the terms of light path expressions.
enum class PathEvent : std::uint32_t {
    none,
    diffuse,      ///< reflected or transmitted by a broad lobe
    glossy,       ///< reflected by a narrow lobe
    mirror,       ///< reflected by a delta lobe
    refraction,   ///< transmitted by a delta lobe
    translucent,  ///< transmitted by a narrow lobe
    volume        ///< scattered within a medium
};
/// Letters of PathEvent in the words of paths.
inline constexpr char path_event_letters[] = {'?', 'D', 'G', 'S', 'T', 'F', 'V'};

/// Events of a path since the camera, four bits each, the last one in the lowest bits. Of more than four events, the
/// first and the last two are kept.
using PathWord = std::uint32_t;
inline constexpr std::uint32_t path_word_events = 4;
/// Flag of words that lack events after the second.
inline constexpr PathWord path_word_gap = 1u << 16;

inline PathWord append_event(PathWord word, PathEvent event)
{
    const bool is_full = (word >> 12 & 15) != 0;
    if (!is_full) return word << 4 | PathWord(event);
    return path_word_gap | (word & 0xff00) | (word & 15) << 4 | PathWord(event);
}

/// A vertex from which a path looks for light, by light samples or by the ray that leaves it.
struct PathPlace {
    std::uint32_t material = no_index, object = no_index;  ///< of the surface; no_index: the camera
    std::uint32_t depth = 0;                               ///< number of scattering events, this one included
    PathWord word = 0;                                     ///< their kinds
};

/// Light that a path found.
struct PathContribution {
    std::uint32_t path = 0;            ///< number in the job
    bool is_sampled = false;           ///< by next event estimation; otherwise a ray met the emission
    std::uint32_t light = no_index;    ///< sampled: number of the light
    std::uint32_t emitter = no_index;  ///< met: object_id of the surface; no_index: the environment or background
    PathPlace place;
    float value[3] = {};
};

/// Work for a vertex: its shading, its shadow ray, and the ray that leaves it.
struct PathCost {
    std::uint32_t path = 0;
    std::uint32_t light = no_index;  ///< light that the shadow ray leads to
    PathPlace place;
    std::uint32_t rays = 0, shadow_rays = 0;
    float nanoseconds = 0, shadow_nanoseconds = 0;  ///< of all, and of the shadow ray alone
};

/// Records of the paths of a job.
struct PathProfile {
    std::vector<PathContribution> contributions;
    std::vector<PathCost> costs;
};

}  // namespace fathom
