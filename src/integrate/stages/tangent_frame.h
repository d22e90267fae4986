#pragma once
#include "integrate/stages/surface_hit.h"
#include "shading/textures/textures.h"

namespace fathom::inline FATHOM_LANES {

/// What directions in textures refer to: tangent and bitangent of a surface, about its normal as it is before maps.
struct TangentFrame {
    Vec3 tangent, bitangent, normal;
    Mask known;  ///< where the surface has a tangent

    explicit TangentFrame(const Surface& s) : normal(s.ns)
    {
        // Gram-Schmidt: the tangent may not be perpendicular to the interpolated normal.
        const Vec3 raw = s.tangent - s.ns * dot(s.tangent, s.ns);
        known = dot(raw, raw) > Float(1e-20f);
        tangent = normalize(select(known, raw, Vec3(Float(1), Float(0), Float(0))));
        bitangent = cross(s.ns, tangent) * s.bitangent_sign;
    }
    /// The normal bent as a texel of a normal map says, for the lanes of m.
    Vec3 bend(const Texel& t, Float scale, Mask m) const
    {
        const Float x = fma(t.c[0], Float(2), Float(-1)) * scale, y = fma(t.c[1], Float(2), Float(-1)) * scale,
                    z = fma(t.c[2], Float(2), Float(-1));
        const Vec3 bent = fma(tangent, x, fma(bitangent, y, normal * z));
        const Mask use = m & known & (dot(bent, bent) > Float(1e-12f));
        return select(use, normalize(bent), normal);
    }
};

}  // namespace fathom::inline FATHOM_LANES
