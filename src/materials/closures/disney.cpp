// SPDX-License-Identifier: Apache-2.0
#include "compile/compiler.h"
#include "materials/compile/inputs.h"
#include "materials/compile/principled_record.h"

namespace fathom {

namespace {

/// disney_transmitting if any light can pass, else disney.
ClosureKind closure_of_disney(const Material& m)
{
    const bool passes =
        is_positive(m.transmission.weight) || (m.interior.thin && is_positive(m.diffuse_transmission.weight));
    return passes ? ClosureKind::disney_transmitting : ClosureKind::disney;
}

DisneyRecord disney_record(const Material& m)
{
    DisneyRecord t;
    t.anisotropy = number(m.microfacets.anisotropy), t.flatness = number(m.disney.flatness),
    t.specular_tint = number(m.disney.specular_tint);
    t.sheen = number(m.disney.sheen), t.sheen_tint = number(m.disney.sheen_tint);
    t.coat = number(m.coat.weight), t.coat_gloss = number(m.disney.coat_gloss);
    t.transmission = number(m.transmission.weight), t.diffuse_transmission = number(m.diffuse_transmission.weight);
    if (is_positive(m.microfacets.anisotropy)) t.features |= DisneyRecord::anisotropic;
    if (is_textured(t.anisotropy, t.flatness, t.specular_tint, t.sheen, t.sheen_tint, t.coat, t.coat_gloss,
                    t.transmission, t.diffuse_transmission))
        t.features |= DisneyRecord::textured;
    return t;
}

}  // namespace

void compile_disney(Compiler& c, const Material& m, MaterialRecord& t)
{
    t.closure = closure_of_disney(m);
    PrincipledRecord record = principled_record(m, t);
    record.table = std::uint32_t(c.tables.disney.size());
    t.set_parameters(record);
    c.tables.disney.push_back(disney_record(m));
    const std::uint32_t features = c.tables.disney.back().features;
    t.features.add(MaterialFeature::needs_tangent, (features & DisneyRecord::anisotropic) != 0);
    t.features.add(MaterialFeature::needs_uv, (features & DisneyRecord::textured) != 0);
}

}  // namespace fathom
