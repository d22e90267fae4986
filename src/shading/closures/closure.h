#pragma once
/// What surfaces do with light. Directions are in the frame of the shading normal, unit, pointing away from the
/// surface; wo.z > 0: frames are turned to the side that the path is on.
///
/// A closure is a class with
///     static constexpr MaterialKind kind     whose materials scatter so
///     static constexpr bool transmits        whether light passes to the other side
///     static constexpr bool is_glossy        whether most goes in or near the mirror direction, which shading normals
///                                            must not put below the surface then
///     explicit Closure(const MaterialPoint&)
///     BsdfEval eval(wo, wi)                  what part of the light from wi goes to wo, times the cosine, and the
///                                            density of sampling wi
///     BsdfSample sample(wo, u, u1)           a direction with its weight, f_cos / pdf
///     Mask has_smooth()                      lanes with anything but delta lobes, for which lights are sampled
/// Delta lobes have a weight, and neither f_cos nor pdf.
#include "fathom/description.h"
#include "sampling/warp.h"
#include "shading/spectrum.h"

namespace fathom::inline FATHOM_LANES {

struct BsdfEval {
    Spectrum f_cos;
    Float pdf;
};
struct BsdfSample {
    Vec3 wi;
    Spectrum weight;
    Float pdf;
    Mask is_delta;
    Float eta;  ///< index beyond over index before where the path is refracted, else 1
};

/// The parameters of a surface's material, textures applied.
struct MaterialPoint {
    Spectrum base_color;
    Float roughness, metallic, ior, fuzz;
    Mask entering;  ///< the path comes from the side of the geometric normal
    Mask thin;      ///< glass: a sheet without thickness
};

}  // namespace fathom::inline FATHOM_LANES
