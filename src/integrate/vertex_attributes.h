#pragma once
#include "geometry/records.h"
#include "math/vec3.h"

namespace fathom::inline FATHOM_LANES {

/// Where in a triangle each lane is: its corners' vertices, and the weights of the second and the third.
struct TrianglePlace {
    UInt vertex[3];
    Float u, v;

    /// One number of the vertices, interpolated. base: of vertex 0; log2_size: of the numbers that a vertex has.
    Float number(const float* base, int log2_size, Mask m) const
    {
        const auto at = [&](int k) { return gather(base, vertex[k] << log2_size, m); };
        return fma(at(0), Float(1) - u - v, fma(at(1), u, at(2) * v));
    }
    /// Both numbers of a set of texture coordinates; other lanes keep theirs.
    void read_uv(const std::vector<Vec2f>& table, Mask m, Float& to_u, Float& to_v) const
    {
        if (none(m)) return;
        const auto* base = reinterpret_cast<const float*>(table.data());
        to_u = select(m, number(base, 1, m), to_u);
        to_v = select(m, number(base + 1, 1, m), to_v);
    }
};

}  // namespace fathom::inline FATHOM_LANES
