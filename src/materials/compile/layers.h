#pragma once
/// Materials of layers and Disney's, as the kernel reads them.
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

/// The simplest closure that does all that a principled material asks for.
ClosureKind closure_of_layers(const Material& m);

/// render_scale: of render space, in whose units lengths are.
LayersRecord compile_layers(const Material& m, double render_scale);

ClosureKind closure_of_disney(const Material& m);
DisneyRecord compile_disney(const Material& m);

/// Of diffuse light that a smooth boundary of index ior sends back through a layer: what that absorbs on both ways.
double share_lost_within(double ior, double optical_thickness);

}  // namespace fathom
