#pragma once
/// Materials and textures as the kernel reads them.
#include <array>
#include <cstdint>
#include <vector>

#include "base/large_memory.h"
#include "base/no_index.h"
#include "math/rgb.h"

namespace fathom {

/// How an image's texels lie in memory. Each format is taken only where it holds every value exactly.
enum class TexelFormat : std::uint32_t {
    float4,      ///< four floats, in ShadingTables::texels
    bytes,       ///< one word of packed_images: red in the lowest byte, alpha in the highest, 255 is 1
    bytes_srgb,  ///< the same, but red, green and blue are sRGB codes, decoded by ShadingTables::linear_of_srgb
    halves,      ///< two words: red and green, blue and alpha; the lower half first
    shorts,      ///< the same with 16-bit integers, 65535 is 1
};

struct TextureRecord {
    std::uint32_t kind = 0;  ///< TextureKind
    // image: format, offset into texels (in fours) or number among packed_images, size, wrap modes
    std::uint32_t format = 0;  ///< TexelFormat
    std::uint64_t texels = 0;
    int width = 0, height = 0;
    std::uint32_t wrap_u = 0, wrap_v = 0, nearest = 0;
    std::uint32_t uv_set = 0;
    std::array<float, 6> uv_map{1, 0, 0, 0, 1, 0};  ///< two rows: texture uv from mesh uv
    std::uint32_t mapping = 0;                      ///< TextureMapping
    std::uint32_t space = no_index;                 ///< among ShadingTables::texture_spaces; else the world itself
    float scale = 1, turbulence_weight = 0, gain = 0.5f;
    std::array<float, 3> direction{0, 1, 0};  ///< facing: unit
    std::uint32_t octaves = 7;
    std::array<float, 4> color_a{}, color_b{};
    std::uint32_t texture_a = no_index, texture_b = no_index;  ///< which they are multiplied by
    float factor = 1;
    std::uint32_t factor_texture = no_index, factor_channel = 0;
    std::uint32_t first_stop = 0, stop_count = 0;
};

/// Where a texture stands: rows of an affine map, texture from world.
struct TextureSpaceRecord {
    std::array<std::array<float, 4>, 3> rows{};
};

/// The code that scatters light (closures/closures.h).
enum class ClosureKind : std::uint32_t {
    none,
    diffuse,
    metal,
    fuzz_metal,
    glass,
    plastic,
    hair,
    principled,
    disney,
    disney_transmitting,  ///< the same where light passes to the other side
    layered,
    layered_transmitting,
    measured
};
inline constexpr int closure_kind_count = 13;

/// A number or colour times that of a texture, if there is one.
struct NumberRecord {
    float value = 0;
    std::uint32_t texture = no_index, channel = 0;
};
struct ColorRecord {
    Rgb value{};
    std::uint32_t texture = no_index;
};

/// What a surface of layers has beside a MaterialRecord.
struct LayersRecord {
    enum Features : std::uint32_t {
        with_sheen = 1,
        with_coat = 2,
        with_thin_film = 4,
        with_transmission = 8,
        with_diffuse_transmission = 16,
        rough_diffuse = 32,
        anisotropic = 64,
        energy_compensation = 128,
        coat_normal_mapped = 256,
        disperses = 512,
        with_subsurface = 1024,
        sheen_reciprocal = 2048,
        diffuse_transmission_added = 4096,
        two_roughnesses = 8192,  ///< anisotropy is the roughness along the tangent
        with_conductor = 16384,
        textured = 32768  ///< any of the parameters here
    };
    std::uint32_t features = 0;
    NumberRecord specular, anisotropy, transmission, diffuse_transmission, diffuse_roughness, coat, coat_roughness,
        sheen_roughness, thin_film, thin_film_thickness, subsurface, subsurface_radius;
    ColorRecord specular_color, edge_color, transmission_color, diffuse_transmission_color, coat_color, sheen_color,
        subsurface_color, subsurface_radius_scale;
    Rgb conductor_eta{}, conductor_k{};
    float anisotropy_cos = 1, anisotropy_sin = 0;
    float dispersion = 0;
    /// Reflectance of the coat at normal incidence, and of light from within that comes from everywhere; see
    /// LayeredBsdf.
    float coat_f0 = 0, coat_inner = 0, coat_darkening = 0, coat_normal_scale = 1;
    float thin_film_ior = 1;
    std::uint32_t anisotropy_texture = no_index, coat_normal_texture = no_index;
};

/// What a surface of Disney's has beside a MaterialRecord.
struct DisneyRecord {
    enum Features : std::uint32_t { anisotropic = 1, textured = 2 /* any of the parameters here */ };
    std::uint32_t features = 0;
    NumberRecord anisotropy, flatness, specular_tint, sheen, sheen_tint, coat, coat_gloss, transmission,
        diffuse_transmission;
};

/// Where numbers over the unit square stand: in ShadingTables::measured_values. See MeasuredTable.
struct MeasuredTableRecord {
    std::uint32_t first = 0, width = 0, height = 0;
};

/// A measured surface: see measured_tables.h, and MeasuredBrdf of the description.
struct MeasuredRecord {
    std::uint32_t theta = 0, theta_count = 0, phi = 0, phi_count = 0;  ///< where the angles stand
    /// Directions of which one is measured, since the surface looks the same from all: as it is (1), turned by half a
    /// turn (2), or mirrored by both axes too (4).
    std::uint32_t symmetry = 1;
    std::uint32_t color_is_per_facet = 1;
    MeasuredTableRecord ndf, sigma, vndf, luminance, color;
    std::uint32_t unused[3] = {};  ///< rows are read in fours
};

/// A material that paths meet as one of two others.
struct MixtureRecord {
    std::uint32_t first = 0, second = 0;  ///< among ShadingTables::materials
    std::uint32_t by_side = 0;            ///< the second one is that of the back; else paths meet it by chance
    NumberRecord factor;                  ///< how often
};

struct MaterialRecord {
    enum Flags : std::uint32_t {
        textured = 1,
        normal_mapped = 2,
        vertex_colored = 4,
        emits = 8,
        two_sided_emission = 16,
        unlit = 32 /* shows its emission, but lights nothing */,
        thin = 64,
        wants_tangent = 128,  ///< of the surface, for normal maps or anisotropy
        single_sided = 256,   ///< cameras look through it from behind
        compensated = 512,    ///< scaled for what facets scatter more than once
        sheet = 1024,         ///< thin: of two boundaries
        nonlinear = 2048,     ///< plastic: light below the boundary is coloured each time
        one_sided = 4096,
        absorption = 8192,  ///< hair: base_color is what a fibre absorbs over its radius
        beckmann = 16384,   ///< facets are Beckmann's, else GGX's
        bumped = 32768,     ///< normals are bent by the slope of bump
        separable = 65536,  ///< facets' shadowing is that of each direction by itself
        wants_uv =
            131072,  ///< of the surface, beside what is textured: for fibres and textures of what records have beside
        open_boundary = 262144,  ///< of a solid of index 1, at which nothing happens to light but that it is inside
        pane = 524288,           ///< a sheet of smooth glass: shadow rays pass it, too
        hidden_from_camera = 1048576,
        invisible_light = 2097152,  ///< emits, but no ray meets it
        tinted = 4194304,           ///< glass, plastic: specular_tint is not white
        map_tangents = 8388608      ///< tangents follow the coordinates of each map, which are not the mesh's own
    };
    // What shading reads of each vertex: see row_words.
    std::uint32_t flags = 0;
    Rgb base_color{};
    float roughness = 0;  ///< hair: along the fibre
    float metallic = 0;   ///< hair: roughness around the fibre; plastic: see PlasticBsdf
    float ior = 1.5f;
    float fuzz = 0;                   ///< hair: tilt of its scales, radians; plastic: optical thickness
    std::uint32_t layers = no_index;  ///< in ShadingTables
    std::uint32_t base_texture = no_index, normal_texture = no_index;
    float normal_scale = 1;

    ClosureKind closure = ClosureKind::none;
    std::uint32_t disney = no_index;    ///< in ShadingTables
    std::uint32_t measured = no_index;  ///< in ShadingTables
    std::uint32_t mixture = no_index;   ///< in ShadingTables; what is here beside emission and alpha is of both then
    Rgb emission{};
    Rgb specular_tint{1, 1, 1};
    std::uint32_t specular_tint_texture = no_index;
    float alpha = 1, alpha_cutoff = 0;
    std::uint32_t medium = 0;  ///< in MediaTables: what a solid of it is filled with; 0: it is no solid
    /// The same for what goes in by the subsurface, which may be another one than for what is refracted; 0: none.
    std::uint32_t subsurface_medium = 0;

    bool has_inside() const { return medium != 0 || subsurface_medium != 0; }
    std::uint32_t alpha_mode = 0;  ///< AlphaMode
    NumberRecord bump;             ///< height above the surface, in render space
    std::uint32_t roughness_texture = no_index, metallic_texture = no_index, emission_texture = no_index,
                  alpha_texture = no_index;
    std::uint32_t roughness_channel = 1, metallic_channel = 2, alpha_channel = 3;

    /// The record's first words, which are read at once.
    static constexpr int row_words = 12;
};

struct RampStopRecord {
    float position = 0;
    Rgb color{};
};

struct ShadingTables {
    std::vector<MaterialRecord> materials;
    std::vector<LayersRecord> layers;
    std::vector<DisneyRecord> disney;
    std::vector<MeasuredRecord> measured;
    LargeVector<float> measured_values;
    std::vector<MixtureRecord> mixtures;
    std::vector<TextureRecord> textures;
    std::vector<RampStopRecord> ramp_stops;
    std::vector<TextureSpaceRecord> texture_spaces;
    LargeVector<float> texels;  ///< of images in four floats a texel: what no other format holds
    std::vector<std::vector<std::uint32_t>> packed_images;  ///< of the others, image by image
    std::array<float, 256> linear_of_srgb{};
};

}  // namespace fathom
