// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "fathom/description.h"

namespace fathom {

/// An affine transform as stretch, then rotation, then translation: the polar decomposition of its linear part. If the
/// transform mirrors, the stretch does, so that the rotation is always proper.
struct Pose {
    Vec3d translation;
    std::array<double, 4> rotation{0, 0, 0, 1};       ///< unit quaternion x, y, z, w
    std::array<double, 6> stretch{1, 0, 0, 1, 0, 1};  ///< xx, xy, xz, yy, yz, zz of a symmetric matrix

    /// The affine transform of the pose.
    Transform transform() const;
};

/// Decomposes an affine transform by Newton's iteration (Higham 1986, "Computing the Polar Decomposition, with
/// Applications"). The transform must not be singular.
Pose pose_of(const Transform& t);

/// Spherical linear interpolation of unit quaternions along the shorter arc, from a (fraction 0) to b (1); Shoemake
/// 1985, "Animating Rotation with Quaternion Curves".
std::array<double, 4> slerp(const std::array<double, 4>& a, const std::array<double, 4>& b, double fraction);

/// Interpolates from a (fraction 0) to b (1): translation and stretch linearly, the rotation by turn().
Pose interpolate(const Pose& a, const Pose& b, double fraction);

/// The node's parent_from_node at a time, interpolated between its motion keys.
Transform transform_at(const Node& node, double time);

/// Whether the node's transform changes in the shutter interval [open, close].
bool moves(const Node& node, double open, double close);
/// Whether vertices change in the shutter interval [open, close].
bool moves(const Mesh& mesh, double open, double close);
bool moves(const Curves& curves, double open, double close);

/// A mesh's vertices at a time; normals are interpolated between keys and not unit. The mesh must have keys.
MeshKey vertices_at(const Mesh& mesh, double time);
/// The control points of curves at a time. The curves must have keys.
CurvesKey points_at(const Curves& curves, double time);

}  // namespace fathom
