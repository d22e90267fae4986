// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Lights as the kernel reads them. The records of the kinds are in lights/kinds/records.h.
#include <array>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include "base/large_memory.h"
#include "base/no_index.h"
#include "fathom/render.h"
#include "math/rgb.h"

namespace fathom {

/// Mapping from the directions of a light to its image.
enum class LightPictureMap : std::uint32_t {
    plane,       ///< perspective projection along the axis
    equal_area,  ///< equal-area square as in pbrt-v4, with the axis at its center
    angles,  ///< rows by angle from the axis, columns by angle about it; values are at the rows and columns themselves
};

/// Image that multiplies a light's intensity by direction. Lanes read it as 8 words.
struct LightPictureRecord {
    enum Flags : std::uint32_t { nearest = 1, flat_field = 2 };
    std::uint32_t map = 0;  ///< one of LightPictureMap
    std::uint32_t flags =
        0;  ///< combination of Flags; flat_field: the image is divided by the cubed cosine to the axis
    std::uint32_t first = 0;  ///< index of the first texel in LightTables::picture_texels
    float width = 0, height = 0;
    float scale_u = 0, scale_v = 0;  ///< plane: factor from tangents to half images; angles: texels per radian
    float start = 0;                 ///< angles: angle from the axis of the first row, radians
};
static_assert(sizeof(LightPictureRecord) == 8 * sizeof(float));

/// A light, or an emissive primitive: members that all kinds have, around the record of its kind. Lanes read it as an
/// array of 32 words.
struct LightRecord {
    enum Flags : std::uint32_t {
        two_sided = 1,
        not_hit_by_rays = 2,  ///< no ray hits the light, so its MIS weight is 1
    };
    enum Motion : std::uint32_t {
        vertices_move = 1,  ///< a triangle whose vertices move
        placed = 2,         ///< the geometry is in the space of an instance that moves or whose vertices move
        has_poses = 4,      ///< a light without a surface: `instance` has the format of InstanceRecord::poses, and the
                            ///< record of its kind is in the space of its node
        flipped = 8,        ///< a triangle's normal is opposite to cross(edge_u, edge_v)
    };
    static constexpr std::size_t own_words = 21;  ///< size of the record of a kind

    std::uint32_t kind = 0;              ///< one of LightRecordKind
    float pmf = 0;                       ///< probability of selection by power
    std::array<float, own_words> own{};  ///< bits of the record of its kind, such as RectangleLightRecord
    float radiance[channels] = {};       ///< radiance, intensity or irradiance, depending on the kind
    std::uint32_t flags = 0;             ///< combination of Flags
    std::uint32_t material = no_index;   ///< material whose emission texture or alpha scales radiance, or no_index
    std::uint32_t primitive = no_index;  ///< primitive that emits, or no_index
    std::uint32_t instance =
        no_index;  ///< instance of the primitive, or no_index; with has_poses: the poses of the light
    std::uint32_t tree_place =
        no_index;  ///< position in the light tree: node * LightNode::width + slot; no_index outside the tree
    std::uint32_t motion = 0;  ///< combination of Motion; 0: static, or a sphere in linear motion

    /// Sets the kind and the record of the kind.
    template <class Own>
    void set(const Own& record)
    {
        static_assert(std::is_trivially_copyable_v<Own> && sizeof(Own) <= sizeof(own));
        kind = std::uint32_t(Own::kind);
        own = {};
        // The byte of an empty record has no value.
        if constexpr (!std::is_empty_v<Own>) std::memcpy(own.data(), &record, sizeof record);
    }
    /// Returns the record, whose type must be that of the light's kind.
    template <class Own>
    Own get() const
    {
        Own record;
        std::memcpy(&record, own.data(), sizeof record);
        return record;
    }
    template <class Own>
    bool is() const
    {
        return kind == std::uint32_t(Own::kind);
    }
};
static_assert(sizeof(LightRecord) == 32 * sizeof(float));

/// A node of the light tree: bounds of its children, in columns that lanes read. Children beyond `count` have intensity
/// 0.
struct alignas(64) LightNode {
    static constexpr int width = 16;
    using Column = float[width];

    Column x, y, z, radius;           ///< bounding ball of all emitters
    Column axis_x, axis_y, axis_z;    ///< axis of the cone of normals, or of a spot's directions
    Column cos_normals, sin_normals;  ///< largest angle between normals and the axis
    Column cos_emission;              ///< largest angle between emission and normal
    Column back;                      ///< -1 if some emitter is two-sided, else 1
    Column intensity;                 ///< sum of the maximum intensities of all emitters; 1 for the whole tree
    std::uint32_t child[width];       ///< index of a light if is_light is set, else of a node
    std::uint32_t count = 0;          ///< number of children
    std::uint32_t parent = no_index;  ///< position of the node in its parent, as LightRecord::tree_place
    bool has_narrow = false;          ///< some cos_emission is above 0
    static constexpr std::uint32_t is_light = 1u << 31;
};

/// The environment light: constant, gradient, or an equirectangular image with its sampling distribution.
struct EnvironmentRecord {
    std::uint32_t kind = 0;  ///< value of EnvironmentKind
    std::uint32_t light = no_index;
    Rgb color{}, bottom{}, top{};
    std::array<float, 9> environment_from_render{1, 0, 0, 0, 1, 0, 0, 0, 1};
    LargeVector<float> texels;  ///< image: four floats per texel
    int width = 0, height = 0;
    double mean_luminance = 0;  ///< mean luminance of an image that is sampled as a light; else 0
    /// Linear fit for such an image: a direction sampled with density pdf has a luminance of about base_luminance + pdf
    /// * luminance_per_pdf.
    float base_luminance = 0, luminance_per_pdf = 0;
    /// Image: cumulative distributions for sampling, over rows and over the columns of each row: (height + 1) and
    /// height * (width + 1) floats.
    LargeVector<float> marginal, conditional;
    LargeVector<std::uint32_t> marginal_guide, conditional_guides;  ///< guide tables for searches, see make_guides()
};

/// All lights of a scene.
struct LightTables {
    std::vector<LightRecord> lights;
    std::vector<float> light_cdf;         ///< cumulative selection probabilities by power: lights + 1 values, 0 to 1
    LargeVector<LightNode> light_tree;    ///< light tree over the first `positioned_lights` lights; node 0 is the root
    std::uint32_t positioned_lights = 0;  ///< number of lights with a position, which come first: all but directional
                                          ///< lights and the environment
    std::vector<std::uint32_t>
        black_lights;  ///< for each light 1 if its emission texture is black; empty if none is, or all
    EnvironmentRecord environment;
    /// Index in SceneDescription::lights of each light that is not a primitive; no_index for the environment and its
    /// sun. These lights are the last ones.
    std::vector<std::uint32_t> described_lights;
    /// Points whose convex hull contains all static lights that are neither primitives nor infinitely far away.
    std::vector<Vec3f> light_places;
    /// Ball that contains the scene when it is compiled, in render space.
    std::array<float, 3> ball_center{};
    float ball_radius = 1;
    std::vector<LightPictureRecord> light_pictures;
    LargeVector<float> picture_texels;  ///< images of lights: four floats per texel, linear, not negative
};

}  // namespace fathom
