// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Materials and textures as the kernel reads them: fixed-size records that refer to each other by index.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include "base/enum_set.h"
#include "base/large_memory.h"
#include "base/no_index.h"
#include "materials/closures/records.h"
#include "math/rgb.h"

namespace fathom {

/// Memory layout of an image's texels. Each image takes the smallest format that holds every value exactly.
enum class TexelFormat : std::uint32_t {
    float4,      ///< four floats per texel, in ShadingTables::texels
    bytes,       ///< one word of packed_images per texel: red in the lowest byte, alpha in the highest; 255 is 1
    bytes_srgb,  ///< like bytes, but red, green and blue are sRGB codes, decoded by ShadingTables::linear_of_srgb
    halves,      ///< two words of halves per texel: red and green, blue and alpha; the lower half first
    shorts,      ///< two words of 16-bit integers per texel, in the order of halves; 65535 is 1
};

/// A texture node of any kind; each kind reads only the members it needs.
struct TextureRecord {
    std::uint32_t kind = 0;  ///< value of TextureKind
    // Members of image textures: texel format, offset into ShadingTables::texels (in units of four floats) or index
    // into packed_images, size in texels, wrap modes.
    std::uint32_t format = 0;  ///< value of TexelFormat
    std::uint64_t texels = 0;
    int width = 0, height = 0;
    std::uint32_t wrap_u = 0, wrap_v = 0, nearest = 0;
    std::uint32_t uv_set = 0;
    std::array<float, 6> uv_map{1, 0, 0, 0, 1, 0};  ///< two rows of an affine map: texture uv from mesh uv
    std::uint32_t mapping = 0;                      ///< value of TextureMapping
    std::uint32_t space = no_index;                 ///< index into ShadingTables::texture_spaces; no_index: world space
    float scale = 1, turbulence_weight = 0, gain = 0.5f;
    std::array<float, 3> direction{0, 1, 0};  ///< direction of facing textures; unit vector
    std::uint32_t octaves = 7;
    std::array<float, 4> color_a{}, color_b{};
    std::uint32_t texture_a = no_index, texture_b = no_index;  ///< textures that multiply color_a and color_b
    float factor = 1;
    std::uint32_t factor_texture = no_index, factor_channel = 0;
    std::uint32_t first_stop = 0, stop_count = 0;
};

/// Affine map of a procedural texture: rows of texture space from world space.
struct TextureSpaceRecord {
    std::array<std::array<float, 4>, 3> rows{};
};

/// A scalar parameter: a constant multiplied by one channel of a texture, if there is one.
struct NumberRecord {
    float value = 0;
    std::uint32_t texture = no_index, channel = 0;
};
/// A color parameter: a constant multiplied by a texture, if there is one.
struct ColorRecord {
    Rgb value{};
    std::uint32_t texture = no_index;
};

/// Parameters of LayeredBsdf beyond those of PrincipledRecord.
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
        two_roughnesses = 8192,  ///< set if anisotropy holds the roughness along the tangent
        with_conductor = 16384,
        textured = 32768  ///< set if at least one parameter of this record has a texture
    };
    std::uint32_t features = 0;
    NumberRecord specular, anisotropy, transmission, diffuse_transmission, diffuse_roughness, coat, coat_roughness,
        sheen_roughness, thin_film, thin_film_thickness, subsurface, subsurface_radius;
    ColorRecord specular_color, edge_color, transmission_color, diffuse_transmission_color, coat_color, sheen_color,
        subsurface_color, subsurface_radius_scale;
    Rgb conductor_eta{}, conductor_k{};
    float anisotropy_cos = 1, anisotropy_sin = 0;
    float dispersion = 0;
    /// coat_f0: reflectance of the coat at normal incidence. coat_inner: its internal reflectance for diffuse light
    /// from below. See LayeredBsdf.
    float coat_f0 = 0, coat_inner = 0, coat_darkening = 0, coat_normal_scale = 1;
    float thin_film_ior = 1;
    std::uint32_t anisotropy_texture = no_index, coat_normal_texture = no_index;
};

/// Parameters of DisneyBsdf beyond those of PrincipledRecord.
struct DisneyRecord {
    enum Features : std::uint32_t { anisotropic = 1, textured = 2 /* any of the parameters here */ };
    std::uint32_t features = 0;
    NumberRecord anisotropy, flatness, specular_tint, sheen, sheen_tint, coat, coat_gloss, transmission,
        diffuse_transmission;
};

/// Location of a table of values over the unit square in ShadingTables::measured_values. See MeasuredTable.
struct MeasuredTableRecord {
    std::uint32_t first = 0, width = 0, height = 0;
};

/// A measured BRDF: see measured_tables.h, and MeasuredBrdf in the scene description.
struct MeasuredRecord {
    std::uint32_t theta = 0, theta_count = 0, phi = 0, phi_count = 0;  ///< indices of the angles in measured_values,
                                                                       ///< and their counts
    /// Symmetry of the surface, as the number of equivalent directions for each measured one: 1 (none), 2 (rotation by
    /// half a turn), or 4 (mirror images in both axes).
    std::uint32_t symmetry = 1;
    std::uint32_t color_is_per_facet = 1;
    MeasuredTableRecord ndf, sigma, vndf, luminance, color;
    std::uint32_t unused[3] = {};  ///< padding, since RecordRow reads four words at a time
};

/// A material that is one of two others at each intersection.
struct MixtureRecord {
    std::uint32_t first = 0, second = 0;  ///< indices into ShadingTables::materials
    std::uint32_t by_side = 0;            ///< 1: `first` on the front, `second` on the back; 0: chosen at random
    NumberRecord factor;                  ///< probability of the second material
};

/// A feature of a material that does not depend on its closure.
enum class MaterialFeature : std::uint32_t {
    textured,  ///< the color or a number of the closure's record has a texture or vertex colors
    normal_mapped,
    vertex_colored,
    emits,
    two_sided_emission,
    unlit,  ///< visible to camera and mirror rays, but does not illuminate other surfaces
    thin,
    needs_tangent,    ///< needs the surface's tangent, for normal maps or anisotropy
    single_sided,     ///< camera rays pass through the back
    one_sided,        ///< the back reflects nothing
    absorbing_fiber,  ///< base_color is the absorption of a fiber over its radius; requires a HairRecord
    bumped,           ///< bump mapped: shading normals are tilted by the slope of `bump`
    /// needs texture coordinates although not `textured`: hair, emission maps, and textures of records in other tables
    needs_uv,
    index_matched_boundary,  ///< boundary of a solid of index 1, which only separates media
    pane,                    ///< smooth thin glass, which shadow rays pass
    hidden_from_camera,
    invisible_light,  ///< emits, but rays pass through it
    map_tangents,     ///< tangents follow the texture coordinates of each map instead of the mesh's first set
    subsurface        ///< light passes into a subsurface medium; the closure has a LayersRecord
};

using MaterialFeatures = EnumSet<MaterialFeature>;
constexpr MaterialFeatures operator|(MaterialFeature a, MaterialFeature b)
{
    return MaterialFeatures(a) | MaterialFeatures(b);
}

/// A material: the members that all materials have, and the parameters of its closure.
struct MaterialRecord {
    // The members up to the first words of `parameters` are read together for each vertex of a path: see row_words.
    MaterialFeatures features;
    Rgb base_color{};  ///< reflectance; glass: transmittance; see also MaterialFeature::absorbing_fiber
    std::uint32_t base_texture = no_index, normal_texture = no_index;
    float normal_scale = 1;
    /// The closure's own record (closures/records.h), as words; see set_parameters().
    std::array<std::uint32_t, 11> parameters{};

    ClosureKind closure = ClosureKind::none;
    std::uint32_t mixture = no_index;  ///< index into ShadingTables::mixtures; only emission and alpha of this record
                                       ///< apply then
    Rgb emission{};
    std::uint32_t emission_texture = no_index;
    std::uint32_t alpha_mode = 0;  ///< value of AlphaMode
    float alpha = 1, alpha_cutoff = 0;
    std::uint32_t alpha_texture = no_index, alpha_channel = 3;
    NumberRecord bump;         ///< height above the surface, in render space
    std::uint32_t medium = 0;  ///< index into MediaTables: interior of a solid; 0: not a solid
    /// Index of the medium that light enters through the subsurface lobe, which may differ from the one that refracted
    /// light enters; 0: none.
    std::uint32_t subsurface_medium = 0;

    bool has_inside() const { return medium != 0 || subsurface_medium != 0; }

    /// Number of leading words of the record that MaterialReader loads in one pass. They include the first five words
    /// of `parameters`.
    static constexpr int row_words = 12;

    /// Stores the record of the closure.
    template <class Record>
    void set_parameters(const Record& record)
    {
        static_assert(sizeof(Record) <= sizeof(parameters) && std::is_trivially_copyable_v<Record>);
        std::memcpy(parameters.data(), &record, sizeof record);
    }
    /// Returns the record of the closure, whose type must be Record.
    template <class Record>
    Record parameters_as() const
    {
        static_assert(sizeof(Record) <= sizeof(parameters) && std::is_trivially_copyable_v<Record>);
        Record record;
        std::memcpy(&record, parameters.data(), sizeof record);
        return record;
    }
};

static_assert(offsetof(MaterialRecord, parameters) == 4 * (MaterialRecord::row_words - 5));

/// One stop of a color ramp: position in [0, 1] and color.
struct RampStopRecord {
    float position = 0;
    Rgb color{};
};

/// All materials and textures of a scene. Members of records are indices into these arrays.
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
    LargeVector<float> texels;                              ///< images of format float4
    std::vector<std::vector<std::uint32_t>> packed_images;  ///< images of all other formats, one vector each
    std::array<float, 256> linear_of_srgb{};
};

}  // namespace fathom
