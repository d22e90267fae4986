// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "geometry/records.h"
#include "math/vec3.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Position in a triangle in each lane: its vertices, and the weights of the second and third vertex.
struct TrianglePlace {
    UInt vertex[3];
    Float u, v;

    /// Interpolates an attribute of n numbers per vertex. base: address of the attribute of vertex 0.
    template <int n>
    void numbers(const float* base, Mask m, Float (&to)[n]) const
    {
        Float at[3][n];
        for (int k = 0; k < 3; ++k) gather_row(base, vertex[k] * UInt(std::uint32_t(n)), m, at[k]);
        for (int i = 0; i < n; ++i) to[i] = fma(at[0][i], Float(1) - u - v, fma(at[1][i], u, at[2][i] * v));
    }
    /// Interpolates texture coordinates; lanes outside m keep their values.
    void read_uv(const LargeVector<Vec2f>& table, Mask m, Float& to_u, Float& to_v) const
    {
        if (none(m)) return;
        Float uv[2];
        numbers(reinterpret_cast<const float*>(table.data()), m, uv);
        to_u = select(m, uv[0], to_u);
        to_v = select(m, uv[1], to_v);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
