#pragma once
#include "materials/read/material.h"
#include "media/stack.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// The boundaries of solids as paths meet them, or shadow rays, that are in the media of a stack.
struct SolidBoundary {
    Mask solid;  ///< the material has an inside
    Mask below;  ///< met from within its subsurface
    MediumBoundary media;
    Mask skips_interface;  ///< light goes straight on, as if nothing were there
};

/// inside: met from behind the geometric normal. For the lanes of m; those that are not solid have nothing in media.
inline SolidBoundary solid_boundary(const MaterialReader& materials, UInt material, const MediumStack& media,
                                    Mask inside, Mask m)
{
    const auto get = [&](auto member, Mask lanes_of) { return materials.get(member, material, lanes_of); };
    const UInt medium = get(&MaterialRecord::medium, m);
    const Mask solid = m & (medium != UInt(0u));
    const UInt subsurface = get(&MaterialRecord::subsurface_medium, solid), flags = get(&MaterialRecord::flags, solid);
    const auto has = [&](std::uint32_t flag) { return (flags & UInt(flag)) != UInt(0u); };
    const Mask below = solid & inside & media.contains(subsurface);
    const MediumBoundary boundary(materials.tables(), media, select(below, subsurface, medium), !inside, solid);
    const Mask is_nothing = has(MaterialRecord::open_boundary) & (boundary.other_ior == Float(1));
    const Mask skips_interface = solid & !has(MaterialRecord::thin) & (!boundary.is_there | is_nothing);
    return {solid, below, boundary, skips_interface};
}

/// What shadow rays pass, and paths without being turned.
struct SeenThrough {
    Mask pane;       ///< but for what it mirrors
    Mask open;       ///< the boundary of an open medium
    Mask no_bounce;  ///< of both: to pass is none
};

/// skips_interface: see SolidBoundary. For the lanes of m, which don't meet their material by chance.
inline SeenThrough seen_through(const LaneScene& scene, const MaterialReader& materials, UInt material,
                                Mask skips_interface, Mask m)
{
    const UInt flags = materials.get(&MaterialRecord::flags, material, m);
    const auto has = [&](std::uint32_t flag) { return m & ((flags & UInt(flag)) != UInt(0u)); };
    const Mask pane = has(MaterialRecord::pane), open = has(MaterialRecord::open_boundary) & skips_interface;
    Mask no_bounce = open;
    // Where light comes into something, what scatters it there is the bounce.
    if (scene.open_media) no_bounce |= pane & (materials.get(&MaterialRecord::medium, material, pane) != UInt(0u));
    return {pane, open, no_bounce};
}

}  // namespace FATHOM_LANES
}  // namespace fathom
