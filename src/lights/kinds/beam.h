// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/kinds/kind.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Parallel light from a flat area, along its normal. The record's edges go from the center to the sides of a
/// parallelogram, or are the conjugate half-axes of an ellipse where `radius` is 1.
struct BeamLight {
    static constexpr LightRecordKind kind = LightRecordKind::beam;

    template <class Light>
    static LightPoint sample(const Light& light, Vec3 p, Float, Sample2, Mask)
    {
        const Vec3 u = light.edge_u(), v = light.edge_v(), n = light.normal(), from = p - light.position();
        // The point is lit if its projection onto the area's plane, x u + y v from the center, is inside the area.
        const Vec3 across_v = cross(v, n), across_u = cross(n, u);
        const Float x = dot(from, across_v) / dot(u, across_v), y = dot(from, across_u) / dot(v, across_u);
        const Mask in_ellipse = fma(x, x, y * y) <= Float(1), in_parallelogram = max(abs(x), abs(y)) <= Float(1);
        const Mask is_round = light.radius() > Float(0);
        const Float distance = dot(from, n);
        const Mask arrives = (distance > Float(0)) & ((is_round & in_ellipse) | (!is_round & in_parallelogram));
        return {-n, max(distance, Float(0)), select(arrives, Float(1), Float(0)), Float(1), Float(1), Mask(true)};
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
