#pragma once
/// The scene as the kernel reads it: flat arrays of plain numbers, no names, no pointers between them but indices.
///
/// Render space: world space moved so that the camera (at compile time) is the origin, then scaled by a power of two so
/// that the scene's radius is about 1024: floats then serve scenes of any size anywhere. Radiance does not depend on
/// the scale; point lights do, and are scaled when compiled.
///
/// Primitives are numbered through: triangles first, then quads, spheres, disks, segments of curves, points. A hit
/// names a primitive, and an instance where the primitive was reached through one.
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "fathom/vector.h"

namespace fathom {

inline constexpr int channels = 3;
inline constexpr std::uint32_t no_index = 0xffffffffu;

using SpectrumTable = std::array<float, channels>;

// ------------------------------------------------------------------------------------------------ geometry

/// A parallelogram; its normal is along cross(edge_u, edge_v).
struct QuadTable {
    Vec3f corner, edge_u, edge_v;
};
struct SphereTable {
    Vec3f center, motion;  ///< center + time * motion
    float radius = 1;      ///< negative: the normal points inwards
};
struct DiskTable {
    Vec3f center, normal;
    float radius = 1;
};

/// A segment of a curve, cut into straight pieces: see geometry/curve.h.
struct CurveTable {
    std::uint32_t first_point = 0;  ///< in curve_points, of four or, if linear, two
    std::uint32_t pieces = 1;       ///< a power of 2, at most max_pieces
    float u0 = 0, u1 = 1;           ///< where along the curve it begins and ends
    static constexpr std::uint32_t max_pieces = 32, max_segments = 1u << 27;
};

/// What the primitives of one shape share.
struct ShapeTable {
    enum Flags : std::uint32_t {
        has_normals = 1,
        has_uv0 = 2,
        has_uv1 = 4,
        has_tangents = 8,
        has_colors = 16,
        alpha_tested = 32,    ///< a ray may pass through: the material's alpha decides
        flipped = 64,         ///< the geometric normal is turned round (mirroring transform)
        linear_curves = 256,  ///< segments are lines: two points each, not four
        ribbons = 512,        ///< curves are flat and turned towards each ray, not round
        placed = 128,         ///< its primitives stand where instances put them, and nowhere else
    };
    std::uint32_t material = 0;
    std::uint32_t flags = 0;
    std::uint32_t first_primitive = 0;
    std::uint32_t light_base = no_index;  ///< light of its first primitive; the others follow
    std::uint32_t object_id = 0;          ///< for the instance id AOV, of what stands in the world
    /// Vertices of the mesh if they move, else 0: vertex v is v + k * moving_vertices at vertex_times[k].
    std::uint32_t moving_vertices = 0;
};

/// A shape placed once more, or one that moves: its primitives live in their own space.
struct InstanceTable {
    std::array<float, 12> object_from_render{};  ///< rows of an affine map; not used if it moves
    std::uint32_t shape = 0;                     ///< material and flags; instances that agree in them share one
    std::uint32_t mesh_shape = 0;                ///< the shape whose primitives it places
    std::uint32_t object_id = 0;                 ///< instead of the shape's
    std::uint32_t poses = 0;                     ///< if it moves: how many in the low byte, above it the first of them

    static constexpr std::uint32_t most_poses = 255, most_first_pose = (1u << 24) - 1;
    std::uint32_t pose_count() const { return poses & 255; }
    std::uint32_t first_pose() const { return poses >> 8; }
};
static_assert(sizeof(InstanceTable) == 64);

/// Where a moving instance is at a time, as translation * rotation * stretch. Up to the next pose the first and the
/// last change linearly, and the rotation turns by the angle (quaternions: Shoemake 1985, "Animating Rotation with
/// Quaternion Curves").
struct PoseTable {
    float time = 0;
    float translation[3] = {};
    float rotation[4] = {};  ///< x, y, z, w; those of neighbours have a dot product of at least 0
    float stretch[6] = {};   ///< xx, xy, xz, yy, yz, zz of a symmetric matrix
    float turns = 0;         ///< the angle between the quaternions, in full turns
    float inverse_sine = 0;  ///< of it; 0 where it is too small to matter: linear then
};
static_assert(sizeof(PoseTable) == 64);

// ------------------------------------------------------------------------------------------------ materials

enum class BsdfKind : std::uint32_t {
    none,  ///< black, or only emits
    diffuse,
    metal,  ///< GGX conductor; alpha 0 is a mirror
    fuzz_metal,
    glass,
    principled,
    count
};

/// How an image's texels lie in memory. Each format is taken only where it holds every value exactly.
enum class TexelFormat : std::uint32_t {
    float4,      ///< four floats, in SceneTables::texels
    bytes,       ///< one word of packed_images: red in the lowest byte, alpha in the highest, 255 is 1
    bytes_srgb,  ///< the same, but red, green and blue are sRGB codes, decoded by SceneTables::linear_of_srgb
    halves,      ///< two words: red and green, blue and alpha; the lower half first
    shorts,      ///< the same with 16-bit integers, 65535 is 1
};

struct TextureTable {
    std::uint32_t kind = 0;  ///< TextureKind
    // image: format, offset into texels (in fours) or number among packed_images, size, wrap modes
    std::uint32_t format = 0;  ///< TexelFormat
    std::uint64_t texels = 0;
    int width = 0, height = 0;
    std::uint32_t wrap_u = 0, wrap_v = 0, nearest = 0;
    std::uint32_t uv_set = 0;
    std::array<float, 6> uv_map{1, 0, 0, 0, 1, 0};  ///< two rows: texture uv from mesh uv
    float scale = 1, turbulence_weight = 0;
    std::uint32_t octaves = 7;
    std::array<float, 4> color_a{}, color_b{};
};

struct MaterialTable {
    enum Flags : std::uint32_t {
        textured = 1,
        normal_mapped = 2,
        vertex_colored = 4,
        emits = 8,
        two_sided_emission = 16,
        unlit = 32 /* shows its emission, but lights nothing */,
        thin = 64
    };
    std::uint32_t bsdf = 0;  ///< BsdfKind
    std::uint32_t flags = 0;
    SpectrumTable base_color{};
    SpectrumTable emission{};
    SpectrumTable absorption{};  ///< per unit of render space, inside
    float roughness = 0, metallic = 0, ior = 1.5f, fuzz = 0, normal_scale = 1;
    float alpha = 1, alpha_cutoff = 0;
    std::uint32_t alpha_mode = 0;  ///< AlphaMode
    std::uint32_t base_texture = no_index, roughness_texture = no_index, metallic_texture = no_index,
                  emission_texture = no_index, normal_texture = no_index, alpha_texture = no_index;
    std::uint32_t roughness_channel = 1, metallic_channel = 2, alpha_channel = 3;
};

// ------------------------------------------------------------------------------------------------ lights

enum class LightTableKind : std::uint32_t {
    rectangle,
    parallelogram,
    triangle,
    sphere,
    disk,
    point,
    spot,
    directional,
    environment
};

/// One light, or one emissive primitive. Read by lanes as an array of 32 floats.
struct LightTable {
    std::uint32_t kind = 0;
    float pmf = 0;           ///< probability to be chosen
    float position[3] = {};  ///< corner, centre, or place
    float edge_u[3] = {};    ///< rectangle: unit along u; spot, directional: direction that light travels
    float edge_v[3] = {};    ///< rectangle: unit along v
    float normal[3] = {};
    float length_u = 0, length_v = 0;
    float area = 0;
    float radius = 0;               ///< rectangle: its diagonal
    float radiance[channels] = {};  ///< or intensity, or irradiance
    float cos_inner = 0, cos_outer = 0;
    std::uint32_t two_sided = 0;
    std::uint32_t material = no_index;  ///< whose emission texture or alpha scales radiance, if it has one
    std::uint32_t primitive = no_index;
    float motion[3] = {};
    float center[3] = {};  ///< of a rectangle
};
static_assert(sizeof(LightTable) == 32 * sizeof(float));

struct EnvironmentTable {
    std::uint32_t kind = 0;  ///< EnvironmentKind
    std::uint32_t light = no_index;
    SpectrumTable color{}, bottom{}, top{};
    std::array<float, 9> environment_from_render{1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::uint64_t texels = 0;
    int width = 0, height = 0;
    /// Image: cumulative distributions for sampling, rows then columns: (height + 1) and height * (width + 1) floats.
    std::vector<float> marginal, conditional;
};

// ------------------------------------------------------------------------------------------------ camera

struct CameraTable {
    std::uint32_t orthographic = 0;
    float position[3] = {};
    float right[3] = {}, up[3] = {}, forward[3] = {};  ///< unit
    float half_width = 1, half_height = 1;  ///< at distance 1 (perspective), or in render space (orthographic)
    float lens_radius = 0, focus_distance = 1;
    float shutter_open = 0, shutter_close = 0;
};

// ------------------------------------------------------------------------------------------------ all of it

struct SceneTables {
    // Per vertex of all meshes; arrays that no mesh needs are empty.
    std::vector<Vec3f> positions, normals;
    std::vector<Vec4f> tangents, colors;
    std::vector<Vec2f> uv0, uv1;
    std::vector<std::uint32_t> triangles;  ///< three vertex indices each
    std::vector<QuadTable> quads;
    std::vector<SphereTable> spheres;
    std::vector<DiskTable> disks;
    std::vector<CurveTable> curves;
    std::vector<Vec4f> curve_points;  ///< place and radius; segments of a cubic curve share their ends
    std::vector<Vec4f> points;        ///< balls: centre and radius
    std::vector<std::uint32_t> shape_of_primitive;
    std::vector<ShapeTable> shapes;
    std::vector<InstanceTable> instances;
    std::vector<PoseTable> poses;
    /// Times at which vertices are given, from when the shutter opens until it closes; empty if none move.
    std::vector<float> vertex_times;
    std::uint32_t world_triangles = 0;  ///< triangles of [0, world_triangles) are in render space; the rest are placed
    std::vector<MaterialTable> materials;
    std::vector<TextureTable> textures;
    std::vector<float> texels;  ///< of images in four floats a texel: environments, and what no other format holds
    std::vector<std::vector<std::uint32_t>> packed_images;  ///< of the others, image by image
    std::array<float, 256> linear_of_srgb{};
    std::vector<LightTable> lights;
    std::vector<float> light_cdf;  ///< lights + 1 values, 0 to 1
    EnvironmentTable environment;
    float shutter_open = 0, shutter_close = 0;  ///< of the camera that the scene was compiled for
    Vec3d origin;                               ///< world position of render space's origin
    double render_scale = 1;                    ///< render units per world unit: a power of two
    bool moving = false;

    std::uint32_t triangle_count() const { return std::uint32_t(triangles.size() / 3); }
    std::uint32_t first_quad() const { return triangle_count(); }
    std::uint32_t first_sphere() const { return first_quad() + std::uint32_t(quads.size()); }
    std::uint32_t first_disk() const { return first_sphere() + std::uint32_t(spheres.size()); }
    std::uint32_t first_curve() const { return first_disk() + std::uint32_t(disks.size()); }
    std::uint32_t first_point() const { return first_curve() + std::uint32_t(curves.size()); }
    std::uint32_t primitive_count() const { return first_point() + std::uint32_t(points.size()); }
};

}  // namespace fathom
