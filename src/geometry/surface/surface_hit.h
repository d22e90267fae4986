#pragma once
#include "geometry/surface/surface_derivatives.h"
#include "math/spectrum.h"
#include "textures/node.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// A hit of each lane, and the ray that made it.
struct SurfaceHit {
    Vec3 o, d;
    Float t, u, v, time;
    UInt primitive, instance;
    UInt material = UInt(no_index);  ///< of a mixture, which one the path meets; else the shape's
};

struct Surface {
    Vec3 p;
    Vec3 ng;               ///< geometric normal, unit, on the side of the shape's front
    Vec3 ns;               ///< shading normal, on the same side
    Vec3 tangent;          ///< along growing u; zero where unknown
    Float bitangent_sign;  ///< on which side of cross(ns, tangent) green of normal maps points: up in the image
    Float offset;          ///< rays that leave the surface begin so far off it, along ng: see rounding_along
    Mask is_curve, is_ribbon;
    Float radius;  ///< of curves, else 0
    TexturePoint at;
    SurfaceDerivatives ways;  ///< where LaneScene::wants_uv_slopes
    Mask has_mesh_tangent;    ///< the mesh brings the tangent
    Mask has_map_tangents;    ///< tangents are those of each map's texture coordinates: see TangentFrame::of_map
    UInt shape, material;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
