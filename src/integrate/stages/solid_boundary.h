// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/read/material.h"
#include "media/stack.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Boundary of a solid as seen by paths or shadow rays with a stack of media.
struct SolidBoundary {
    Mask solid;  ///< the material has an inside
    Mask below;  ///< hit from within its subsurface medium
    MediumBoundary media;
    Mask skips_interface;  ///< null interface: light passes undeflected
};

/// Finds the boundary in the lanes of m. inside: hit from behind the geometric normal. `media` is unspecified for lanes
/// that are not solid.
inline SolidBoundary solid_boundary(const MaterialReader& materials, UInt material, const MediumStack& media,
                                    Mask inside, Mask m)
{
    const auto get = [&](auto member, Mask lanes_of) { return materials.get(member, material, lanes_of); };
    const UInt medium = get(&MaterialRecord::medium, m);
    const Mask solid = m & (medium != UInt(0u));
    const UInt subsurface = get(&MaterialRecord::subsurface_medium, solid);
    const LaneFeatures features = materials.features(material, solid);
    const Mask below = solid & inside & media.contains(subsurface);
    const MediumBoundary boundary(materials.tables(), media, select(below, subsurface, medium), !inside, solid);
    const Mask is_nothing = features.has(MaterialFeature::index_matched_boundary) & (boundary.other_ior == Float(1));
    const Mask skips_interface = solid & !features.has(MaterialFeature::thin) & (!boundary.is_there | is_nothing);
    return {solid, below, boundary, skips_interface};
}

/// Surfaces that shadow rays pass, and that paths may pass undeflected.
struct PassedInterface {
    Mask pane;       ///< thin smooth glass, passed by the light it does not reflect
    Mask open;       ///< boundary of an index-matched medium
    Mask no_bounce;  ///< lanes for which passing the pane or boundary is not a bounce
};

/// Classifies surfaces in the lanes of m, whose material must not have been chosen by a mixture. skips_interface: see
/// SolidBoundary.
inline PassedInterface classify_interface(const LaneScene& scene, const MaterialReader& materials, UInt material,
                                          Mask skips_interface, Mask m)
{
    const LaneFeatures features = materials.features(material, m);
    const Mask pane = m & features.has(MaterialFeature::pane),
               open = m & features.has(MaterialFeature::index_matched_boundary) & skips_interface;
    Mask no_bounce = open;
    // A pane that encloses an index-matched medium counts no bounce: the scattering inside the medium does.
    if (scene.has(Feature::open_media))
        no_bounce |= pane & (materials.get(&MaterialRecord::medium, material, pane) != UInt(0u));
    return {pane, open, no_bounce};
}

}  // namespace FATHOM_LANES
}  // namespace fathom
