// SPDX-License-Identifier: Apache-2.0
#include "geometry/compile/poses.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fathom/error.h"
#include "scene/motion.h"

namespace fathom {

namespace {

/// Limit on bisections of a piece. A piece rotates by less than 180 degrees, for which far fewer suffice.
constexpr int max_halvings = 5;

class PoseFitter {
public:
    PoseFitter(const std::function<Transform(double)>& at, const Bounds& content) : at_(at)
    {
        for (int i = 0; i < 8; ++i)
            corners_[i] = {i & 1 ? content.max.x : content.min.x, i & 2 ? content.max.y : content.min.y,
                           i & 4 ? content.max.z : content.min.z};
    }

    std::vector<NodeKey> fit(const std::vector<double>& times)
    {
        poses_.push_back({times[0], at_(times[0])});
        for (std::size_t i = 0; i + 1 < times.size(); ++i) {
            const NodeKey from = poses_.back();
            add_to({times[i + 1], at_(times[i + 1])}, from, 0);
        }
        return std::move(poses_);
    }

private:
    void add_to(const NodeKey& to, const NodeKey& from, int halvings)
    {
        if (halvings == max_halvings || is_close(from, to)) {
            poses_.push_back(to);
            return;
        }
        const double middle_time = 0.5 * (from.time + to.time);
        const NodeKey middle{middle_time, at_(middle_time)};
        add_to(middle, from, halvings + 1);
        add_to(to, middle, halvings + 1);
    }

    bool is_close(const NodeKey& from, const NodeKey& to) const
    {
        const Pose a = pose_of(from.parent_from_node), b = pose_of(to.parent_from_node);
        for (double f : {0.25, 0.5, 0.75}) {
            const Transform exact = at_(from.time + f * (to.time - from.time)),
                            fitted = interpolate(a, b, f).transform();
            const double size = length(exact.point(corners_[7]) - exact.point(corners_[0]));
            for (const Vec3d& p : corners_)
                if (length(exact.point(p) - fitted.point(p)) > 0x1p-16 * size) return false;
        }
        return true;
    }

    const std::function<Transform(double)>& at_;
    Vec3d corners_[8];
    std::vector<NodeKey> poses_;
};

}  // namespace

std::vector<NodeKey> fit_poses(const std::function<Transform(double)>& at, const std::vector<double>& times,
                               const Bounds& content)
{
    return PoseFitter(at, content).fit(times);
}

std::vector<PoseRecord> pose_tables(const std::vector<NodeKey>& poses)
{
    std::vector<PoseRecord> tables(poses.size());
    std::array<double, 4> before{};
    for (std::size_t i = 0; i < poses.size(); ++i) {
        Pose pose = pose_of(poses[i].parent_from_node);
        double cosine = 0;
        for (std::size_t k = 0; k < 4; ++k) cosine += before[k] * pose.rotation[k];
        // A quaternion and its negative are the same rotation; the sign chosen gives the shorter arc.
        if (cosine < 0)
            for (double& q : pose.rotation) q = -q;
        PoseRecord& t = tables[i];
        t.time = float(poses[i].time);
        t.translation[0] = float(pose.translation.x);
        t.translation[1] = float(pose.translation.y);
        t.translation[2] = float(pose.translation.z);
        for (std::size_t k = 0; k < 4; ++k) t.rotation[k] = float(pose.rotation[k]);
        for (std::size_t k = 0; k < 6; ++k) t.stretch[k] = float(pose.stretch[k]);
        if (i > 0) {
            const double angle = std::acos(std::min(1.0, std::abs(cosine)));
            tables[i - 1].turns = float(angle / (2 * std::numbers::pi));
            // Below this angle, interpolation weights are linear to 1e-8.
            if (angle > 1e-3) tables[i - 1].inverse_sine = float(1 / std::sin(angle));
        }
        before = pose.rotation;
    }
    return tables;
}

std::uint32_t append_poses(GeometryTables& tables, const std::vector<PoseRecord>& poses, const std::string& file)
{
    if (poses.size() > InstanceRecord::max_poses || tables.poses.size() > InstanceRecord::max_first_pose)
        throw Error(file, "", "the motion of nodes is too complex: it has too many keys while the shutter is open");
    const std::uint32_t word = std::uint32_t(tables.poses.size()) << 8 | std::uint32_t(poses.size());
    tables.poses.insert(tables.poses.end(), poses.begin(), poses.end());
    return word;
}

}  // namespace fathom
