// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Closures as the compiler writes them and the kernel reads them: their kinds, and the parameters that each kind
/// stores in MaterialRecord. Parameters that all closures have, such as the color, are members of MaterialRecord.
#include <cstdint>
#include <utility>

#include "base/no_index.h"
#include "fathom/description.h"
#include "math/rgb.h"

namespace fathom {

/// Selects the closure class that evaluates and samples the BSDF (closures/closures.h). Each MaterialKind has a closure
/// of the same number. Further closures of a kind follow; the parameters of a material decide between them.
enum class ClosureKind : std::uint32_t {
    none = std::uint32_t(MaterialKind::none),
    diffuse = std::uint32_t(MaterialKind::diffuse),
    metal = std::uint32_t(MaterialKind::metal),
    fuzz_metal = std::uint32_t(MaterialKind::fuzz_metal),
    glass = std::uint32_t(MaterialKind::glass),
    plastic = std::uint32_t(MaterialKind::plastic),
    hair = std::uint32_t(MaterialKind::hair),
    principled = std::uint32_t(MaterialKind::principled),
    disney = std::uint32_t(MaterialKind::disney),
    measured = std::uint32_t(MaterialKind::measured),
    disney_transmitting = std::uint32_t(material_kind_count),  ///< the Disney BSDF with lobes that transmit light
    layered,  ///< principled materials with features that PrincipledBsdf lacks
    layered_transmitting,
    count  ///< number of closure kinds
};
inline constexpr std::uint32_t closure_kind_count = std::uint32_t(ClosureKind::count);

/// The closure that has the number of a MaterialKind.
constexpr ClosureKind closure_of(MaterialKind kind)
{
    return ClosureKind(std::uint32_t(kind));
}

/// The texture of a scalar parameter: one of its channels multiplies a member of the same record.
struct NumberTexture {
    std::uint32_t texture = no_index, channel = 0;
};

/// Distribution and shadowing of microfacets: bits of a record's `flags`.
namespace facets {
inline constexpr std::uint32_t beckmann = 1;     ///< Beckmann microfacets instead of GGX
inline constexpr std::uint32_t separable = 2;    ///< separable shadowing and masking, G1(wo) G1(wi)
inline constexpr std::uint32_t compensated = 4;  ///< energy compensation for multiple scattering between microfacets
}  // namespace facets

/// Parameters of closures that have only color and roughness: diffuse, and kinds without a compile step of their own.
struct RoughRecord {
    float roughness = 0;
    NumberTexture roughness_texture;
};

struct MetalRecord {
    float roughness = 0;
    std::uint32_t flags = 0;  ///< bits of namespace facets
    NumberTexture roughness_texture;
};

struct FuzzMetalRecord {
    float fuzz = 0;  ///< radius of the ball around the mirror direction
};

struct GlassRecord {
    enum Flags : std::uint32_t {
        sheet = 8,   ///< thin glass of two boundaries with nothing between them
        tinted = 16  ///< set if reflection_color is not white
    };
    float roughness = 0;
    float ior = 1.5f;
    std::uint32_t flags = 0;  ///< bits of namespace facets, and Flags
    NumberTexture roughness_texture;
    Rgb reflection_color{1, 1, 1};  ///< factor of reflections
    std::uint32_t reflection_color_texture = no_index;
};

struct PlasticRecord {
    enum Flags : std::uint32_t {
        nonlinear = 8,  ///< each internal reflection multiplies by the body's color
        tinted = 16     ///< set if reflection_color is not white
    };
    float roughness = 0;
    float ior = 1.5f;
    float optical_thickness = 0;  ///< optical thickness of the gray layer between boundary and body
    /// Fraction of internally reflected light that the layer absorbs. A negative value is minus the internal
    /// reflectance.
    float internal_absorption = 0;
    std::uint32_t flags = 0;  ///< bits of namespace facets, and Flags
    NumberTexture roughness_texture;
    Rgb reflection_color{1, 1, 1};  ///< factor of reflections
    std::uint32_t reflection_color_texture = no_index;
};

struct HairRecord {
    float beta_m = 0, beta_n = 0;  ///< longitudinal and azimuthal roughness
    float ior = 1.55f;
    float scale_tilt = 0;  ///< tilt of the scales in radians
    NumberTexture beta_m_texture, beta_n_texture;
};

/// Parameters of metallic-roughness materials: PrincipledBsdf, and the base of DisneyBsdf and LayeredBsdf.
struct PrincipledRecord {
    float roughness = 0, metallic = 0;
    float ior = 1.5f;
    std::uint32_t flags = 0;  ///< bits of namespace facets
    std::uint32_t table =
        no_index;  ///< index into ShadingTables::layers or ShadingTables::disney, if the closure has a record there
    NumberTexture roughness_texture, metallic_texture;
};

struct MeasuredSurfaceRecord {
    std::uint32_t table = no_index;  ///< index into ShadingTables::measured
};

struct Compiler;
struct MaterialRecord;

/// Compile step of a closure: sets the closure of a record, its parameters, and other members that depend on the
/// closure. It is called after the steps that all materials share.
using ClosureStep = void(Compiler&, const Material&, MaterialRecord&);

ClosureStep compile_rough, compile_metal, compile_fuzz_metal, compile_glass, compile_plastic, compile_hair,
    compile_principled, compile_disney, compile_measured;

/// Compile steps by MaterialKind. Kinds without a step of their own have only color and roughness: compile_rough().
inline constexpr std::pair<MaterialKind, ClosureStep*> closure_steps[] = {
    {MaterialKind::metal, compile_metal},   {MaterialKind::fuzz_metal, compile_fuzz_metal},
    {MaterialKind::glass, compile_glass},   {MaterialKind::plastic, compile_plastic},
    {MaterialKind::hair, compile_hair},     {MaterialKind::principled, compile_principled},
    {MaterialKind::disney, compile_disney}, {MaterialKind::measured, compile_measured},
};

}  // namespace fathom
