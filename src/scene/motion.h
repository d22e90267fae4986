#pragma once
#include <array>

#include "fathom/description.h"

namespace fathom {

/// An affine map as a translation after a rotation after a stretch along perpendicular axes: the polar decomposition of
/// its linear part. A map that mirrors has a stretch that does, so that what rotates is always a rotation.
struct Pose {
    Vec3d translation;
    std::array<double, 4> rotation{0, 0, 0, 1};       ///< unit quaternion x, y, z, w
    std::array<double, 6> stretch{1, 0, 0, 1, 0, 1};  ///< xx, xy, xz, yy, yz, zz of a symmetric matrix

    Transform transform() const;
};

/// Higham 1986, "Computing the Polar Decomposition, with Applications": Newton's iteration. The map must not be
/// singular.
Pose pose_of(const Transform& t);

/// From one unit quaternion (0) to another (1), steadily and the shorter way round (Shoemake 1985, "Animating Rotation
/// with Quaternion Curves").
std::array<double, 4> turn(const std::array<double, 4>& a, const std::array<double, 4>& b, double fraction);

/// From a (0) to b (1): translation and stretch linearly, the rotation by turn().
Pose interpolate(const Pose& a, const Pose& b, double fraction);

/// parent_from_node at a time.
Transform transform_at(const Node& node, double time);

/// Whether the node is elsewhere at some time from open to close than when it opens.
bool moves(const Node& node, double open, double close);
bool moves(const Mesh& mesh, double open, double close);
bool moves(const Curves& curves, double open, double close);

/// A mesh's vertices at a time; normals are those of the keys, interpolated, not unit. The mesh must have keys.
MeshKey vertices_at(const Mesh& mesh, double time);
/// The same of curves.
CurvesKey points_at(const Curves& curves, double time);

}  // namespace fathom
