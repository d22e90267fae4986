// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "geometry/surface/surface_hit.h"
#include "textures/textures.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Tangent space of normal and anisotropy maps: tangent and bitangent of a surface, about its unperturbed normal.
struct TangentFrame {
    Vec3 tangent, bitangent, normal;
    Mask known;  ///< lanes whose surface has a tangent

    explicit TangentFrame(const Surface& s) : TangentFrame(s.ns, s.tangent, s.bitangent_sign) {}
    /// Tangent space of a map. In lanes with has_map_tangents the tangent follows the map's own texture coordinates,
    /// otherwise it is the surface's. texture: index for the lanes of m, or no_index.
    static TangentFrame of_map(const ShadingTables& tables, const Surface& s, UInt texture, Mask m)
    {
        const Mask own = m & s.has_map_tangents;
        if (none(own)) return TangentFrame(s);
        Vec3 tangent = s.tangent;
        Float sign = s.bitangent_sign;
        for_each_unique(own & (texture != UInt(no_index)), texture, [&](std::uint32_t index, Mask same) {
            const TextureRecord& t = tables.textures[index];
            Vec3 along_u, along_v;
            s.derivatives.gradients(t.uv_set ? 1 : 0, t.uv_map, along_u, along_v);
            const Mask known = same & (dot(along_u, along_u) > Float(0));
            tangent = select(known, along_u, tangent);
            // Green of a normal map points up in the image, against v.
            sign = select(known, copysign(Float(1), -dot(cross(s.ns, along_u), along_v)), sign);
        });
        return TangentFrame(s.ns, tangent, sign);
    }
    /// The normal that a texel of a normal map gives, for the lanes of m; the unperturbed normal in other lanes.
    Vec3 bend(const Texel& t, Float scale, Mask m) const
    {
        const Float x = fma(t.c[0], Float(2), Float(-1)) * scale, y = fma(t.c[1], Float(2), Float(-1)) * scale,
                    z = fma(t.c[2], Float(2), Float(-1));
        const Vec3 bent = fma(tangent, x, fma(bitangent, y, normal * z));
        const Mask use = m & known & (dot(bent, bent) > Float(1e-12f));
        return select(use, normalize(bent), normal);
    }

private:
    TangentFrame(const Vec3& ns, const Vec3& along_u, Float bitangent_sign) : normal(ns)
    {
        // Gram-Schmidt orthogonalization: the tangent may not be perpendicular to the interpolated normal.
        const Vec3 raw = along_u - ns * dot(along_u, ns);
        known = dot(raw, raw) > Float(1e-20f);
        tangent = normalize(select(known, raw, Vec3(Float(1), Float(0), Float(0))));
        bitangent = cross(ns, tangent) * bitangent_sign;
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
