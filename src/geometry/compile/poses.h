#pragma once
#include <functional>
#include <vector>

#include "fathom/load.h"
#include "kernel/tables.h"

namespace fathom {

/// Poses between which interpolation (kernel/tables.h, PoseRecord) follows a motion.
///
/// at       render_from_object at a time
/// times    ascending, two or more: where the motion's pieces join
/// content  what moves, in its own space
///
/// A node's own keys are met exactly. Where several nodes of a path move, or one turns about a place that is not its
/// origin, poses are added until no point of the content's box is off by more than 2^-16 of its size: a thirtieth of
/// a pixel on an object as large as the picture.
std::vector<NodeKey> fit_poses(const std::function<Transform(double)>& at, const std::vector<double>& times,
                               const Bounds& content);

std::vector<PoseRecord> pose_tables(const std::vector<NodeKey>& poses);

/// Puts poses behind those of the tables; returns them as InstanceRecord::poses. file: of the scene, for an Error.
std::uint32_t append_poses(GeometryTables& tables, const std::vector<PoseRecord>& poses, const std::string& file);

}  // namespace fathom
