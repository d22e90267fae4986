// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Compilation of layered and Disney materials to the kernel's records.
#include "fathom/description.h"
#include "materials/records.h"

namespace fathom {

inline Rgb spectrum(Color c)
{
    return {c.r, c.g, c.b};
}
inline std::uint32_t texture_id(int index)
{
    return index < 0 ? no_index : std::uint32_t(index);
}

/// The simplest closure that supports every feature a principled material uses.
ClosureKind closure_of_layers(const Material& m);

/// render_scale: factor from scene units to those of render space, applied to lengths
LayersRecord compile_layers(const Material& m, double render_scale);

/// disney_transmitting if any light can pass, else disney.
ClosureKind closure_of_disney(const Material& m);
DisneyRecord compile_disney(const Material& m);

/// Fraction of the light that a smooth boundary of index ior reflects internally which a gray layer absorbs on the way
/// up and down. The light below the layer is diffuse.
double internal_absorption(double ior, double optical_thickness);

}  // namespace fathom
