// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Interface of closures (BSDFs). Directions are in the frame of the shading normal, unit, pointing away from the
/// surface. wo.z > 0: frames are flipped to the side that the path is on.
///
/// A closure is a class derived from ClosureOf, whose properties it overrides where they differ, with
///     explicit Closure(const Point&)
///     BsdfEval eval(wo, wi)                  f_cos and the solid angle density of sampling wi
///     BsdfEval eval(wo, wi, without_mirrors) optional, where smooth facets are approximated by narrow lobes: in lanes
///                                            of the mask such lobes count as delta lobes and contribute nothing,
///                                            for lights without extent, which no mirror shows
///     BsdfSample sample(wo, u, u1)           a direction with its weight, f_cos / pdf
///     Float guided_weight()                  if is_guided: how useful guided directions are, 0 to 1; small where most
///                                            energy goes into a narrow lobe, 0 where there are delta lobes
/// Delta lobes have a weight, but neither f_cos nor pdf.
#include <type_traits>

#include "materials/microfacet/microfacet.h"
#include "materials/parameter_reader.h"
#include "math/spectrum.h"
#include "sampling/warp.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// BSDF times abs cosine of wi, and the density with respect to solid angle with which sample() returns wi.
struct BsdfEval {
    Spectrum f_cos;
    Float pdf;
};
/// A sampled direction. weight: f_cos / pdf, or the weight of a delta lobe.
struct BsdfSample {
    Vec3 wi;
    Spectrum weight;
    Float pdf;
    Mask is_delta;
    Float eta;  ///< refraction: index beyond the boundary over index before it; 1 for reflection
    Mask enters_subsurface = Mask(false);  ///< lanes that entered the subsurface medium; treated as a delta lobe, since
                                           ///< lights are not sampled for it
};

/// A direction that reflects, sampled with the density e.pdf; its weight is 0 where the density is 0.
inline BsdfSample reflection(Vec3 wi, const BsdfEval& e)
{
    const Float inverse = select(e.pdf > Float(0), Float(1) / max(e.pdf, Float(1e-30f)), Float(0));
    return {wi, e.f_cos * inverse, e.pdf, Mask(false), Float(1)};
}

/// Base of a closure for materials of kind k, with the properties of most closures. P: its parameters, a type derived
/// from MaterialPoint. P::Record is the record that MaterialRecord keeps (closures/records.h), and P::read takes a
/// ParameterReader of it.
template <ClosureKind k, class P>
struct ClosureOf {
    static constexpr ClosureKind kind = k;
    using Point = P;
    static constexpr bool transmits = false;  ///< whether light passes to the other side
    static constexpr bool is_glossy = true;   ///< whether most energy goes in or near the mirror direction, so that
                                              ///< shading normals must not put that direction below the surface
    static constexpr bool is_guided = false;  ///< whether path guiding may sample directions too (see guiding/)
    static constexpr bool is_fiber = false;   ///< whether the frame's x is along a hair fiber, and HairPoint::across is
                                              ///< read

    /// Lanes with lobes other than delta lobes, for which lights are sampled.
    Mask has_non_delta() const { return Mask(true); }
};

/// Parameters of LayeredBsdf beyond those of MaterialPoint, with textures applied: see LayersRecord, and Material in
/// the scene description.
struct LayersPoint {
    std::uint32_t features = 0;  ///< LayersRecord::Features that any lane has; parameters of other features need not be
                                 ///< set
    Float specular{1}, compensation{1};  ///< compensation: 1 to compensate for multiple scattering, else 0
    Spectrum specular_color{Float(1)}, edge_color{Float(1)};
    Spectrum conductor_eta,
        conductor_k{Float(
            0)};  ///< index of refraction of the metal in lanes with k > 0; in other lanes colors give the reflectance
    Float anisotropy{0};
    Mask two_roughnesses{false};  ///< lanes in which anisotropy holds the roughness along the tangent
    Vec3 tangent;  ///< tangent of the anisotropy; in scene space while the material is read, later in the shading frame
    Float diffuse_roughness{0};
    Float transmission{0}, diffuse_transmission{0};
    Mask diffuse_transmission_added{false};
    Spectrum transmission_color, diffuse_transmission_color;
    Float dispersion{0};
    Float coat{0}, coat_roughness{0}, coat_f0, coat_inner, coat_darkening;
    Spectrum coat_color;
    Vec3 coat_normal;  ///< normal of the coat, in the same space as `tangent`
    Spectrum sheen_color;
    Float sheen_roughness;
    Mask sheen_reciprocal{false};
    Float thin_film{0}, thin_film_thickness, thin_film_ior;
    Float subsurface{0};
    Spectrum subsurface_color, subsurface_radius;  ///< subsurface_radius: per channel, in render space
    Mask in_subsurface = Mask(false);              ///< lanes whose path leaves the subsurface medium from within

    bool has(LayersRecord::Features feature) const { return (features & feature) != 0; }
};

/// Parameters of DisneyBsdf beyond those of MaterialPoint: see DisneyRecord.
struct DisneyPoint {
    Float anisotropy, flatness, specular_tint, sheen, sheen_tint, coat, coat_gloss, transmission, diffuse_transmission;
    Vec3 tangent;  ///< tangent of the anisotropy, in the same space as LayersPoint::tangent
};

/// Location and size of one table of a measured surface: see MeasuredTableRecord.
struct MeasuredTablePoint {
    UInt first, width, height;
};
/// Tables of a measured surface: see MeasuredRecord.
struct MeasuredPoint {
    const float* values = nullptr;  ///< ShadingTables::measured_values
    UInt theta, theta_count, phi, phi_count, symmetry;
    Mask color_is_per_facet;
    MeasuredTablePoint ndf, sigma, vndf, luminance, color;
    bool has_phis = true;  ///< whether some lane's tables depend on phi
    Vec3 tangent;          ///< in the same space as LayersPoint::tangent; 0 for isotropic surfaces
    Float facing;          ///< negative if the path is behind the geometric normal
};

/// Parameters of a surface's material that all closures have, with textures applied.
struct MaterialPoint {
    Spectrum base_color;
    Mask entering;  ///< lanes whose path arrives on the side of the geometric normal
    Mask thin;      ///< lanes whose surface has no thickness
};

/// Parameters of a closure with microfacets.
struct FacetsPoint : MaterialPoint {
    Float roughness;
    Mask beckmann{false};   ///< lanes with Beckmann microfacets instead of GGX
    Mask separable{false};  ///< lanes with separable shadowing and masking, G1(wo) G1(wi)
    Mask compensated;       ///< lanes with energy compensation for multiple scattering between microfacets

    template <class Record>
    void read_facets(const ParameterReader<Record>& r)
    {
        roughness = r.number(&Record::roughness, &Record::roughness_texture);
        beckmann = r.has_flag(facets::beckmann), separable = r.has_flag(facets::separable);
        compensated = r.has_flag(facets::compensated);
    }
};

/// Parameters of closures that need color and roughness only.
struct RoughPoint : MaterialPoint {
    using Record = RoughRecord;
    Float roughness;

    void read(const ParameterReader<Record>& r)
    {
        roughness = r.number(&Record::roughness, &Record::roughness_texture);
    }
};

/// Parameters of PrincipledBsdf, and of the base of DisneyBsdf and LayeredBsdf.
struct PrincipledPoint : FacetsPoint {
    using Record = PrincipledRecord;
    Float metallic, ior;

    void read(const ParameterReader<Record>& r)
    {
        read_facets(r);
        metallic = r.number(&Record::metallic, &Record::metallic_texture);
        ior = r.get(&Record::ior);
    }
};

/// Parameters of LayeredBsdf. It is a type of its own since it takes about fifty times the registers of other closures'
/// parameters.
struct LayeredMaterialPoint : PrincipledPoint {
    LayersPoint layers;
};

/// Parameters of DisneyBsdf.
struct DisneyMaterialPoint : PrincipledPoint {
    DisneyPoint disney;
};

/// Parameters of MeasuredBsdf.
struct MeasuredMaterialPoint : MaterialPoint {
    using Record = MeasuredSurfaceRecord;
    MeasuredPoint measured;

    void read(const ParameterReader<Record>&) {}
};

/// Lanes whose microfacets are smooth enough to be treated as a mirror.
inline Mask is_mirror(Float roughness)
{
    return roughness * roughness < Float(min_alpha);
}
/// GGX alpha of the distribution that is sampled: for Beckmann lanes that of the most similar GGX distribution.
inline Float sampled_alpha(const FacetsPoint& m)
{
    return m.roughness * m.roughness * select(m.beckmann, Float(ggx_of_beckmann), Float(1));
}
/// Square root of sampled_alpha, for lookups in GGX albedo tables.
inline Float sampled_roughness(const FacetsPoint& m)
{
    return m.roughness * select(m.beckmann, Float(sqrt_ggx_of_beckmann), Float(1));
}

/// Whether a closure takes parameters from the table of layers or from one of its own.
template <class Closure>
inline constexpr bool is_layered = std::is_same_v<typename Closure::Point, LayeredMaterialPoint>;
template <class Closure>
inline constexpr bool is_disney = std::is_same_v<typename Closure::Point, DisneyMaterialPoint>;
template <class Closure>
inline constexpr bool is_measured = std::is_same_v<typename Closure::Point, MeasuredMaterialPoint>;

}  // namespace FATHOM_LANES
}  // namespace fathom
