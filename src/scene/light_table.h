// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "scene/parameters.h"

namespace fathom {

/// A unit of `intensity` in scene files.
struct LightUnit {
    const char* name;
    double factor = 1;            ///< the unit in the unit of Light::intensity; if is_radiometric, per lumen in a watt
    bool is_radiometric = false;  ///< the unit is watts instead of lumens
    bool is_flux = false;         ///< sets Light::intensity_is_flux
};

/// Keys of a kind of light, besides its parameters, and the texts that describe them.
struct LightKindInfo {
    KindName<LightKind> kind;
    std::span<const LightUnit> units;  ///< units of `intensity`; the first one is the default
    const char* unit_meaning;          ///< meaning of `intensity`, for the schema
    bool has_position = true;
    const char* direction_meaning =
        nullptr;  ///< meaning of `direction`, for the schema; nullptr if the kind has no direction
    const char* up_meaning =
        nullptr;  ///< meaning of `up`, for the schema; nullptr if rotation about the direction has no effect
    const char* image_meaning = nullptr;  ///< meaning of `image`, for the schema; nullptr if the kind has no image
    bool needs_image = false;
    bool up_needs_image = false;  ///< whether `up` is allowed only with an image
};

/// All kinds, in the order of LightKind. Their parameters are those of light_parameters(); reading, writing and
/// checking of scene files, their schema and the digest of scenes follow from both tables.
std::span<const LightKindInfo> light_kinds();
std::span<const Parameter<Light>> light_parameters();

inline const LightKindInfo& info_of(LightKind kind)
{
    return light_kinds()[std::size_t(kind)];
}

}  // namespace fathom
