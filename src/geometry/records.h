// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Geometry as the kernel reads it: flat arrays of plain numbers that refer to each other by index.
///
/// Render space is world space translated so that the camera (at compile time) is the origin, then scaled by a power of
/// two so that the scene's radius is about 1024: floats then suffice for scenes of any size and position. Radiance does
/// not depend on the scale; point lights do and are scaled when compiled.
///
/// Primitives are numbered consecutively: triangles, quads, spheres, disks, curve segments, points. A hit consists of a
/// primitive, and an instance if the primitive was reached through one.
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
    Vec3f center, motion;  ///< the center at a time is center + time * motion
    float radius = 1;      ///< negative if the normal points inward
};
struct DiskRecord {
    Vec3f center, normal;
    float radius = 1;
};

/// A segment of a curve, divided in straight pieces: see shapes/curve.h.
struct CurveRecord {
    std::uint32_t first_point = 0;  ///< index in curve_points of the first of four control points (two for a line)
    std::uint32_t pieces = 1;       ///< a power of 2, at most max_pieces
    float u0 = 0, u1 = 1;           ///< texture coordinates u at both ends, along the whole curve
    static constexpr std::uint32_t max_pieces = 32, max_segments = 1u << 27, max_points = 1u << 29;
};

/// Properties that the primitives of a shape share.
struct ShapeRecord {
    enum Flags : std::uint32_t {
        has_normals = 1,
        has_uv0 = 2,
        has_uv1 = 4,
        has_tangents = 8,
        has_colors = 16,
        alpha_tested = 32,     ///< the material's alpha decides whether a ray passes
        flipped = 64,          ///< the geometric normal is reversed (mirroring transform)
        linear_curves = 256,   ///< segments are lines: two points each, not four
        ribbons = 512,         ///< curves are flat and face each ray, instead of round
        solid_curves = 1024,   ///< rays from inside hit the curve, too
        fibers = 2048,         ///< round hair: rays that start inside leave without hitting them
        only_instanced = 128,  ///< primitives are seen only through instances
    };
    std::uint32_t material = 0;
    std::uint32_t flags = 0;
    std::uint32_t first_primitive = 0;
    std::uint32_t light_base = no_index;  ///< index of the light of its first primitive; the other primitives follow
    std::uint32_t object_id = 0;          ///< id of primitives that are not instanced, for the instance id AOV
    std::uint32_t frame = no_index;  ///< index in `frames` of the orientation of round primitives; no_index if their
                                     ///< texture coordinates are not used
    /// Number of mesh vertices, or of control points of curves, if they move, else 0. Vertex v at vertex_times[k] is v
    /// + k * moving_vertices.
    std::uint32_t moving_vertices = 0;
};

/// An instance of a shape, static or moving; its primitives are stored in object space.
struct InstanceRecord {
    std::array<float, 12> object_from_render{};  ///< rows of an affine map; unused if the instance moves
    std::uint32_t shape = 0;       ///< index of the shape with material and flags; equal instances share it
    std::uint32_t mesh_shape = 0;  ///< index of the shape whose primitives the instance shows
    std::uint32_t object_id = 0;   ///< replaces the shape's object_id
    std::uint32_t poses = 0;  ///< for a moving instance, the number of poses in the low byte and the index of the first
                              ///< pose above it; else 0

    static constexpr std::uint32_t max_poses = 255, max_first_pose = (1u << 24) - 1;
    std::uint32_t pose_count() const { return poses & 255; }
    std::uint32_t first_pose() const { return poses >> 8; }
};
static_assert(sizeof(InstanceRecord) == 64);

/// Pose of a moving instance, as translation * rotation * stretch. Translation and stretch are interpolated linearly;
/// rotation by quaternions (Shoemake 1985, "Animating Rotation with Quaternion Curves").
struct PoseRecord {
    float time = 0;
    float translation[3] = {};
    float rotation[4] = {};  ///< x, y, z, w; successive quaternions have a nonnegative dot product
    float stretch[6] = {};   ///< xx, xy, xz, yy, yz, zz of a symmetric matrix
    float turns = 0;         ///< angle to the next pose's quaternion, in full turns
    float inverse_sine = 0;  ///< reciprocal sine of that angle; 0 if it is so small that interpolation is linear
};
static_assert(sizeof(PoseRecord) == 64);

/// All primitives, shapes and instances of a scene, with their attributes.
struct GeometryTables {
    // Vertex attributes of all meshes; arrays that no mesh uses are empty.
    LargeVector<Vec3f> positions, normals;
    LargeVector<Vec4f> tangents, colors;
    LargeVector<Vec2f> uv0, uv1;
    LargeVector<std::uint32_t> triangles;  ///< three vertex indices each
    std::vector<QuadRecord> quads;
    std::vector<SphereRecord> spheres;
    std::vector<DiskRecord> disks;
    std::vector<CurveRecord> curves;
    std::vector<Vec4f> curve_points;           ///< position and radius; segments of a cubic curve share their ends
    std::vector<Vec4f> points;                 ///< center and radius
    std::vector<std::array<float, 9>> frames;  ///< rows of rotations from render space to a node's space
    LargeVector<std::uint32_t> shape_of_primitive;
    std::vector<ShapeRecord> shapes;
    std::vector<InstanceRecord> instances;
    std::vector<PoseRecord> poses;
    /// Times at which moving vertices and control points are stored, from shutter open to shutter close; empty if none
    /// move.
    std::vector<float> vertex_times;
    std::uint32_t world_triangles =
        0;  ///< triangles [0, world_triangles) are in render space; the others are seen through instances
    float shutter_open = 0, shutter_close = 0;  ///< shutter times of the camera that the scene was compiled for
    Vec3d origin;                               ///< world position of render space's origin
    double render_scale = 1;                    ///< render units per world unit: a power of two
    bool moving = false;
    /// Instances [0, still_instances) are fixed; the others may move later if the scene is `editable`.
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
