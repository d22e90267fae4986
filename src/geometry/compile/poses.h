// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <vector>

#include "fathom/load.h"
#include "kernel/tables.h"

namespace fathom {

/// Fits poses whose interpolation (geometry/records.h, PoseRecord) follows a motion.
///
/// at: render_from_object at a time. times: two or more, ascending, where pieces of the motion join. content: bounds of
/// what moves, in object space.
///
/// A node's own keys are met exactly. Where several nodes on a path move, or one rotates about a point other than its
/// origin, poses are added until no point of the bounds deviates by more than 2^-16 of their size: a thirtieth of a
/// pixel for an object that fills the image.
std::vector<NodeKey> fit_poses(const std::function<Transform(double)>& at, const std::vector<double>& times,
                               const Bounds& content);

/// Decomposes poses into records for interpolation.
std::vector<PoseRecord> pose_tables(const std::vector<NodeKey>& poses);

/// Appends poses to the tables; returns the word for InstanceRecord::poses. file: scene file named in errors.
std::uint32_t append_poses(GeometryTables& tables, const std::vector<PoseRecord>& poses, const std::string& file);

}  // namespace fathom
