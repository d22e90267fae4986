// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Scattering of light paths. A light path multiplies by the BSDF that the path tracer sees from the other end, with
/// the cosines of the geometric normal: Veach 1997, section 5.3, whose correction for shading normals follows from
/// that.
#include "integrate/stages/scatter.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Factor of f_cos(out, light), the path tracer's BSDF times the cosine toward the light. d: direction in which the
/// light arrives; out: in which it leaves, sampled with density pdf.
inline Float adjoint_factor(const Vec3& ng, const Vec3& d, const Vec3& out, Float pdf)
{
    return abs(dot(out, ng)) / (max(abs(dot(d, ng)), Float(1e-20f)) * max(pdf, Float(1e-30f)));
}

/// Factor of the path tracer's weight of a delta lobe. Refraction does not scale the power of light as it does radiance
/// (Veach 1997, section 5.2), and the shading normal's cosines are exchanged for those of the geometric normal.
inline Float delta_adjoint_factor(const Vec3& ng, const Vec3& ns, const Vec3& d, const Scattered& next)
{
    const Float shading = abs(dot(d, ns)) / max(abs(dot(next.wi, ns)), Float(1e-20f));
    const Float geometric = abs(dot(next.wi, ng)) / max(abs(dot(d, ng)), Float(1e-20f));
    return next.eta * next.eta * shading * geometric;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
