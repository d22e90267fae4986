// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Multiple importance sampling between path tracing and light tracing, by the power heuristic over three techniques:
/// the path tracer hits the light (density a), samples it at the last vertex (b), or a light path is connected to the
/// camera at its end (c).
///
/// The weights only have to sum to 1 for every path, so they may use nominal densities. They leave out Russian
/// roulette, path guiding and the choice of channels, and assume that a closure samples in proportion to a function
/// q(wo, wi) that is the same in both directions, times the cosine. Diffuse surfaces and delta lobes do, and others
/// nearly. Then the densities of all vertices between the first surface, as seen from the camera, and the light cancel:
///
///     c / a = E / K,   K = (pixels per unit of area of the first surface) q(camera, next vertex)
///
/// where E is the number of light paths times the density of emission, divided by the cosine at the light. With b / a,
/// the ratio of the densities of both ways of the path tracer to find the light, V = 1 + (b / a)^2, or (b / a)^2 for
/// lights that rays do not hit. The weights are
///
///     of light tracing (E / K)^2 / (V + (E / K)^2),   of path tracing V / (V + (E / K)^2)
///
/// Veach 1997, chapters 8 and 9 (densities and power heuristic).
#include "math/lanes.h"
#include "math/vec3.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Weight of path tracing. connection: K, infinite for paths that light tracing cannot find; emission: E; variants: V,
/// any value if K is infinite.
inline Float path_tracing_weight(Float connection, Float emission, Float variants)
{
    const Float r = emission / max(connection, Float(1e-30f));
    return select(connection < Float(infinity), variants / fma(r, r, variants), Float(1));
}

/// The factor V / E^2 in the weight of light tracing, which a light path keeps from its first vertex on.
inline Float light_end(Float emission, Float variants)
{
    return variants / max(emission * emission, Float(1e-37f));
}
/// Weight of light tracing.
inline Float light_tracing_weight(Float connection, Float end)
{
    return Float(1) / fma(connection * connection, end, Float(1));
}

/// Factor of the density of light samples at the first surface of a path, in the weights. Their noise is far lower than
/// that of light paths of equal density, which come to a pixel by chance. Grittmann, Georgiev, Slusallek and Krivanek
/// 2019, "Variance-Aware Multiple Importance Sampling", estimate such factors.
inline constexpr float trust_in_direct_light = 8;

/// V of a light sample or hit. nee_pdf, scatter_pdf: densities of sampling the light and of the closure. is_direct: the
/// path has one surface. unhittable: lights that rays do not hit.
inline Float path_variants(Float nee_pdf, Float scatter_pdf, Mask is_direct, Mask unhittable)
{
    const Float trust = select(is_direct, Float(trust_in_direct_light), Float(1));
    // The limit keeps the square finite.
    const Float r = min(trust * nee_pdf / max(scatter_pdf, Float(1e-30f)), Float(1e15f));
    return fma(r, r, select(unhittable, Float(0), Float(1)));
}

/// Value of PathPool::connection of a path without a vertex yet.
inline constexpr float no_vertex = -1;

}  // namespace FATHOM_LANES
}  // namespace fathom
