// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/tables.h"
#include "materials/closures/closure.h"
#include "materials/read/tangent_frame.h"
#include "textures/record_inputs.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Reads the parameters of DisneyBsdf and applies their textures.
///
/// s      the surface, before its normal map is applied
/// index  index into ShadingTables::disney, for the lanes of m
inline void read_disney(const SceneTables& tables, const Surface& s, UInt index, Mask m, DisneyPoint& p)
{
    RecordInputs<DisneyRecord> inputs(tables, tables.disney, s.at, index, m);
    const UInt features = inputs.get(&DisneyRecord::features);
    const auto have = [&](std::uint32_t feature) { return any(m & ((features & UInt(feature)) != UInt(0))); };
    inputs.set_textured(have(DisneyRecord::textured));
    p.anisotropy = inputs.number(&DisneyRecord::anisotropy), p.flatness = inputs.number(&DisneyRecord::flatness);
    p.specular_tint = inputs.number(&DisneyRecord::specular_tint);
    p.sheen = inputs.number(&DisneyRecord::sheen), p.sheen_tint = inputs.number(&DisneyRecord::sheen_tint);
    p.coat = inputs.number(&DisneyRecord::coat), p.coat_gloss = inputs.number(&DisneyRecord::coat_gloss);
    p.transmission = inputs.number(&DisneyRecord::transmission);
    p.diffuse_transmission = inputs.number(&DisneyRecord::diffuse_transmission);
    p.tangent = Vec3(Float(0), Float(0), Float(0));
    if (have(DisneyRecord::anisotropic)) p.tangent = TangentFrame(s).tangent;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
