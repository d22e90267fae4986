// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "geometry/surface/surface_derivatives.h"
#include "math/spectrum.h"
#include "textures/node.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// A hit in each lane, and the ray that caused it.
struct SurfaceHit {
    Vec3 o, d;
    Float t, u, v, time;
    UInt primitive, instance;
    UInt material = UInt(no_index);  ///< material that a mixture chose; no_index: that of the shape
};

/// Surface properties at a hit, in render space.
struct Surface {
    Vec3 p;
    Vec3 ng;               ///< unit geometric normal, on the front side of the shape
    Vec3 ns;               ///< unit shading normal, on the same side
    Vec3 tangent;          ///< along increasing u; zero if unknown
    Float bitangent_sign;  ///< side of cross(ns, tangent) to which green in normal maps points (up in the image)
    Float offset;          ///< distance along ng at which rays leave the surface: see rounding_along
    Mask is_curve, is_ribbon;
    Float radius;  ///< radius of curves; otherwise 0
    TexturePoint at;
    SurfaceDerivatives derivatives;  ///< valid only with Feature::surface_derivatives
    Mask has_mesh_tangent;           ///< the mesh provides the tangent
    Mask has_map_tangents;           ///< tangents follow each map's texture coordinates: see TangentFrame::of_map
    UInt shape, material;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
