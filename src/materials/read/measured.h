// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/tables.h"
#include "materials/closures/closure.h"
#include "materials/read/tangent_frame.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Locates the tables of measured surfaces, and the tangent of anisotropic ones.
///
/// s      the surface, before its normal map is applied
/// index  index into ShadingTables::measured, for the lanes of m, at least one of which is active; other lanes get a
/// valid index, too
inline void read_measured(const SceneTables& tables, const Surface& s, UInt index, Mask m, MeasuredPoint& p)
{
    constexpr int words = int(sizeof(MeasuredRecord) / 4);
    const RecordRow<MeasuredRecord, words> row(tables.measured, index, m);
    p.values = tables.measured_values.data();
    p.theta = row.get(&MeasuredRecord::theta), p.theta_count = row.get(&MeasuredRecord::theta_count);
    p.phi = row.get(&MeasuredRecord::phi), p.phi_count = row.get(&MeasuredRecord::phi_count);
    p.symmetry = row.get(&MeasuredRecord::symmetry);
    p.color_is_per_facet = row.get(&MeasuredRecord::color_is_per_facet) != UInt(0u);
    const auto table = [&](MeasuredTableRecord MeasuredRecord::* member) {
        const std::size_t at = detail::word_of(member);
        return MeasuredTablePoint{float_bits(row.word[at]), float_bits(row.word[at + 1]), float_bits(row.word[at + 2])};
    };
    p.ndf = table(&MeasuredRecord::ndf), p.sigma = table(&MeasuredRecord::sigma);
    p.vndf = table(&MeasuredRecord::vndf), p.luminance = table(&MeasuredRecord::luminance);
    p.color = table(&MeasuredRecord::color);
    p.has_phis = any(m & (p.phi_count != UInt(1u)));
    p.tangent = Vec3(Float(0), Float(0), Float(0));
    const Mask anisotropic = m & less(UInt(2u), p.phi_count);
    if (any(anisotropic)) p.tangent = select(anisotropic, TangentFrame(s).tangent, p.tangent);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
