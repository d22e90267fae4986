// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "integrate/stages/solid_boundary.h"
#include "kernel/pool.h"
#include "kernel/stage_clock.h"
#include "materials/read/material.h"
#include "media/stack.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Surface vertex of a path: position and frame on the side of the path, and the material.
template <class Closure>
struct ShadingPoint {
    Vec3 p, ng;
    Float offset;       ///< offset of rays that leave the surface, see Surface
    Frame frame;        ///< frame of the shading normal
    Vec3 given_normal;  ///< the shading normal before it was bent toward ng, on the same side
    Vec3 wo;            ///< toward the previous vertex, in `frame`
    UInt material_index;
    typename Closure::Point material;
    Vec3 d;       ///< direction along which the path arrived
    Mask inside;  ///< hit from behind the geometric normal
    /// Media before the surface, and beyond it if the path passes; valid if Feature::media_stacks.
    MediumStack media, media_beyond;
    MediumStack media_below;  ///< media after entering the subsurface
    Mask skips_interface;     ///< null interface: the path passes undeflected, see SolidBoundary
    /// For hair: whether the fiber is a flat ribbon, its radius, and the offset of the hit from its axis in units of
    /// the radius.
    Mask is_ribbon;
    Float radius, across;

    /// Point from which lights are sampled.
    [[gnu::always_inline]] Vec3 eye() const { return fma(ng, offset, p); }
    /// Distance from the eye at which a ray along wi starts. For ribbons the start lies past the axis: a ribbon faces
    /// every ray, so a ray that starts closer would hit it again. The distance is 0 for other surfaces.
    [[gnu::always_inline]] Float exit_offset(const Vec3& wi) const
    {
        if constexpr (Closure::is_fiber) {
            const Float along = dot(wi, frame.s);
            // The distance is limited for directions nearly along the fiber, since a fiber is not straight for so long.
            const Float across2 = max(fma(-along, along, Float(1)), Float(1e-3f));
            const Float way = fma(max(-(across * dot(wi, frame.t)), Float(0)) / across2, radius,
                                  radius * Float(0.125f) * inverse_sqrt(across2));
            return select(is_ribbon, way, Float(0));
        }
        return Float(0);
    }
    /// Origin of a ray that leaves along wi.
    [[gnu::always_inline]] Vec3 start(const Vec3& wi) const
    {
        if constexpr (Closure::is_fiber) return fma(wi, exit_offset(wi), fma(flip_sign(ng, dot(wi, ng)), offset, p));
        const Vec3 side = Closure::transmits ? flip_sign(ng, dot(wi, ng)) : ng;
        return fma(side, offset, p);
    }
};

/// The hits of the paths from number i on, on surfaces that scatter.
[[gnu::always_inline]] inline SurfaceHit load_hit(const LaneScene& scene, const PathPool& p, const HitColumns& hits,
                                                  std::size_t i)
{
    return {p.origin.load(i),
            p.direction.load(i),
            hits.t.load(i),
            hits.u.load(i),
            hits.v.load(i),
            scene.has(Feature::motion) ? p.time.load(i) : Float(0),
            hits.primitive.load(i),
            scene.is_flat ? UInt(no_index) : hits.instance.load(i),
            scene.has(Feature::mixtures) ? hits.material.load(i) : UInt(no_index)};
}

namespace detail {

/// Bends the shading normal toward the geometric normal as far as needed for the mirror direction to leave the surface.
/// wo is on the side of ng.
///
/// In the plane of both normals, let x be the angle of the shading normal from ng, and a and b the components of wo
/// across and along ng. The mirror direction rises by a sin 2x + b cos 2x = r cos(2x - p), where a = r sin p and b = r
/// cos p. It must rise by t, which is less than the rise b at x = 0, so that normals that agree stay unchanged: 2x = p
/// + acos(t / r). With t much below b, rays that are reflected repeatedly inside glass would end up creeping along its
/// surface.
inline Vec3 bend_shading_normal(const Vec3& wo, const Vec3& ng, const Vec3& ns)
{
    const Float b = dot(wo, ng), cosine = dot(ns, ng);
    const Float t = min(b * Float(0.9f), Float(0.02f));
    const Mask below = Float(2) * dot(wo, ns) * cosine - b < t;
    if (none(below)) return ns;
    const Vec3 off = fma(ng, -cosine, ns);
    const Vec3 across = off * inverse_sqrt(max(dot(off, off), Float(1e-20f)));
    const Float a = dot(wo, across), inverse_r = inverse_sqrt(max(fma(a, a, b * b), Float(1e-20f)));
    const Float c = t * inverse_r, s = sqrt(max(fma(-c, c, Float(1)), Float(0)));
    const Float cos_2x = fma(b * inverse_r, c, -(a * inverse_r * s));
    const Float cos_x = sqrt(max(fma(cos_2x, Float(0.5f), Float(0.5f)), Float(0)));
    const Float sin_x = sqrt(max(fma(cos_2x, Float(-0.5f), Float(0.5f)), Float(0)));
    return select(below, fma(across, sin_x, ng * cos_x), ns);
}

/// Lanes where glass must refract about the geometric normal: about ns, the light would stay on its side of the
/// surface, or be reflected totally although it is not about ng. Paths reflected about shading normals could stay
/// trapped inside, although light that entered through the actual surface would leave.
///
/// eta: index of refraction beyond the surface over that before it.
inline Mask refracts_about_ng(const Vec3& wo, const Vec3& ng, const Vec3& ns, Float eta)
{
    const Float inverse = Float(1) / eta;
    const auto cos2_beyond = [&](Float cosine) {
        return fma(-(inverse * inverse), fma(-cosine, cosine, Float(1)), Float(1));
    };
    const Float by_ns = dot(wo, ns), by_ng = dot(wo, ng), cos2 = cos2_beyond(by_ns);
    const Float along_ns = fma(by_ns, inverse, -sqrt(max(cos2, Float(0))));
    const Mask back = fma(dot(ns, ng), along_ns, -(by_ng * inverse)) >= Float(0);
    const Mask passes = cos2 > Float(0);
    return (passes & back) | (!passes & (cos2_beyond(by_ng) > Float(0)));
}

/// Finds the media on both sides of a solid's boundary and makes the solid's index of refraction relative to the
/// outside.
template <class Closure>
inline void find_media(const MaterialReader& materials, Mask m, ShadingPoint<Closure>& at)
{
    const SolidBoundary boundary = solid_boundary(materials, at.material_index, at.media, at.inside, m);
    if (none(boundary.solid)) return;
    at.media_beyond = select(boundary.solid, boundary.media.beyond, at.media);
    at.skips_interface = boundary.skips_interface;
    if constexpr (is_layered<Closure>) {
        const UInt subsurface = materials.get(&MaterialRecord::subsurface_medium, at.material_index, boundary.solid);
        at.material.layers.in_subsurface = boundary.below & boundary.media.is_there;
        at.media_below = at.media.entered(materials.tables(), subsurface, boundary.solid);
    }
    at.material.ior = select(boundary.solid, at.material.ior / boundary.media.other_ior, at.material.ior);
}

/// Transforms the directions that a material stores into the frame of the shading normal. wo must be on the side of ng.
inline void to_shading_frame(const Frame&, const Vec3&, const Vec3&, Float, MaterialPoint&) {}
inline void to_shading_frame(const Frame& frame, const Vec3&, const Vec3&, Float, DisneyMaterialPoint& material)
{
    material.disney.tangent = frame.to_local(material.disney.tangent);
}
inline void to_shading_frame(const Frame& frame, const Vec3&, const Vec3&, Float facing,
                             MeasuredMaterialPoint& material)
{
    material.measured.tangent = frame.to_local(material.measured.tangent);
    material.measured.facing = facing;
}
inline void to_shading_frame(const Frame& frame, const Vec3& wo, const Vec3& ng, Float facing,
                             LayeredMaterialPoint& material)
{
    LayersPoint& layers = material.layers;
    if (layers.has(LayersRecord::anisotropic)) layers.tangent = frame.to_local(layers.tangent);
    if (layers.has(LayersRecord::with_coat))
        layers.coat_normal = frame.to_local(bend_shading_normal(wo, ng, flip_sign(layers.coat_normal, facing)));
}

/// Lifts directions that rounding put below the horizon.
inline Vec3 clamp_to_hemisphere(Vec3 w)
{
    return {w.x, w.y, max(w.z, Float(1e-4f))};
}

/// Sets the frame of a fiber, whose x axis points along it, and the offset of the hit across it. On meshes the tangent
/// of u points along the fiber and v runs across.
template <class Closure>
inline void set_fiber_frame(const Surface& s, Float facing, ShadingPoint<Closure>& at)
{
    const Frame any(at.ng);
    const Float length2 = dot(s.tangent, s.tangent);
    const Vec3 given = s.tangent * inverse_sqrt(max(length2, Float(1e-37f)));
    const Vec3 along = select(length2 > Float(1e-37f), given, any.s);
    // The normal of a tapering fiber is not perpendicular to its axis.
    const Vec3 n = fma(along, -dot(along, at.ng), at.ng);
    const Vec3 normal = normalize(select(dot(n, n) > Float(1e-6f), n, any.t));
    at.frame = Frame(along, cross(normal, along), normal);
    at.ng = normal;
    at.radius = s.radius;
    at.is_ribbon = s.is_ribbon;
    at.offset = select(s.is_ribbon, Float(0), s.offset);
    const Float v = s.at.v[0], repeated = select((v >= Float(0)) & (v <= Float(1)), v, v - floor(v));
    const Float across = fma(repeated, Float(2), Float(-1));
    // On curves v grows along the frame's y axis; on meshes it grows downward in the texture, as seen from the front.
    const Float down = -flip_sign(s.bitangent_sign, facing);
    at.across = select(s.is_curve, across, flip_sign(across, down));
    at.material.across = at.across;
    at.wo = clamp_to_hemisphere(at.frame.to_local(-at.d));
}

}  // namespace detail

/// Reads surface and material at a hit and sets up the local frame. media: stack of the path, or null if not tracked.
template <class Closure>
[[gnu::always_inline]] inline ShadingPoint<Closure> read_shading_point(const SurfaceReader& surfaces,
                                                                       const MaterialReader& materials,
                                                                       const SurfaceHit& hit, const MediumStack* media,
                                                                       Mask m, StageClock& clock)
{
    Surface s = surfaces.read(hit, m);
    clock.enter(RenderStage::material);
    ShadingPoint<Closure> at;
    at.material_index = s.material;
    at.d = hit.d;
    const Float facing = -dot(hit.d, s.ng);
    at.inside = facing <= Float(0);
    materials.read(s, facing > Float(0), m, at.material);
    at.p = s.p, at.offset = s.offset;
    at.ng = flip_sign(s.ng, facing);
    Vec3 ns = flip_sign(s.ns, facing);
    at.skips_interface = Mask(false);
    if (media) at.media = at.media_beyond = *media;
    if constexpr (Closure::transmits)
        if (media) detail::find_media(materials, m, at);
    if constexpr (Closure::is_fiber) {
        detail::set_fiber_frame(s, facing, at);
        return at;
    }
    at.given_normal = ns;
    if constexpr (Closure::is_glossy) {
        const Vec3 own = ns;
        ns = detail::bend_shading_normal(-hit.d, at.ng, ns);
        if constexpr (Closure::transmits) {
            const Float eta = select(at.inside, Float(1) / at.material.ior, at.material.ior);
            ns = select(detail::refracts_about_ng(-hit.d, at.ng, ns, eta) & !at.material.thin, at.ng, ns);
            // Diffuse light leaving the subsurface does not depend on the direction of arrival, so its shading normal
            // is not bent.
            if constexpr (is_layered<Closure>) ns = select(at.material.layers.in_subsurface, own, ns);
        }
    } else {
        // A surface seen from behind its shading normal uses the geometric normal.
        ns = select(dot(hit.d, ns) < Float(-1e-4f), ns, at.ng);
    }
    at.frame = Frame(ns);
    detail::to_shading_frame(at.frame, -hit.d, at.ng, facing, at.material);
    at.wo = detail::clamp_to_hemisphere(at.frame.to_local(-hit.d));
    return at;
}

/// Whether paths may pass surfaces of this closure as shadow rays do.
template <class Closure>
bool passes_interfaces(const LaneScene& scene)
{
    return Closure::kind == ClosureKind::glass && scene.has(Feature::transmissive_shadows);
}

/// Paths that continue undeflected through a pane or open boundary, as shadow rays do.
struct UndeflectedPaths {
    Mask undeflected{false};
    Mask no_bounce{false};  ///< lanes of `undeflected` for which passing does not count as a bounce
};
/// Finds the paths of the lanes of m that continue undeflected along wi.
template <class Closure>
[[gnu::always_inline]] inline UndeflectedPaths find_undeflected(const LaneScene& scene, const MaterialReader& materials,
                                                                const ShadingPoint<Closure>& at, const SurfaceHit& hit,
                                                                const Vec3& wi, Mask m)
{
    // A mixture chooses at random between passing and its other constituent, so its surface is not an interface.
    m &= hit.material == UInt(no_index);
    const PassedInterface there = classify_interface(scene, materials, at.material_index, at.skips_interface, m);
    const Mask undeflected = (there.pane & (dot(wi, at.ng) < Float(0))) | there.open;
    return {undeflected, Mask(there.no_bounce & undeflected)};
}

/// Lanes whose delta lobes scatter light along the same path in both directions: the shading normal is bent neither for
/// the path's direction of arrival nor for wi.
template <class Closure>
[[gnu::always_inline]] inline Mask is_reversible(const ShadingPoint<Closure>& at, const Vec3& wi)
{
    if constexpr (!Closure::is_glossy) return Mask(true);
    const Vec3 bent = at.frame.n - at.given_normal;
    const Float side = dot(wi, at.ng);
    const Vec3 ng = flip_sign(at.ng, side), ns = flip_sign(at.given_normal, side);
    Vec3 seen = detail::bend_shading_normal(wi, ng, ns);
    if constexpr (Closure::transmits) {
        const Mask below = !equal(at.inside, side < Float(0));
        const Float eta = select(below, Float(1) / at.material.ior, at.material.ior);
        seen = select(detail::refracts_about_ng(wi, ng, seen, eta) & !at.material.thin, ng, seen);
    }
    const Vec3 bent_there = seen - ns;
    constexpr float slack = 1e-8f;
    return (dot(bent, bent) < Float(slack)) & (dot(bent_there, bent_there) < Float(slack));
}

}  // namespace FATHOM_LANES
}  // namespace fathom
