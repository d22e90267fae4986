// SPDX-License-Identifier: Apache-2.0
#include "materials/compile/inputs.h"
#include "materials/compile/layers.h"
#include "materials/compile/principled_record.h"

namespace fathom {

namespace {

/// Features that glass and principled closures support; any other feature needs a layered closure.
constexpr std::uint32_t plain = LayersRecord::energy_compensation | LayersRecord::with_transmission;

/// Returns the simplest closure that supports every feature of a principled material.
ClosureKind closure_of_principled(const Material& m)
{
    const std::uint32_t features = layer_features(m);
    const bool is_plain = (features & ~plain) == 0 && is_one(m.specular.weight) && is_white(m.specular.color) &&
                          is_white(m.conductor.edge_color);
    const bool is_metal = is_positive(m.metallic);
    if (is_plain && is_one(m.transmission.weight) && !is_metal) return ClosureKind::glass;
    if (features &
        (LayersRecord::with_transmission | LayersRecord::with_diffuse_transmission | LayersRecord::with_subsurface))
        return ClosureKind::layered_transmitting;
    return is_plain ? ClosureKind::principled : ClosureKind::layered;
}

}  // namespace

void compile_principled(Compiler& c, const Material& m, MaterialRecord& t)
{
    t.closure = closure_of_principled(m);
    if (t.closure == ClosureKind::glass) return compile_glass(c, m, t);
    PrincipledRecord record = principled_record(m, t);
    if (t.closure != ClosureKind::principled) record.table = add_layers(c, m, t);
    t.set_parameters(record);
}

}  // namespace fathom
