// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Lights as the kernel reads them.
#include <array>
#include <cstdint>
#include <vector>

#include "base/large_memory.h"
#include "base/no_index.h"
#include "fathom/render.h"
#include "math/rgb.h"

namespace fathom {

/// Kind of a light; each has a class in kinds/ that samples it.
enum class LightRecordKind : std::uint32_t {
    rectangle,
    parallelogram,
    triangle,
    sphere,
    disk,
    point,
    spot,
    directional,
    environment,
    curve,     ///< a curve segment: its geometry is in the tables of curves
    pictured,  ///< a spot whose intensity is multiplied by an image
    beam,      ///< parallel light from an area
};

/// Mapping from the directions of a light to its image.
enum class LightPictureMap : std::uint32_t {
    plane,       ///< perspective projection along the axis
    equal_area,  ///< equal-area square as in pbrt-v4, with the axis at its center
    angles,  ///< rows by angle from the axis, columns by angle about it; values are at the rows and columns themselves
};

/// Image that multiplies a light's intensity by direction. Lanes read it as 8 words.
struct LightPictureRecord {
    enum Flags : std::uint32_t { nearest = 1, flat_field = 2 };
    std::uint32_t map = 0;    ///< one of LightPictureMap
    std::uint32_t flags = 0;  ///< some of Flags; flat_field: divided by the cubed cosine to the axis
    std::uint32_t first = 0;  ///< index of the first texel in LightTables::picture_texels
    float width = 0, height = 0;
    float scale_u = 0, scale_v = 0;  ///< plane: from tangents to half of the image; angles: texels per radian
    float start = 0;                 ///< angles: angle from the axis of the first row, radians
};
static_assert(sizeof(LightPictureRecord) == 8 * sizeof(float));

/// A light, or an emissive primitive. Lanes read it as an array of 32 floats. Some kinds store other values in members
/// that they have no use for; the members' comments say which.
struct LightRecord {
    enum Flags : std::uint32_t {
        two_sided = 1,
        not_hit_by_rays = 2,  ///< no ray hits it: MIS weight 1
    };
    enum Motion : std::uint32_t {
        vertices_move = 1,  ///< a triangle whose vertices move
        placed = 2,         ///< geometry is in the space of an instance, which moves or whose vertices do
        has_poses = 4,      ///< point, spot, pictured, beam: `instance` has the format of InstanceRecord::poses
        flipped = 8,        ///< the normal is opposite to cross(edge_u, edge_v)
    };
    std::uint32_t kind = 0;
    float pmf = 0;           ///< probability of selection by power
    float position[3] = {};  ///< corner, center, or position
    float edge_u[3] = {};    ///< rectangle: unit vector along u; spot, pictured, directional: direction of the light's
                             ///< travel
    float edge_v[3] = {};    ///< rectangle: unit vector along v; pictured: towards the image's right
    float normal[3] = {};    ///< pictured: towards the image's top; beam: direction of the light's travel
    float length_u = 0, length_v = 0;  ///< spot: length_u is 1 for smoothstep falloff, 0 for squared falloff
    float area = 0;                    ///< spot with linear falloff: 1 / (outer angle - inner angle)
    float radius = 0;  ///< rectangle: length of its diagonal; directional: 1 - cos of its half angle; spot with linear
                       ///< falloff: the outer angle; beam: 1 if it is elliptical; else 0
    float radiance[channels] = {};  ///< or intensity, or irradiance
    float outer = 0;                ///< spot, pictured: 1 - cos of the half angle of the outer cone
    float falloff = 0;              ///< spot, pictured: width of the falloff inside the outer cone, in units of 1 - cos
    std::uint32_t flags = 0;        ///< some of Flags
    std::uint32_t material = no_index;    ///< material whose emission texture or alpha scales radiance; no_index: none
    std::uint32_t primitive = no_index;   ///< pictured: index into LightTables::light_pictures
    std::uint32_t instance = no_index;    ///< instance of the primitive, or no_index; with has_poses: its poses
    float motion_or_center[3] = {};       ///< sphere: velocity; rectangle: center
    std::uint32_t tree_place = no_index;  ///< position in the light tree: node * LightNode::width + slot
    std::uint32_t motion = 0;             ///< some of Motion; 0: static, or a sphere in linear motion
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
    Column intensity;                 ///< sum of maximum intensities; 1 for the whole tree
    std::uint32_t child[width];       ///< index of a light if is_light is set, else of a node
    std::uint32_t count = 0;          ///< number of children
    std::uint32_t parent = no_index;  ///< position of the node in its parent, as LightRecord::tree_place
    bool has_narrow = false;          ///< some cos_emission is above 0
    static constexpr std::uint32_t is_light = 1u << 31;
};

/// The environment light: constant, gradient, or an equirectangular image with its sampling distribution.
struct EnvironmentRecord {
    std::uint32_t kind = 0;  ///< EnvironmentKind
    std::uint32_t light = no_index;
    Rgb color{}, bottom{}, top{};
    std::array<float, 9> environment_from_render{1, 0, 0, 0, 1, 0, 0, 0, 1};
    LargeVector<float> texels;  ///< image: four floats per texel
    int width = 0, height = 0;
    double mean_luminance = 0;  ///< of an image that is sampled as a light; else 0
    /// Linear fit for such an image: a direction sampled with density pdf has a luminance of about base_luminance + pdf
    /// * luminance_per_pdf.
    float base_luminance = 0, luminance_per_pdf = 0;
    /// Image: cumulative distributions for sampling, over rows and over the columns of each row: (height + 1) and
    /// height * (width + 1) floats.
    LargeVector<float> marginal, conditional;
    LargeVector<std::uint32_t> marginal_guide, conditional_guides;  ///< see make_guides
};

/// All lights of a scene.
struct LightTables {
    std::vector<LightRecord> lights;
    std::vector<float> light_cdf;         ///< cumulative selection probabilities by power: lights + 1 values, 0 to 1
    LargeVector<LightNode> light_tree;    ///< over the first `positioned_lights` lights; node 0 is the root
    std::uint32_t positioned_lights = 0;  ///< number of lights with a position, which come first: all but directional
                                          ///< lights and the environment
    EnvironmentRecord environment;
    std::vector<LightPictureRecord> light_pictures;
    LargeVector<float> picture_texels;  ///< images of lights: four floats per texel, linear, not negative
};

}  // namespace fathom
