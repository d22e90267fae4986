// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "fathom/vector.h"

namespace fathom {

/// Vertices of a mesh at one time.
struct MeshKey {
    double time = 0;               ///< Time of the key in seconds.
    std::vector<Vec3f> positions;  ///< One position for each vertex, in the space of the mesh.
    std::vector<Vec3f> normals;    ///< One normal for each vertex; empty if the mesh has none.
};

/// A triangle mesh. Vectors of vertex data are empty or as long as `positions`. Triangles are counterclockwise as seen
/// from the side of the geometric normal.
struct Mesh {
    std::string name;              ///< Name for messages and scene files; may be empty.
    std::vector<Vec3f> positions;  ///< Vertex positions in meters, before the transform of the node.
    std::vector<Vec3f> normals;    ///< Shading normals; empty: those of the triangles.
    std::vector<Vec4f> tangents;   ///< Tangents; w is 1 or -1, the sign of the bitangent, as in glTF.
    std::vector<Vec2f> uvs[2];     ///< Two sets of texture coordinates; v grows downwards in the image, as in glTF.
    std::vector<Vec4f> colors;     ///< Vertex colors, linear with alpha.
    std::vector<std::uint32_t> indices;  ///< Three vertex indices for each triangle.
    /// Empty, or at least two keys in ascending order of time. Vertices move linearly between keys and don't move
    /// before the first and after the last one. `positions` and `normals` are then not rendered.
    std::vector<MeshKey> motion;
    bool movable = false;  ///< Vertices will change between images; see EditableScene.
};

/// A sphere. Its normals point outwards; a negative radius turns them inwards.
struct Sphere {
    Vec3d center;       ///< Center in the space of the node.
    double radius = 1;  ///< Radius in meters.
    /// Center at time 1 second, for a sphere that moves linearly from `center` at time 0.
    std::optional<Vec3d> center_end;
};
/// A parallelogram with corners corner, corner + edge_u, corner + edge_v and corner + edge_u + edge_v. Its normal is
/// along cross(edge_u, edge_v).
struct Rectangle {
    Vec3d corner, edge_u, edge_v;  ///< One corner, and the edges along u and v.
};
/// A box with faces along the axes of its node's space. Normals point outwards.
struct Box {
    Vec3d min, max;  ///< Opposite corners in the space of the node.
};
/// A flat disk.
struct Disk {
    Vec3d center, normal;  ///< Center, and normal of any length above 0.
    double radius = 1;     ///< Radius in meters.
};
/// A mesh that a node places.
struct MeshInstance {
    int mesh = -1;  ///< Index into SceneDescription::meshes.
};

/// Meaning of the control points of a curve.
enum class CurveBasis {
    linear,       ///< n points make n - 1 straight segments.
    bezier,       ///< 3 n + 1 points make n cubic segments, which share their end points.
    bspline,      ///< n points make n - 3 segments of a uniform cubic B-spline, which passes near the points.
    catmull_rom,  ///< n points make n - 3 cubic segments through all points except the first and the last.
};
/// Control points and radii of curves at one time, as many as the curves have.
struct CurvesKey {
    double time = 0;            ///< Time of the key in seconds.
    std::vector<Vec3f> points;  ///< Control points of all curves.
    std::vector<float> radii;   ///< Radius at each control point.
};
/// A set of curves, such as hair, whose control points are stored one curve after the other.
struct Curves {
    std::string name;                        ///< Name for messages and scene files; may be empty.
    CurveBasis basis = CurveBasis::bspline;  ///< Meaning of the control points.
    bool ribbons = false;                    ///< Flat strips that face each ray; otherwise round curves.
    std::vector<Vec3f> points;               ///< Control points of all curves.
    std::vector<float> radii;                ///< Radius in meters at each control point; half the width of a ribbon.
    std::vector<std::uint32_t> counts;       ///< Number of control points of each curve.
    /// Empty, or at least two keys in ascending order of time. Points and radii change linearly between keys. `points`
    /// and `radii` are then not rendered.
    std::vector<CurvesKey> motion;
};
/// Curves that a node places.
struct CurvesInstance {
    int curves = -1;  ///< Index into SceneDescription::curves.
};
/// A set of spheres that take little memory.
struct Points {
    std::string name;            ///< Name for messages and scene files; may be empty.
    std::vector<Vec3f> centers;  ///< Center of each sphere.
    std::vector<float> radii;    ///< Radius of each sphere in meters, above 0.
};
/// Points that a node places.
struct PointsInstance {
    int points = -1;  ///< Index into SceneDescription::points.
};

/// Geometry with a material, in the space of its node.
struct Shape {
    /// Mesh, primitive, curves or points.
    std::variant<MeshInstance, Sphere, Rectangle, Box, Disk, CurvesInstance, PointsInstance> geometry;
    int material = -1;  ///< Index into SceneDescription::materials; -1: gray diffuse (0.8).
    std::string name;   ///< Name for messages; may be empty.
};

}  // namespace fathom
