// SPDX-License-Identifier: Apache-2.0
#include "materials/compile/inputs.h"

namespace fathom {

namespace {

/// Whether shadow rays pass the surface, which is thin glass without roughness. Surfaces with normal or bump maps are
/// excluded: a map would bend only the reflection, and is rare on such glass.
bool is_pane(const Material& m, const GlassRecord& record)
{
    return m.interior.thin && record.roughness == 0 && record.roughness_texture.texture == no_index &&
           m.normal_map.texture < 0 && m.bump.texture < 0;
}

/// Whether the surface refracts, reflects and colors nothing.
bool is_open_boundary(const Material& m)
{
    return !m.interior.thin && m.ior == 1 && is_white(m.transmission.color);
}

}  // namespace

/// Compiles glass, and principled materials that are only glass.
void compile_glass(Compiler&, const Material& m, MaterialRecord& t)
{
    t.closure = ClosureKind::glass;
    set_base_color(m.transmission.color, t);
    GlassRecord record;
    set_number(m.roughness, record.roughness, record.roughness_texture, t);
    record.ior = m.ior;
    record.flags = facet_flags(m);
    if (m.kind == MaterialKind::glass) {
        if (m.interior.thin) record.flags |= GlassRecord::sheet;
        set_reflection_color(m.specular.color, record, t);
    }
    t.set_parameters(record);
    t.features.add(MaterialFeature::pane, is_pane(m, record));
    t.features.add(MaterialFeature::index_matched_boundary, is_open_boundary(m));
}

}  // namespace fathom
