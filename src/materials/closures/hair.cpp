// SPDX-License-Identifier: Apache-2.0
#include "materials/compile/inputs.h"

namespace fathom {

namespace {

/// Absorption of a fiber over its radius by its pigments: d'Eon et al. 2011, "An Energy-Conserving Hair Reflectance
/// Model", 6.1.
Color melanin_absorption(float eumelanin, float pheomelanin)
{
    const float e = eumelanin, p = pheomelanin;
    return {0.419f * e + 0.187f * p, 0.697f * e + 0.4f * p, 1.37f * e + 1.05f * p};
}

/// Replaces the base color by the absorption if the material gives one.
void set_absorption(const Material& m, MaterialRecord& t)
{
    ColorInput absorbed = m.hair.absorption;
    if (!is_positive(absorbed)) absorbed = {melanin_absorption(m.hair.eumelanin, m.hair.pheomelanin), -1};
    if (!is_positive(absorbed)) return;
    t.features.add(MaterialFeature::absorbing_fiber);
    set_base_color(absorbed, t);
}

}  // namespace

void compile_hair(Compiler&, const Material& m, MaterialRecord& t)
{
    HairRecord record;
    set_number(m.hair.beta_m, record.beta_m, record.beta_m_texture, t);
    set_number(m.hair.beta_n, record.beta_n, record.beta_n_texture, t);
    record.ior = m.hair.ior;
    record.scale_tilt = float(m.hair.scale_tilt);
    t.set_parameters(record);
    t.features |= MaterialFeature::needs_tangent | MaterialFeature::needs_uv;
    set_absorption(m, t);
}

}  // namespace fathom
