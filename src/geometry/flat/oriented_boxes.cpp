// SPDX-License-Identifier: Apache-2.0
#include "geometry/flat/oriented_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace fathom {
inline namespace FATHOM_LANES {

namespace {

using Corners = std::array<Vec3d, 4>;

Corners corners_of(const Vec3d& corner, const Vec3d& u, const Vec3d& v)
{
    return {corner, corner + u, corner + v, corner + u + v};
}

bool are_same(const Corners& a, const Corners& b, double tolerance)
{
    return std::all_of(a.begin(), a.end(), [&](const Vec3d& p) {
        return std::any_of(b.begin(), b.end(), [&](const Vec3d& q) { return length(p - q) <= tolerance; });
    });
}

/// A corner of a parallelepiped and the three edges from it.
struct Frame {
    Vec3d origin, edge[3];

    double volume() const { return std::abs(dot(cross(edge[0], edge[1]), edge[2])); }
    /// Corners of the face with this code: 2 axis + high.
    Corners face(int code) const
    {
        const int axis = code / 2;
        const Vec3d from = code % 2 ? origin + edge[axis] : origin;
        return corners_of(from, edge[(axis + 1) % 3], edge[(axis + 2) % 3]);
    }
};

class OrientedBoxFinder {
public:
    OrientedBoxFinder(const GeometryTables& tables, std::vector<bool>& used, double tolerance)
        : tables_(tables), used_(used), tolerance_(tolerance)
    {
        for (const QuadRecord& q : tables.quads)
            corners_.push_back(corners_of(to_double(q.corner), to_double(q.edge_u), to_double(q.edge_v)));
    }

    std::vector<FlatScene::OrientedBox> find()
    {
        std::vector<FlatScene::OrientedBox> boxes;
        for (int wanted = 6; wanted >= min_faces; --wanted)
            for (std::size_t i = 0; i < corners_.size(); ++i)
                for (std::size_t j = i + 1; j < corners_.size(); ++j)
                    if (const auto box = between(i, j, wanted)) boxes.push_back(*box);
        return boxes;
    }

private:
    /// Testing a box takes as long as about three parallelograms.
    static constexpr int min_faces = 4;

    /// The box with two opposite parallelograms if it has `wanted` faces, which are then marked as used.
    std::optional<FlatScene::OrientedBox> between(std::size_t i, std::size_t j, int wanted)
    {
        if (used_[i] || used_[j]) return {};
        const QuadRecord& q = tables_.quads[i];
        const auto center = [&](std::size_t k) { return (corners_[k][0] + corners_[k][3]) * 0.5; };
        const Frame frame{to_double(q.corner), {to_double(q.edge_u), to_double(q.edge_v), center(j) - center(i)}};
        if (!are_same(frame.face(5), corners_[j], tolerance_)) return {};
        // The volume test excludes coplanar parallelograms.
        const double area = length(cross(frame.edge[0], frame.edge[1]));
        if (!(frame.volume() > 8 * tolerance_ * area)) return {};
        FlatScene::OrientedBox box = box_of(frame);
        std::size_t faces[6];
        int count = 0;
        for (int code = 0; code < 6; ++code) {
            const std::size_t face = find_face(frame.face(code));
            if (face == corners_.size()) continue;
            box.unit.faces[code] = tables_.first_quad() + std::uint32_t(face);
            faces[count++] = face;
        }
        if (count != wanted) return {};
        for (int k = 0; k < count; ++k) used_[faces[k]] = true;
        box.unit.closed = count == 6;
        return box;
    }

    /// The unused parallelogram with these corners, or the number of parallelograms if there is none.
    std::size_t find_face(const Corners& corners) const
    {
        std::size_t k = 0;
        while (k < corners_.size() && (used_[k] || !are_same(corners, corners_[k], tolerance_))) ++k;
        return k;
    }

    static FlatScene::OrientedBox box_of(const Frame& frame)
    {
        FlatScene::OrientedBox box{to_float(frame.origin), {}, {{0, 0, 0}, {1, 1, 1}, false, {}}};
        std::fill(std::begin(box.unit.faces), std::end(box.unit.faces), no_index);
        for (int axis = 0; axis < 3; ++axis) {
            const Vec3d across = cross(frame.edge[(axis + 1) % 3], frame.edge[(axis + 2) % 3]);
            box.along[axis] = to_float(across * (1 / dot(across, frame.edge[axis])));
        }
        return box;
    }

    const GeometryTables& tables_;
    std::vector<bool>& used_;
    const double tolerance_;
    std::vector<Corners> corners_;
};

}  // namespace

std::vector<FlatScene::OrientedBox> find_oriented_boxes(const GeometryTables& tables, std::vector<bool>& used,
                                                        double tolerance)
{
    return OrientedBoxFinder(tables, used, tolerance).find();
}

}  // namespace FATHOM_LANES
}  // namespace fathom
