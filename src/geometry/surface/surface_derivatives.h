// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "base/large_memory.h"
#include "math/vec3.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Two vectors along a surface, and the change of texture coordinates along each, for the slopes of textures.
struct SurfaceDerivatives {
    Vec3 way[2];               ///< 0 where unknown
    Float du[2][2], dv[2][2];  ///< change of u and v by vector and texture coordinate set

    /// Tangential directions dp/du and dp/dv of a texture, up to positive factors; both 0 where unknown. uv_map: rows
    /// of the affine map from the coordinates of the set to those of the texture.
    void gradients(std::size_t set, const std::array<float, 6>& uv_map, Vec3& along_u, Vec3& along_v) const
    {
        Float u[2], v[2];
        for (std::size_t k = 0; k < 2; ++k) {
            u[k] = fma(du[k][set], Float(uv_map[0]), dv[k][set] * Float(uv_map[1]));
            v[k] = fma(du[k][set], Float(uv_map[3]), dv[k][set] * Float(uv_map[4]));
        }
        const Float det = fma(u[0], v[1], -(u[1] * v[0]));
        const Mask known = det != Float(0);
        const Vec3 none(Float(0), Float(0), Float(0));
        along_u = select(known, flip_sign(way[0] * v[1] - way[1] * v[0], det), none);
        along_v = select(known, flip_sign(way[1] * u[0] - way[0] * u[1], det), none);
    }
    /// Marks the derivatives as unknown.
    void clear()
    {
        for (int k = 0; k < 2; ++k) {
            way[k] = Vec3(Float(0), Float(0), Float(0));
            for (int set = 0; set < 2; ++set) du[k][set] = dv[k][set] = Float(0);
        }
    }
    /// Sets dp/du and dp/dv, for primitives whose two texture coordinate sets are equal.
    void set(const Vec3& along_u, const Vec3& along_v, Mask m)
    {
        set_edges(along_u, along_v, m);
        for (int set = 0; set < 2; ++set) {
            du[0][set] = select(m, Float(1), du[0][set]);
            dv[1][set] = select(m, Float(1), dv[1][set]);
        }
    }
    /// For triangles: sets the first two edges, along which read_uv() takes the change of texture coordinates.
    void set_edges(const Vec3& a, const Vec3& b, Mask m)
    {
        way[0] = select(m, a, way[0]);
        way[1] = select(m, b, way[1]);
    }
    /// Sets the change of texture coordinates of one set along both edges of triangles with these vertices.
    void read_uv(const LargeVector<Vec2f>& table, const UInt* vertex, int set, Mask m)
    {
        if (none(m)) return;
        const auto* base = reinterpret_cast<const float*>(table.data());
        Float uv[3][2];
        for (int k = 0; k < 3; ++k) gather_row(base, vertex[k] << 1, m, uv[k]);
        for (int k = 0; k < 2; ++k) {
            du[k][set] = select(m, uv[k + 1][0] - uv[0][0], du[k][set]);
            dv[k][set] = select(m, uv[k + 1][1] - uv[0][1], dv[k][set]);
        }
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
