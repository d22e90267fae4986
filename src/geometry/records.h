#pragma once
/// Geometry as the kernel reads it: flat arrays of plain numbers, no names, no pointers between them but indices.
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

#include "base/large_memory.h"
#include "base/no_index.h"
#include "fathom/vector.h"

namespace fathom {

/// A parallelogram; its normal is along cross(edge_u, edge_v).
struct QuadRecord {
    Vec3f corner, edge_u, edge_v;
};
struct SphereRecord {
    Vec3f center, motion;  ///< center + time * motion
    float radius = 1;      ///< negative: the normal points inwards
};
struct DiskRecord {
    Vec3f center, normal;
    float radius = 1;
};

/// A segment of a curve, cut into straight pieces: see geometry/curve.h.
struct CurveRecord {
    std::uint32_t first_point = 0;  ///< in curve_points, of four or, if linear, two
    std::uint32_t pieces = 1;       ///< a power of 2, at most max_pieces
    float u0 = 0, u1 = 1;           ///< where along the curve it begins and ends
    static constexpr std::uint32_t max_pieces = 32, max_segments = 1u << 27, max_points = 1u << 29;
};

/// What the primitives of one shape share.
struct ShapeRecord {
    enum Flags : std::uint32_t {
        has_normals = 1,
        has_uv0 = 2,
        has_uv1 = 4,
        has_tangents = 8,
        has_colors = 16,
        alpha_tested = 32,     ///< a ray may pass through: the material's alpha decides
        flipped = 64,          ///< the geometric normal is turned round (mirroring transform)
        linear_curves = 256,   ///< segments are lines: two points each, not four
        ribbons = 512,         ///< curves are flat and turned towards each ray, not round
        solid_curves = 1024,   ///< rays meet them from inside, too
        fibers = 2048,         ///< round curves that rays leave from within without meeting them
        only_instanced = 128,  ///< its primitives stand where instances put them, and nowhere else
    };
    std::uint32_t material = 0;
    std::uint32_t flags = 0;
    std::uint32_t first_primitive = 0;
    std::uint32_t light_base = no_index;  ///< light of its first primitive; the others follow
    std::uint32_t object_id = 0;          ///< for the instance id AOV, of what stands in the world
    std::uint32_t frame = no_index;       ///< in frames: how round primitives are turned, where their uv show it
    /// Vertices of the mesh, or points of the curves in curve_points, if they move, else 0: vertex v is
    /// v + k * moving_vertices at vertex_times[k].
    std::uint32_t moving_vertices = 0;
};

/// A shape placed once more, or one that moves: its primitives live in their own space.
struct InstanceRecord {
    std::array<float, 12> object_from_render{};  ///< rows of an affine map; not used if it moves
    std::uint32_t shape = 0;                     ///< material and flags; instances that agree in them share one
    std::uint32_t mesh_shape = 0;                ///< the shape whose primitives it places
    std::uint32_t object_id = 0;                 ///< instead of the shape's
    std::uint32_t poses = 0;                     ///< if it moves: how many in the low byte, above it the first of them

    static constexpr std::uint32_t max_poses = 255, max_first_pose = (1u << 24) - 1;
    std::uint32_t pose_count() const { return poses & 255; }
    std::uint32_t first_pose() const { return poses >> 8; }
};
static_assert(sizeof(InstanceRecord) == 64);

/// Where a moving instance is at a time, as translation * rotation * stretch. Up to the next pose the first and the
/// last change linearly, and the rotation turns by the angle (quaternions: Shoemake 1985, "Animating Rotation with
/// Quaternion Curves").
struct PoseRecord {
    float time = 0;
    float translation[3] = {};
    float rotation[4] = {};  ///< x, y, z, w; those of neighbours have a dot product of at least 0
    float stretch[6] = {};   ///< xx, xy, xz, yy, yz, zz of a symmetric matrix
    float turns = 0;         ///< the angle between the quaternions, in full turns
    float inverse_sine = 0;  ///< of it; 0 where it is too small to matter: linear then
};
static_assert(sizeof(PoseRecord) == 64);

/// All shapes, and where they stand.
struct GeometryTables {
    // Per vertex of all meshes; arrays that no mesh needs are empty.
    LargeVector<Vec3f> positions, normals;
    LargeVector<Vec4f> tangents, colors;
    LargeVector<Vec2f> uv0, uv1;
    LargeVector<std::uint32_t> triangles;  ///< three vertex indices each
    std::vector<QuadRecord> quads;
    std::vector<SphereRecord> spheres;
    std::vector<DiskRecord> disks;
    std::vector<CurveRecord> curves;
    std::vector<Vec4f> curve_points;           ///< place and radius; segments of a cubic curve share their ends
    std::vector<Vec4f> points;                 ///< balls: centre and radius
    std::vector<std::array<float, 9>> frames;  ///< rows of rotations from here to a node's space
    LargeVector<std::uint32_t> shape_of_primitive;
    std::vector<ShapeRecord> shapes;
    std::vector<InstanceRecord> instances;
    std::vector<PoseRecord> poses;
    /// Times at which vertices and points of curves are given, from when the shutter opens until it closes; empty if
    /// none move.
    std::vector<float> vertex_times;
    std::uint32_t world_triangles = 0;          ///< triangles of [0, world_triangles) are in render space; the rest are
                                                ///< reached through instances
    float shutter_open = 0, shutter_close = 0;  ///< of the camera that the scene was compiled for
    Vec3d origin;                               ///< world position of render space's origin
    double render_scale = 1;                    ///< render units per world unit: a power of two
    bool moving = false;
    /// Instances of [0, still_instances) stay where they are; others may move later, if the scene is `editable`.
    std::uint32_t still_instances = 0;
    bool editable = false;

    std::uint32_t triangle_count() const { return std::uint32_t(triangles.size() / 3); }
    std::uint32_t first_quad() const { return triangle_count(); }
    std::uint32_t first_sphere() const { return first_quad() + std::uint32_t(quads.size()); }
    std::uint32_t first_disk() const { return first_sphere() + std::uint32_t(spheres.size()); }
    std::uint32_t first_curve() const { return first_disk() + std::uint32_t(disks.size()); }
    std::uint32_t first_point() const { return first_curve() + std::uint32_t(curves.size()); }
    std::uint32_t primitive_count() const { return first_point() + std::uint32_t(points.size()); }
};

}  // namespace fathom
