#pragma once
/// What surfaces do with light. Directions are in the frame of the shading normal, unit, pointing away from the
/// surface; wo.z > 0: frames are turned to the side that the path is on.
///
/// A closure is a class with
///     static constexpr ClosureKind kind      whose materials scatter so
///     static constexpr bool transmits        whether light passes to the other side
///     static constexpr bool is_glossy        whether most goes in or near the mirror direction, which shading normals
///                                            must not put below the surface then
///     using Point                            what it is made from: MaterialPoint, or one with more
///     static constexpr bool is_guided        whether directions may also come from what has been learnt about light
///                                            (see guiding/)
///     static constexpr bool is_fiber         whether the frame's x is along a fibre, and MaterialPoint::across is
///     asked
///                                            for
///     explicit Closure(const Point&)
///     BsdfEval eval(wo, wi)                  what part of the light from wi goes to wo, times the cosine, and the
///                                            density of sampling wi
///     BsdfEval eval(wo, wi, without_mirrors) optional, where smooth facets are made of narrow lobes instead of deltas:
///                                            in the lanes of the mask they count as deltas, since no light without
///                                            extent is met in a mirror
///     BsdfSample sample(wo, u, u1)           a direction with its weight, f_cos / pdf
///     Float guided_weight()                  where is_guided: how much such directions are worth, from 0 to 1; little
///                                            where most goes into a narrow lobe, 0 where there are delta lobes
///     Mask has_non_delta()                      lanes with anything but delta lobes, for which lights are sampled
/// Delta lobes have a weight, and neither f_cos nor pdf.
#include <type_traits>

#include "materials/microfacet/microfacet.h"
#include "materials/records.h"
#include "math/spectrum.h"
#include "sampling/warp.h"

namespace fathom {
inline namespace FATHOM_LANES {

struct BsdfEval {
    Spectrum f_cos;
    Float pdf;
};
struct BsdfSample {
    Vec3 wi;
    Spectrum weight;
    Float pdf;
    Mask is_delta;
    Float eta;                             ///< index beyond over index before where the path is refracted, else 1
    Mask enters_subsurface = Mask(false);  ///< by what is counted as a delta lobe, since it has no light sampled
};

/// What a surface of layers has beside: see LayersRecord, and Material of the description.
struct LayersPoint {
    std::uint32_t features = 0;  ///< LayersRecord::Features that any lane has; numbers of others need not be set
    Float specular{1}, compensation{1};  ///< compensation: 1 or 0
    Spectrum specular_color{Float(1)}, edge_color{Float(1)};
    Spectrum conductor_eta, conductor_k{Float(0)};  ///< where k is 0, colours say what metal reflects
    Float anisotropy{0};
    Mask two_roughnesses{false};  ///< anisotropy is the roughness along the tangent
    Vec3 tangent;  ///< of the anisotropy; while the surface is read in the space of the scene, then in the frame
    Float diffuse_roughness{0};
    Float transmission{0}, diffuse_transmission{0};
    Mask diffuse_transmission_added{false};
    Spectrum transmission_color, diffuse_transmission_color;
    Float dispersion{0};
    Float coat{0}, coat_roughness{0}, coat_f0, coat_inner, coat_darkening;
    Spectrum coat_color;
    Vec3 coat_normal;  ///< as the tangent
    Spectrum sheen_color;
    Float sheen_roughness;
    Mask sheen_reciprocal{false};
    Float thin_film{0}, thin_film_thickness, thin_film_ior;
    Float subsurface{0};
    Spectrum subsurface_color, subsurface_radius;  ///< subsurface_radius: by channel, in units of render space
    Mask in_subsurface = Mask(false);              ///< the path comes from within, where it went by the subsurface

    bool has(LayersRecord::Features feature) const { return (features & feature) != 0; }
};

/// What a surface of Disney's has beside: see DisneyBsdf.
struct DisneyPoint {
    Float anisotropy, flatness, specular_tint, sheen, sheen_tint, coat, coat_gloss, transmission, diffuse_transmission;
    Vec3 tangent;  ///< as of LayersPoint
};

/// Where a table of a measured surface stands, and its size.
struct MeasuredTablePoint {
    UInt first, width, height;
};
/// What a measured surface has beside: see MeasuredRecord.
struct MeasuredPoint {
    const float* values = nullptr;  ///< ShadingTables::measured_values
    UInt theta, theta_count, phi, phi_count, symmetry;
    Mask color_is_per_facet;
    MeasuredTablePoint ndf, sigma, vndf, luminance, color;
    bool has_phis = true;  ///< tables of any lane are for more than one phi
    Vec3 tangent;          ///< as of LayersPoint; 0 where the surface looks the same from all sides
    Float facing;          ///< negative where the path is behind the geometric normal
};

/// The parameters of a surface's material, textures applied.
struct MaterialPoint {
    Spectrum base_color;
    Float roughness, metallic, ior, fuzz;
    Mask entering;                     ///< the path comes from the side of the geometric normal
    Mask thin;                         ///< without thickness
    Mask sheet;                        ///< thin: of two boundaries, between which light goes to and fro
    Mask beckmann{false};              ///< facets are Beckmann's
    Mask separable{false};             ///< what hides facets from one direction says nothing of the other
    Mask compensated;                  ///< scaled for what facets scatter more than once
    Mask nonlinear{true};              ///< plastic: light below the boundary is coloured each time
    Spectrum specular_tint{Float(1)};  ///< glass, plastic: multiplies what the boundary reflects
    Float across{0};  ///< hair: where the path met the fibre across its width, -1 to 1 along the frame's y
};
/// Of a surface of layers. Apart, since it is fifty times the registers that others need.
struct LayeredMaterialPoint : MaterialPoint {
    LayersPoint layers;
};

struct DisneyMaterialPoint : MaterialPoint {
    DisneyPoint disney;
};

struct MeasuredMaterialPoint : MaterialPoint {
    MeasuredPoint measured;
};

/// Where facets stand for a mirror.
inline Mask is_mirror(Float roughness)
{
    return roughness * roughness < Float(min_alpha);
}
/// Alpha of GGX by which facets are sampled: of Facets.
inline Float sampled_alpha(const MaterialPoint& m)
{
    return m.roughness * m.roughness * select(m.beckmann, Float(ggx_of_beckmann), Float(1));
}
/// Roughness of those, for tables of GGX's facets.
inline Float sampled_roughness(const MaterialPoint& m)
{
    return m.roughness * select(m.beckmann, Float(sqrt_ggx_of_beckmann), Float(1));
}

/// Whether a closure is made from a LayeredMaterialPoint.
template <class Closure>
inline constexpr bool is_layered = std::is_same_v<typename Closure::Point, LayeredMaterialPoint>;

}  // namespace FATHOM_LANES
}  // namespace fathom
