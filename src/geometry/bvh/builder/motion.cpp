// SPDX-License-Identifier: Apache-2.0
#include "geometry/bvh/builder/motion.h"

#include <algorithm>
#include <cmath>

#include "geometry/bvh/builder/leaf_data.h"

namespace fathom::bvh {

namespace {

using Matrix = std::array<double, 12>;  ///< rows of an affine map

Matrix inverse_of(const std::array<float, 12>& m)
{
    const auto at = [&](std::size_t i, std::size_t j) { return double(m[4 * i + j]); };
    Matrix r{};
    double determinant = 0;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            // Choosing rows and columns cyclically gives cofactors their sign.
            const std::size_t a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            r[4 * i + j] = at(a, c) * at(b, d) - at(a, d) * at(b, c);
            if (i == 0) determinant += at(j, 0) * r[j];
        }
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) r[4 * i + j] /= determinant;
        r[4 * i + 3] = -(r[4 * i] * at(0, 3) + r[4 * i + 1] * at(1, 3) + r[4 * i + 2] * at(2, 3));
    }
    return r;
}

/// Interpolated pose, by the method of geometry/motion.h.
Matrix pose_between(const PoseRecord& a, const PoseRecord& b, double f)
{
    const double angle = 2 * 3.14159265358979323846 * a.turns;
    double wa = 1 - f, wb = f;
    if (a.inverse_sine > 0) wa = std::sin(wa * angle) * a.inverse_sine, wb = std::sin(wb * angle) * a.inverse_sine;
    double q[4], s[6];
    for (int i = 0; i < 4; ++i) q[i] = wa * a.rotation[i] + wb * b.rotation[i];
    for (int i = 0; i < 6; ++i) s[i] = (1 - f) * a.stretch[i] + f * b.stretch[i];
    const double x = q[0], y = q[1], z = q[2], w = q[3], two = 2 / (x * x + y * y + z * z + w * w);
    const double r[3][3] = {{1 - two * (y * y + z * z), two * (x * y - z * w), two * (x * z + y * w)},
                            {two * (x * y + z * w), 1 - two * (x * x + z * z), two * (y * z - x * w)},
                            {two * (x * z - y * w), two * (y * z + x * w), 1 - two * (x * x + y * y)}};
    const double stretch[3][3] = {{s[0], s[1], s[2]}, {s[1], s[3], s[4]}, {s[2], s[4], s[5]}};
    Matrix m{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) m[4 * i + j] += r[i][k] * stretch[k][j];
        m[4 * i + 3] = (1 - f) * a.translation[i] + f * b.translation[i];
    }
    return m;
}

double largest(const Box& box)
{
    double r = 0;
    for (int axis = 0; axis < 3; ++axis)
        r = std::max({r, double(std::fabs(box.low(axis))), double(std::fabs(box.high(axis)))});
    return r;
}

Box widened(const Box& box, double by)
{
    Box wide = box;
    for (int i = 0; i < 8; ++i)
        wide.v[i] = std::nextafter(float(double(box.v[i]) - by), -std::numeric_limits<float>::infinity());
    return wide;
}

double norm_of(const Matrix& m)
{
    double norm = 0;
    for (std::size_t row = 0; row < 3; ++row)
        norm = std::max(norm, std::fabs(m[4 * row]) + std::fabs(m[4 * row + 1]) + std::fabs(m[4 * row + 2]));
    return norm;
}

/// Bounding box of a transformed box. Transforming a ray into object space rounds it. Seen from outside, that error
/// grows with the condition number of the map: the margin is `rounding` times that number and the size of the box.
Box transformed(const Matrix& m, const Box& box, double rounding)
{
    Box out;
    double radius = 0;
    for (int row = 0; row < 3; ++row) {
        const double* r = &m[4 * std::size_t(row)];
        double low = r[3], high = r[3];
        for (int axis = 0; axis < 3; ++axis) {
            const double a = r[axis] * box.low(axis), b = r[axis] * box.high(axis);
            low += std::min(a, b);
            high += std::max(a, b);
        }
        radius = std::max({radius, std::fabs(low), std::fabs(high)});
        out.v[row] = float(low);
        out.v[4 + row] = float(-high);
    }
    std::array<float, 12> rounded{};
    for (std::size_t i = 0; i < 12; ++i) rounded[i] = float(m[i]);
    return widened(out, rounding * radius * norm_of(m) * norm_of(inverse_of(rounded)));
}

/// Motion bounds of a primitive with box box_at(k) at vertex_times[k] and linear motion between.
template <class BoxAt>
MovingBox box_through_keys(const GeometryTables& tables, const BoxAt& box_at)
{
    const std::size_t n = tables.vertex_times.size();
    const float open = tables.vertex_times.front(), close = tables.vertex_times.back();
    std::vector<float> times(n);
    std::vector<Box> boxes(n);
    for (std::size_t k = 0; k < n; ++k) {
        times[k] = (tables.vertex_times[k] - open) / (close - open);
        const Box box = box_at(k);
        boxes[k] = widened(box, 0x1p-22 * largest(box));
    }
    return MovingBox::around(times.data(), boxes.data(), n);
}

MovingBox triangle_box(const GeometryTables& tables, BvhKey key)
{
    return box_through_keys(tables, [&](std::size_t k) {
        Vec3f v[3];
        vertices_of(tables, key, v, k);
        Box box;
        for (const Vec3f& p : v) {
            const float x[8] = {p.x,  p.y,  p.z,  std::numeric_limits<float>::infinity(),
                                -p.x, -p.y, -p.z, std::numeric_limits<float>::infinity()};
            V8 point;
            std::memcpy(&point, x, sizeof point);
            box.extend(point);
        }
        return box;
    });
}

MovingBox piece_box(const GeometryTables& tables, std::uint32_t id)
{
    const ShapeRecord& shape = shape_of_segment(tables, id >> piece_bits);
    const auto box_at = [&](std::size_t key) {
        return box_of(piece_ends(tables, id, shape.flags & ShapeRecord::linear_curves, key));
    };
    if (shape.moving_vertices > 0) return box_through_keys(tables, box_at);
    const Box box = box_at(0);
    return {box, box};
}

MovingBox sphere_box(const GeometryTables& tables, std::uint32_t index)
{
    const SphereRecord& s = tables.spheres[index];
    const double center[3] = {s.center.x, s.center.y, s.center.z}, motion[3] = {s.motion.x, s.motion.y, s.motion.z};
    // The radius is enlarged slightly because intersect_sphere() has rounding errors of its own.
    const double r = std::fabs(double(s.radius)) * (1 + 0x1p-18);
    const auto at = [&](double time) {
        Box box;
        for (int i = 0; i < 3; ++i) {
            box.v[i] = float(center[i] + motion[i] * time - r);
            box.v[4 + i] = float(-(center[i] + motion[i] * time + r));
        }
        return widened(box, 0x1p-21 * largest(box));
    };
    return {at(tables.shutter_open), at(tables.shutter_close)};
}

MovingBox moving_instance_box(const GeometryTables& tables, const InstanceRecord& instance, const MovingBox& mesh)
{
    Box content = mesh.open;
    content.extend(mesh.close);
    const PoseRecord* poses = &tables.poses[instance.first_pose()];
    const double open = tables.shutter_open, close = tables.shutter_close;
    const double corner = std::sqrt(3.0) * largest(content);
    std::vector<float> times;
    std::vector<Box> boxes;
    std::vector<double> deviations;
    const auto add = [&](double time, const Matrix& m, double deviation) {
        times.push_back(float(std::clamp((time - open) / (close - open), 0.0, 1.0)));
        boxes.push_back(transformed(m, content, 0x1p-18));
        deviations.push_back(deviation);
    };
    for (std::uint32_t i = 0; i + 1 < instance.pose_count(); ++i) {
        const PoseRecord &a = poses[i], &b = poses[i + 1];
        // A point moves as f = T + R v, with T and v linear. If R turns by w, |f''| is at most w^2 |v| + 2 w |v'|, and
        // f deviates from its chord by at most an eighth of that.
        double stretch = 0, change = 0;
        for (int k = 0; k < 6; ++k) {
            stretch += 2 * std::max(std::fabs(double(a.stretch[k])), std::fabs(double(b.stretch[k])));
            change += 2 * std::fabs(double(b.stretch[k]) - a.stretch[k]);
        }
        const double w = 4 * 3.14159265358979323846 * a.turns;
        const int n = std::clamp(int(std::ceil(w / 0.1)), 1, 64);
        const double deviation = (w * w * stretch + 2 * w * change) * corner / (8.0 * n * n);
        for (int k = i == 0 ? 0 : 1; k <= n; ++k) {
            const double f = double(k) / n;
            add(a.time + f * (double(b.time) - a.time), pose_between(a, b, f), deviation);
        }
    }
    if (instance.pose_count() == 1) add(open, pose_between(poses[0], poses[0], 0), 0);
    for (std::size_t i = 0; i < boxes.size(); ++i)
        boxes[i] = widened(boxes[i], std::max(deviations[i], deviations[std::min(i + 1, boxes.size() - 1)]));
    return MovingBox::around(times.data(), boxes.data(), boxes.size());
}

}  // namespace

bool shutter_takes_time(const GeometryTables& tables)
{
    return tables.shutter_open < tables.shutter_close;
}

Box MovingBox::middle() const
{
    Box box;
    box.v = 0.5f * open.v + 0.5f * close.v;
    return box;
}

float MovingBox::radius() const
{
    return float(std::max(largest(open), largest(close)));
}

MovingBox MovingBox::around(const float* times, const Box* boxes, std::size_t count)
{
    MovingBox box{boxes[0], boxes[count - 1]};
    V8 shift = {};
    for (std::size_t i = 0; i < count; ++i) {
        const V8 at = box.open.v * (1 - times[i]) + box.close.v * times[i];
        const V8 less = boxes[i].v - at;
        shift = less < shift ? less : shift;
    }
    // Boxes store low bounds and negated high bounds, so a negative shift widens both.
    box.open.v += shift;
    box.close.v += shift;
    return box;
}

MovingBox moving_box(const GeometryTables& tables, const BvhData& bvh, const std::vector<MovingBox>& mesh_boxes,
                     std::uint32_t kind, std::uint32_t id)
{
    if (kind == Item::moving_triangle) return triangle_box(tables, id);
    if (kind == Item::sphere) return sphere_box(tables, id);
    if (kind == Item::curve) return piece_box(tables, id);
    const InstanceRecord& instance = tables.instances[id];
    const MovingBox& mesh = mesh_boxes[instance.mesh_shape];
    if (instance.pose_count() > 0) return moving_instance_box(tables, instance, mesh);
    const Matrix m = inverse_of(instance.object_from_render);
    return {transformed(m, mesh.open, 0x1p-20), transformed(m, mesh.close, 0x1p-20)};
}

bool set_motion(BvhNode& node, BvhNode& change, int i, const MovingBox& box)
{
    bool moves = false;
    for (int axis = 0; axis < 3; ++axis) {
        node.bounds[axis][i] = box.open.low(axis);
        node.bounds[3 + axis][i] = box.open.high(axis);
        change.bounds[axis][i] = box.close.low(axis) - box.open.low(axis);
        change.bounds[3 + axis][i] = box.close.high(axis) - box.open.high(axis);
        moves |= change.bounds[axis][i] != 0 || change.bounds[3 + axis][i] != 0;
    }
    return moves;
}

namespace {

class MotionAdder {
public:
    MotionAdder(const GeometryTables& tables, BvhData& bvh, const std::vector<MovingBox>& mesh_boxes, std::size_t first)
        : tables_(tables),
          bvh_(bvh),
          mesh_boxes_(mesh_boxes),
          nodes_(bvh.nodes),
          first_(first),
          still_(nodes_.begin() + std::ptrdiff_t(first), nodes_.end())
    {
        nodes_.resize(first);
    }

    /// Adds motion to the subtree of a reference, whose box at the middle of the shutter interval is `box`; relocates
    /// its nodes.
    MovingBox add(std::uint32_t& reference, const Box& box)
    {
        if (BvhReference::is_node(reference)) return add_node(reference);
        MovingBox moving;
        const auto extend = [&](std::uint32_t kind, std::uint32_t id) {
            moving.extend(moving_box(tables_, bvh_, mesh_boxes_, kind, id));
        };
        if (BvhReference::is_triangles(reference)) return {box, box};
        if (BvhReference::is_indexed_triangles(reference)) {
            const IndexedLeaf leaf = bvh_.indexed_leaf(reference);
            if (!leaf.moves()) return {box, box};
            for (int i = 0; i < leaf.count(); ++i) extend(Item::moving_triangle, leaf.ids()[i]);
            return moving;
        }
        const std::uint32_t place = BvhReference::place(reference);
        switch (BvhReference::other_kind(reference)) {
            case BvhReference::instance:
                extend(Item::instance, place);
                return moving;
            case BvhReference::spheres: {
                const BvhLeaf leaf{&bvh_.others[place * BvhLeaf::unit]};
                for (int i = 0; i < leaf.count(); ++i) extend(Item::sphere, leaf.ids()[i]);
                return moving;
            }
            case BvhReference::curves:
            case BvhReference::ribbons: {
                const BvhLeaf leaf{&bvh_.others[place * BvhLeaf::unit]};
                if (!leaf.moves()) return {box, box};
                for (int i = 0; i < leaf.count(); ++i) extend(Item::curve, piece_in(leaf, i));
                return moving;
            }
            default:
                return {box, box};
        }
    }

private:
    /// Returns the piece_id of a leaf's piece; the leaf itself stores numbers of segments.
    static std::uint32_t piece_in(const BvhLeaf& leaf, int i)
    {
        const float begin = leaf.data()[i], share = leaf.data()[leaf.count() + i];
        return piece_id(leaf.ids()[i], std::uint32_t(begin / share));
    }

    MovingBox add_node(std::uint32_t& reference)
    {
        BvhNode node = still_[reference - first_];
        BvhNode change{};
        MovingBox all;
        bool moves = false;
        for (int i = 0; i < bvh_width && node.bounds[0][i] <= node.bounds[3][i]; ++i) {
            Box box;
            for (int axis = 0; axis < 3; ++axis) {
                box.v[axis] = node.bounds[axis][i];
                box.v[4 + axis] = -node.bounds[3 + axis][i];
            }
            const MovingBox moving = add(node.child[i], box);
            all.extend(moving);
            moves |= set_motion(node, change, i, moving);
        }
        // A node follows its children, because only then is it known whether it takes one slot or two.
        reference = std::uint32_t(nodes_.size()) | (moves ? BvhReference::moving_bit : 0u);
        nodes_.push_back(node);
        if (moves) nodes_.push_back(change);
        return all;
    }

    const GeometryTables& tables_;
    const BvhData& bvh_;
    const std::vector<MovingBox>& mesh_boxes_;
    BvhNodes& nodes_;
    std::size_t first_;
    std::vector<BvhNode> still_;  ///< nodes of the static BVH
};

}  // namespace

MovingBox add_motion(const GeometryTables& tables, BvhData& bvh, const std::vector<MovingBox>& mesh_boxes,
                     std::size_t first, std::uint32_t& root, const Box& box)
{
    return MotionAdder(tables, bvh, mesh_boxes, first).add(root, box);
}

}  // namespace fathom::bvh
