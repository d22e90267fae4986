// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "fathom/api.h"
#include "fathom/description/texture.h"
#include "fathom/vector.h"

namespace fathom {

/// Reflection model of a material.
enum class MaterialKind {
    none,        ///< Black; for surfaces that only emit light.
    unlit,       ///< Appears in base_color whatever the light, also in mirrors and through glass. It doesn't illuminate
                 ///< other surfaces.
    diffuse,     ///< Lambertian; with roughness above 0 energy-preserving Oren-Nayar (Portsmouth et al. 2024, "EON").
    metal,       ///< GGX conductor; base_color is the reflectance at normal incidence, and roughness 0 is a mirror.
    fuzz_metal,  ///< Metal of "Ray Tracing in One Weekend": mirror direction plus fuzz times a random point of the unit
                 ///< sphere.
    glass,       ///< Smooth or rough dielectric, solid or thin. The inside of a solid can absorb and scatter light.
    plastic,     ///< Dielectric boundary, smooth or rough, over a diffuse body of base_color.
    /// Hair fiber: a rough absorbing cylinder of glass with tilted scales (Chiang et al. 2016). It is meant for curves;
    /// on other shapes fibers run along growing u, and v is the position across a fiber.
    hair,
    /// Layers in the manner of OpenPBR: sheen over coat over a mixture of metal and dielectric. Below the boundary of
    /// the dielectric, light is reflected diffusely, transmitted diffusely, or refracted. By default it is the
    /// metallic-roughness model of glTF 2.0.
    principled,
    /// Disney's BSDF (Burley 2012, 2015): a sum of microfacet, diffuse, sheen and clear coat lobes.
    disney,
    measured,  ///< Measured reflectance: SceneDescription::measured.
    mix,       ///< Mixture of two materials: a path meets material_b with probability `factor`, otherwise material_a.
    two_sided  ///< material_a on the side of the geometric normal, material_b on the other side.
};
/// Number of values of MaterialKind.
inline constexpr int material_kind_count = 13;
/// Name of a kind of material, as in scene files.
FATHOM_API const char* material_kind_name(MaterialKind kind);

/// Effect of a material's alpha.
enum class AlphaMode {
    opaque,  ///< Alpha is ignored.
    mask,    ///< The surface is visible where alpha is at least Material::Opacity::cutoff.
    blend    ///< Alpha is the opacity: a ray meets the surface with this probability.
};

/// A material. Its kind decides which members apply: each member and each group states the kinds that use it, and the
/// others ignore it. Colors that are reflectances or transmittances are 0 to 1.
struct Material {
    /// Absorption and scattering inside of solids. Kinds: glass, and principled and disney with transmission.
    struct Interior {
        Color attenuation_color{1, 1, 1};  ///< Fraction of white light that remains after attenuation_distance.
        double attenuation_distance = 0;   ///< Distance in meters that attenuation_color is for; 0: a clear solid.
        Color scatter{0, 0, 0};            ///< Scattering coefficient times attenuation_distance.
        /// Mean cosine of the Henyey-Greenstein phase function, -0.99 (backward) to 0.99 (forward).
        float scatter_anisotropy = 0;
        /// Counts scattering events inside as bounces if there is a RenderSettings::max_depth.
        bool scatter_bounces = false;
        /// Where solids overlap, the one with the highest priority counts; among equal ones the one entered last
        /// (Schmidt and Budge 2002, "Simple Nested Dielectrics in Ray Traced Images").
        int priority = 0;
        /// A sheet without thickness, which has no interior and doesn't deflect transmitted light.
        bool thin = false;
    };
    /// Refraction into the solid.
    struct Transmission {
        /// principled, disney: fraction of the light below the boundary that is refracted, 0 to 1.
        FloatInput weight{0, -1, 0};
        /// glass, principled: fraction of light that remains after entering and leaving a solid, or passing a thin
        /// sheet.
        ColorInput color;
        float dispersion = 0;  ///< principled: 20 / Abbe number; glass has 0.3 to 0.9.
    };
    /// Diffuse light that leaves on the other side of the surface. Kind: principled; disney has the weight only.
    struct DiffuseTransmission {
        FloatInput weight{0, -1, 3};  ///< Fraction of the diffuse light that is transmitted, 0 to 1.
        ColorInput color;             ///< Color of diffuse transmission.
        /// Adds diffuse transmission to diffuse reflection instead of subtracting it. Together they are limited to 1.
        bool added = false;
    };
    /// Scattering below the surface by a random walk. Kind: principled.
    struct Subsurface {
        /// Fraction of the diffuse light that enters the solid, is scattered there, and leaves it diffusely.
        FloatInput weight{0, -1, 0};
        ColorInput color{{0.8f, 0.8f, 0.8f}, -1};       ///< Reflectance of a half-space in uniform light.
        FloatInput radius{0.01f, -1, 0};                ///< Mean free path in meters.
        ColorInput radius_scale{{1, 0.5f, 0.25f}, -1};  ///< Factor of the radius for each channel.
        float scatter_anisotropy = 0;                   ///< Mean cosine of scattering, -0.99 to 0.99.
    };
    /// Reflection at the boundary of the dielectric.
    struct Specular {
        FloatInput weight{1, -1, 3};  ///< principled: strength of the reflection, 0 to 1.
        /// principled: tint of the reflection at normal incidence; values above 1 raise the reflectance, at most to 1.
        /// glass, plastic: factor of the reflection at all angles, 0 to 1.
        ColorInput color;
    };
    /// The metal base. Kind: principled.
    struct Conductor {
        ColorInput edge_color;  ///< Tint at 82 degrees, a factor of Schlick's reflectance.
        /// Real and imaginary part of the index of refraction. Where k is above 0, Fresnel's equations give the
        /// reflectance; base_color and edge_color should then describe the same metal.
        Color eta{0, 0, 0}, k{0, 0, 0};
    };
    /// Distribution of microfacet normals. Kinds: metal, glass, plastic, principled and disney, except as noted.
    struct Microfacets {
        /// principled, disney: stretches microfacets along the tangent, 0 to 1. principled: the alpha along the tangent
        /// goes from roughness^2 to 1 with the square of anisotropy.
        FloatInput anisotropy{0, -1, 2};
        /// principled: anisotropy is the roughness along the tangent, and roughness that across it.
        bool two_roughnesses = false;
        double anisotropy_rotation = 0;  ///< principled: rotation of the tangent towards the bitangent in radians.
        /// principled: texture whose red and green are the direction of stretching; 0.5 stands for 0. It is applied
        /// before anisotropy_rotation.
        int anisotropy_texture = -1;
        /// Beckmann distribution instead of GGX, with the same alpha. Not for disney.
        bool beckmann = false;
        /// Separable masking and shadowing of GGX instead of height-correlated. Not for disney.
        bool separable_masking = false;
        /// glass, plastic, principled: compensates for the light that single scattering by rough microfacets loses
        /// (Turquin 2019, "Practical multiple scattering compensation for microfacet models").
        bool energy_compensation = true;
    };
    /// The body below the boundary. Kind: plastic.
    struct Plastic {
        float optical_thickness = 0;   ///< Optical thickness of a gray absorbing layer between boundary and body.
        bool nonlinear = true;         ///< Light reflected between boundary and body is tinted by the body each time.
        float inner_reflectance = -1;  ///< Fraction of light from below that the boundary reflects; -1: by its
                                       ///< microfacets.
    };
    /// Clear layer over everything except the sheen. Kind: principled; disney has the weight only.
    struct Coat {
        FloatInput weight{0, -1, 0};     ///< Strength of the coat, 0 to 1.
        ColorInput color;                ///< Fraction of light that the coat transmits.
        FloatInput roughness{0, -1, 1};  ///< Perceptual roughness of the coat, 0 to 1.
        float ior = 1.5f;                ///< Index of refraction of the coat, 1 to 3.
        float darkening = 1;             ///< Fraction of the interreflection between coat and base to include, 0 to 1.
        int normal_texture = -1;         ///< Tangent-space normal map of the coat; -1: normals of the mesh.
        float normal_scale = 1;          ///< Factor of x and y of the coat's normal map.
    };
    /// Layer of fibers over everything else. Kind: principled.
    struct Sheen {
        ColorInput color{{0, 0, 0}, -1};    ///< Reflectance of the sheen.
        FloatInput roughness{0.3f, -1, 3};  ///< Roughness of the sheen, 0 (upright fibers) to 1.
        /// Attenuates the layers below the sheen by the darker of both directions, as in glTF, which is reciprocal but
        /// loses some light. Otherwise only the outgoing direction counts.
        bool reciprocal = false;
    };
    /// Thin film, whose interference colors the reflection. Kind: principled.
    struct ThinFilm {
        FloatInput weight{0, -1, 0};       ///< Fraction of the surface that the film covers, 0 to 1.
        FloatInput thickness{400, -1, 1};  ///< Thickness of the film in nanometers.
        float ior = 1.3f;                  ///< Index of refraction of the film, 1 to 3.
    };
    /// Parameters that only Disney's BSDF has. Kind: disney.
    struct Disney {
        FloatInput flatness{0, -1, 0};  ///< Blends diffuse reflection with an approximation of subsurface scattering.
        FloatInput specular_tint{0, -1, 0};  ///< How far the dielectric's reflection has the hue of base_color, 0 to 1.
        FloatInput sheen{0, -1, 0};          ///< Strength of the reflection at grazing angles, 0 to 1.
        FloatInput sheen_tint{0, -1, 0};     ///< How far the sheen has the hue of base_color, 0 to 1.
        FloatInput coat_gloss{0, -1, 0};     ///< Gloss of the coat: 0 is an alpha of 0.1, 1 an alpha of 0.001.
    };
    /// Two materials. Kinds: mix and two_sided. A mixture has its own emission, opacity and displacement; those of its
    /// materials are ignored.
    struct Mixture {
        int material_a = -1, material_b = -1;  ///< Materials, which may be mixtures themselves, up to 16 deep.
        FloatInput factor{0.5f, -1, 0};        ///< mix: probability of material_b, 0 to 1.
    };
    /// Hair fibers. Kind: hair. The color is given by the first that is above 0: absorption, melanin (both),
    /// base_color.
    struct Hair {
        ColorInput absorption{{0, 0, 0}, -1};  ///< Absorption coefficient times the radius of the fiber.
        float eumelanin = 0, pheomelanin = 0;  ///< Concentrations of brown to black and of red to yellow pigment.
        FloatInput beta_m{0.3f, -1, 1};        ///< Roughness along the fiber, 0 to 1.
        FloatInput beta_n{0.3f, -1, 1};        ///< Roughness around the fiber, 0 to 1.
        double scale_tilt =
            0.03490658503988659;  ///< Angle of the scales to the fiber in radians (2 degrees by default).
        float ior = 1.55f;        ///< Index of refraction of the fiber, 1 to 3.
    };
    /// Light that the surface emits. All kinds except unlit.
    struct Emission {
        ColorInput radiance{{0, 0, 0}, -1};  ///< Emitted radiance in nits.
        bool two_sided = false;  ///< Emits on both sides; by default only on the side of the geometric normal.
    };
    /// Tangent-space normal map, green is up. Not for hair, unlit, none, mix and two_sided.
    struct NormalMap {
        int texture = -1;  ///< Index into SceneDescription::textures; -1: none.
        float scale = 1;   ///< Factor of x and y of the normal map.
    };
    /// Displacement of the surface along its shading normal. All kinds.
    struct Displacement {
        /// Height, in units of the shape's own space: value times (texture - midlevel). Without a texture its value
        /// counts as 1.
        FloatInput height{0, -1, 0};
        float midlevel = 0;  ///< Texture value that doesn't move the surface.
        /// Maximum edge length of displaced triangles, in units of the shape's own space; 0: as fine as the texture.
        double edge_length = 0;
    };
    /// Opacity of the surface. All kinds.
    struct Opacity {
        AlphaMode mode = AlphaMode::opaque;  ///< Effect of alpha.
        FloatInput alpha{1, -1, 3};          ///< Opacity, 0 to 1.
        float cutoff = 0.5f;                 ///< AlphaMode::mask: smallest alpha that is visible.
    };
    /// Sides and rays that see the surface. All kinds, except as noted.
    struct Visibility {
        bool black_back = false;               ///< The back reflects nothing. For materials that don't transmit light.
        bool camera_backface_culling = false;  ///< Camera rays pass through the back; all other rays meet it.
        bool hidden_from_camera = false;       ///< Camera rays pass through the surface; all other rays meet it.
        /// No ray meets the surface, whatever its alpha, but its emission lights the scene. Not for unlit.
        bool invisible_light = false;
    };

    std::string name;                           ///< Name for messages and scene files; may be empty.
    MaterialKind kind = MaterialKind::diffuse;  ///< Reflection model.

    /// Reflectance; for unlit the visible color, for hair the color of much hair. All kinds except glass, measured,
    /// mix, two_sided and none.
    ColorInput base_color{{0.8f, 0.8f, 0.8f}, -1};
    /// Perceptual roughness, 0 smooth to 1 rough; the GGX alpha is its square. All kinds with a surface except
    /// fuzz_metal, hair and measured.
    FloatInput roughness{0, -1, 1};
    FloatInput metallic{0, -1, 2};           ///< principled, disney: fraction of metal, 0 to 1.
    FloatInput diffuse_roughness{0, -1, 0};  ///< principled: Oren-Nayar roughness of diffuse reflection, 0 to 1.
    float fuzz = 0;                          ///< fuzz_metal: size of the random offset, 0 (mirror) to 1.
    float ior = 1.5f;   ///< glass, plastic, principled, disney: index of refraction relative to empty space.
    int measured = -1;  ///< measured: index into SceneDescription::measured.

    Specular specular;                         ///< Used by glass, plastic, principled.
    Conductor conductor;                       ///< Used by principled.
    Microfacets microfacets;                   ///< Used by metal, glass, plastic, principled, disney.
    Interior interior;                         ///< Used by glass, principled, disney.
    Transmission transmission;                 ///< Used by glass, principled, disney.
    DiffuseTransmission diffuse_transmission;  ///< Used by principled, disney.
    Subsurface subsurface;                     ///< Used by principled.
    Coat coat;                                 ///< Used by principled, disney.
    Sheen sheen;                               ///< Used by principled.
    ThinFilm thin_film;                        ///< Used by principled.
    Disney disney;                             ///< Used by disney.
    Plastic plastic;                           ///< Used by plastic.
    Hair hair;                                 ///< Used by hair.
    Mixture mixture;                           ///< Used by mix, two_sided.

    Emission emission;         ///< Used by all kinds except unlit.
    NormalMap normal_map;      ///< Used by all kinds except hair, unlit, none, mix and two_sided.
    bool map_tangents = true;  ///< For meshes without tangents: normal_map, the coat's normal map and
                               ///< anisotropy_texture use tangents that follow the texture coordinates of the map
                               ///< itself (its set and transform), as in glTF. If false, they use tangents of the
                               ///< mesh's first set.
    /// Height in world-space meters whose slope bends the shading normal (Blinn 1978) before normal_map does. It has no
    /// effect without a texture. Kinds as normal_map.
    FloatInput bump{0, -1, 0};
    Displacement displacement;      ///< Used by all kinds.
    Opacity opacity;                ///< Used by all kinds.
    Visibility visibility;          ///< Used by all kinds.
    bool use_vertex_color = false;  ///< Multiplies base_color and opacity by the mesh's vertex colors. All kinds.
};

}  // namespace fathom
