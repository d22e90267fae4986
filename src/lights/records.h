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
    curve,     ///< a segment: its geometry is in the tables of curves
    pictured,  ///< as a spot, multiplied by a picture
    beam,      ///< parallel light through an area
};

/// How a picture lies over the directions in which a light shines.
enum class LightPictureMap : std::uint32_t {
    plane,       ///< as seen through a window across the axis
    equal_area,  ///< a square, as pbrt-v4 has it, with the axis in its middle
    angles,      ///< rows by the angle from the axis, columns by that about it, with values at rows and columns
};

/// By what a light's intensity is multiplied in each direction. Read by lanes as 8 words.
struct LightPictureRecord {
    enum Flags : std::uint32_t { nearest = 1, flat_field = 2 };
    std::uint32_t map = 0;    ///< LightPictureMap
    std::uint32_t flags = 0;  ///< some of Flags; flat_field: over the cube of the cosine to the axis
    std::uint32_t first = 0;  ///< texel, of LightTables::picture_texels
    float width = 0, height = 0;
    float scale_u = 0, scale_v = 0;  ///< plane: of tangents, to half of the picture; angles: texels a radian
    float start = 0;                 ///< angles: radians from the axis of the first row
};
static_assert(sizeof(LightPictureRecord) == 8 * sizeof(float));

/// One light, or one emissive primitive. Read by lanes as an array of 32 floats.
struct LightRecord {
    enum Flags : std::uint32_t {
        two_sided = 1,
        unseen = 2,  ///< no ray meets it: its samples count in full
    };
    enum Motion : std::uint32_t {
        vertices_move = 1,  ///< a triangle whose corners are where they then are
        placed = 2,         ///< the numbers are those of the instance's own space, which moves, or whose vertices do
        has_poses = 4,      ///< point, spot, pictured, beam: `instance` is a word like InstanceRecord::poses
        flipped = 8,        ///< the normal is against cross(edge_u, edge_v)
    };
    std::uint32_t kind = 0;
    float pmf = 0;           ///< probability to be chosen
    float position[3] = {};  ///< corner, centre, or place
    float edge_u[3] = {};    ///< rectangle: unit along u; spot, pictured, directional: direction that light travels
    float edge_v[3] = {};    ///< rectangle: unit along v; pictured: to the picture's right
    float normal[3] = {};    ///< pictured: to its top; beam: direction that light travels
    float length_u = 0, length_v = 0;  ///< spot: u is 1 where the falloff is a smooth step, 0 where it is a square
    float area = 0;                    ///< spot whose falloff is linear: 1 over the angle that it takes
    float radius = 0;               ///< rectangle: its diagonal; spot whose falloff is linear: the outer angle; else 0;
                                    ///< beam: 1 if it is round
    float radiance[channels] = {};  ///< or intensity, or irradiance
    float outer = 0;                ///< spot, pictured: 1 - cos of the half angle beyond which nothing arrives
    float falloff = 0;              ///< from there inwards, in the same measure, the light grows to its full intensity
    std::uint32_t flags = 0;        ///< some of Flags
    std::uint32_t material = no_index;    ///< whose emission texture or alpha scales radiance, if it has one
    std::uint32_t primitive = no_index;   ///< pictured: the number of its picture
    std::uint32_t instance = no_index;    ///< that places the primitive, if one does; with has_poses, those poses
    float motion_or_center[3] = {};       ///< sphere: its motion in a second; rectangle: its centre
    std::uint32_t tree_place = no_index;  ///< of it in the light tree: node * LightNode::width + slot
    std::uint32_t motion = 0;             ///< some of Motion; 0: stands still, or is a sphere on a straight way
};
static_assert(sizeof(LightRecord) == 32 * sizeof(float));

/// A node of the tree over all lights that have a place: bounds of its children, in columns that lanes read. Children
/// beyond `count` have intensity 0.
struct alignas(64) LightNode {
    static constexpr int width = 16;
    using Column = float[width];

    Column x, y, z, radius;           ///< ball around all that shines
    Column axis_x, axis_y, axis_z;    ///< middle of the normals, or of what a spot shines into
    Column cos_normals, sin_normals;  ///< how far they are from the axis at most
    Column cos_emission;              ///< how far from its normal anything shines at most
    Column back;                      ///< -1 if something shines to its back too, else 1
    Column intensity;                 ///< the most that goes in a direction, added up; 1 for the whole tree
    std::uint32_t child[width];       ///< a light if is_light is set, else a node
    std::uint32_t count = 0;          ///< of children
    std::uint32_t parent = no_index;  ///< the node's place in its parent, as LightRecord::tree_place
    bool has_narrow = false;          ///< some cos_emission is above 0
    static constexpr std::uint32_t is_light = 1u << 31;
};

struct EnvironmentRecord {
    std::uint32_t kind = 0;  ///< EnvironmentKind
    std::uint32_t light = no_index;
    Rgb color{}, bottom{}, top{};
    std::array<float, 9> environment_from_render{1, 0, 0, 0, 1, 0, 0, 0, 1};
    LargeVector<float> texels;  ///< of an image: four floats each
    int width = 0, height = 0;
    double mean_luminance = 0;  ///< of an image that lights are sampled from; else 0
    /// Of such an image: a direction that is sampled with a density brings about this much, and so many times the
    /// density.
    float even_luminance = 0, sampled_luminance = 0;
    /// Image: cumulative distributions for sampling, rows then columns: (height + 1) and height * (width + 1) floats.
    LargeVector<float> marginal, conditional;
    LargeVector<std::uint32_t> marginal_guide, conditional_guides;  ///< see make_guides
};

struct LightTables {
    std::vector<LightRecord> lights;
    std::vector<float> light_cdf;       ///< lights + 1 values, 0 to 1
    LargeVector<LightNode> light_tree;  ///< over the first `placed_lights`; node 0 is the root
    std::uint32_t placed_lights = 0;    ///< those that have a place come first: all but directions and environments
    EnvironmentRecord environment;
    std::vector<LightPictureRecord> light_pictures;
    LargeVector<float> picture_texels;  ///< of lights: four floats each, linear, none below 0
};

}  // namespace fathom
