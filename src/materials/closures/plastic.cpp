// SPDX-License-Identifier: Apache-2.0
#include "materials/compile/fresnel.h"
#include "materials/compile/inputs.h"

namespace fathom {

namespace {

/// Fraction of the light that a smooth boundary of index ior reflects internally which a gray layer absorbs on the way
/// up and down. The light below the layer is diffuse.
double internal_absorption(double ior, double optical_thickness)
{
    if (!(optical_thickness > 0)) return 0;
    constexpr int steps = 2048;
    double all = 0, left = 0;
    for (int i = 0; i < steps; ++i) {
        const double cosine = (i + 0.5) / steps, sine2 = (1 - cosine * cosine) * ior * ior;
        const double sent_back = sine2 < 1 ? fresnel(std::sqrt(1 - sine2), ior) : 1;
        all += sent_back * cosine;
        left += sent_back * cosine * std::exp(-2 * optical_thickness / cosine);
    }
    return 1 - left / all;
}

}  // namespace

void compile_plastic(Compiler&, const Material& m, MaterialRecord& t)
{
    PlasticRecord record;
    set_number(m.roughness, record.roughness, record.roughness_texture, t);
    record.ior = m.ior;
    record.optical_thickness = m.plastic.optical_thickness;
    record.internal_absorption = float(internal_absorption(std::max(m.ior, 1.001f), m.plastic.optical_thickness));
    if (m.plastic.inner_reflectance >= 0) record.internal_absorption = -std::max(m.plastic.inner_reflectance, 1e-6f);
    record.flags = facet_flags(m);
    if (m.plastic.nonlinear) record.flags |= PlasticRecord::nonlinear;
    set_reflection_color(m.specular.color, record, t);
    t.set_parameters(record);
}

}  // namespace fathom
