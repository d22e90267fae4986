// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/records.h"
#include "math/lanes.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Features of the material of each lane.
struct LaneFeatures {
    UInt bits;

    Mask has(MaterialFeature feature) const { return (bits & UInt(MaterialFeatures(feature).bits)) != UInt(0u); }
    Mask has_all(MaterialFeatures features) const { return (bits & UInt(features.bits)) == UInt(features.bits); }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
