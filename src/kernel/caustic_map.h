// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Photon maps of caustics: where light paths arrive by mirrors and smooth glass alone. Camera paths that light tracing
/// cannot be connected to gather them: see docs/design/light-tracing.md.
#include <cstdint>
#include <vector>

#include "fathom/vector.h"

namespace fathom {

/// Arrival of a light path at a surface. Lanes read it as 16 words.
struct CausticPhoton {
    Vec3f position;
    Vec3f to_light;              ///< unit direction from which the light came
    Vec3f normal;                ///< geometric normal of the surface, on either side
    Vec3f power;                 ///< flux of the linear Rec.709 channels
    std::uint32_t sample, path;  ///< sample index, and number of the light path there
    std::uint32_t bounces;       ///< surfaces that the light has met before
    std::uint32_t unused = 0;
};
static_assert(sizeof(CausticPhoton) == 16 * sizeof(float));

/// Bucket, before masking, of a cell of the grid: the coordinates are the bits of whole floats.
template <class U>
U caustic_cell_hash(U x, U y, U z, U sample)
{
    U h = sample * U(0x9e3779b1u);
    for (const U& part : {x, y, z}) {
        h = (h ^ part) * U(0x85ebca6bu);
        h = h ^ (h >> 15);
    }
    h = h * U(0xc2b2ae35u);
    return h ^ (h >> 16);
}

/// The photons of some samples in a hash grid, whose cells are as wide as the photons of their sample reach: 2 radii.
struct CausticMap {
    std::uint32_t first_sample = 0;
    std::vector<float> radii;            ///< by sample index, from first_sample on
    std::vector<CausticPhoton> photons;  ///< by bucket; within one by sample, path and bounces
    std::vector<std::uint32_t> buckets;  ///< first photon of each bucket, and the number of photons
    std::uint32_t bucket_mask = 0;       ///< number of buckets - 1; a power of two - 1
};

}  // namespace fathom
