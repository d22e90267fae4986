// SPDX-License-Identifier: Apache-2.0
#include "scene/motion.h"

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix linear_part(const Transform& t)
{
    Matrix m;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) m[i][j] = t.m[i][j];
    return m;
}

Transform transform_of(const Matrix& m)
{
    Transform t;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) t.m[i][j] = m[i][j];
    return t;
}

double norm(const Matrix& m)
{
    double sum = 0;
    for (const auto& row : m)
        for (double x : row) sum += x * x;
    return std::sqrt(sum);
}

/// The orthogonal matrix (a rotation or a rotary reflection) nearest to m.
Matrix nearest_orthogonal(Matrix m)
{
    const double size = norm(m);
    for (auto& row : m)
        for (double& x : row) x /= size;
    for (int i = 0; i < 100; ++i) {
        const Transform inverse = transform_of(m).inverse();
        const Matrix inverse_part = linear_part(inverse);
        // Scaling by Higham's factor makes the iteration converge in a few steps for any stretch.
        const double scale = std::sqrt(norm(inverse_part) / norm(m));
        double change = 0;
        Matrix next;
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 3; ++c) {
                next[r][c] = 0.5 * (scale * m[r][c] + inverse_part[c][r] / scale);
                change = std::max(change, std::abs(next[r][c] - m[r][c]));
            }
        m = next;
        if (change < 1e-15) break;
    }
    return m;
}

/// Quaternion of a rotation matrix, from its largest component for numerical stability (Shepperd 1978, "Quaternion from
/// Rotation Matrix").
std::array<double, 4> quaternion_of(const Matrix& m)
{
    const double trace = m[0][0] + m[1][1] + m[2][2];
    std::array<double, 4> q;
    std::size_t k = 0;
    for (std::size_t i = 1; i < 3; ++i)
        if (m[i][i] > m[k][k]) k = i;
    if (trace > m[k][k]) {
        q = {m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1], 1 + trace};
    } else {
        const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
        q[k] = 1 + m[k][k] - m[a][a] - m[b][b];
        q[a] = m[a][k] + m[k][a];
        q[b] = m[b][k] + m[k][b];
        q[3] = m[b][a] - m[a][b];
    }
    double length = 0;
    for (double x : q) length += x * x;
    for (double& x : q) x /= std::sqrt(length);
    return q;
}

template <class Key>
std::size_t last_before(const std::vector<Key>& keys, double time)
{
    std::size_t i = 0;
    while (i + 1 < keys.size() && keys[i + 1].time <= time) ++i;
    return i;
}

/// Fraction of the interval from key i to the next that has passed at `time`; 0 before the first and after the last
/// key.
template <class Key>
double fraction_after(const std::vector<Key>& keys, std::size_t i, double time)
{
    if (i + 1 == keys.size()) return 0;
    return std::max(0.0, (time - keys[i].time) / (keys[i + 1].time - keys[i].time));
}

template <class Key, class Same>
bool changes(const std::vector<Key>& keys, double open, double close, const Same& same)
{
    if (!(open < close)) return false;
    for (std::size_t i = 0; i + 1 < keys.size(); ++i)
        if (keys[i].time < close && keys[i + 1].time > open && !same(keys[i], keys[i + 1])) return true;
    return false;
}

bool same_points(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](Vec3f p, Vec3f q) { return p.x == q.x && p.y == q.y && p.z == q.z; });
}

float mix(float a, float b, double f)
{
    return float(double(a) + (double(b) - a) * f);
}
Vec3f mix(Vec3f a, Vec3f b, double f)
{
    return {mix(a.x, b.x, f), mix(a.y, b.y, f), mix(a.z, b.z, f)};
}
template <class T>
std::vector<T> mix(const std::vector<T>& a, const std::vector<T>& b, double f)
{
    std::vector<T> out(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) out[i] = mix(a[i], b[i], f);
    return out;
}

}  // namespace

Transform Pose::transform() const
{
    const auto& s = stretch;
    const Transform symmetric = transform_of({{{s[0], s[1], s[2]}, {s[1], s[3], s[4]}, {s[2], s[4], s[5]}}});
    const auto& q = rotation;
    return Transform::translate(translation) * Transform::rotate_quaternion(q[0], q[1], q[2], q[3]) * symmetric;
}

Pose pose_of(const Transform& t)
{
    Pose pose;
    pose.translation = {t.m[0][3], t.m[1][3], t.m[2][3]};
    const Matrix m = linear_part(t);
    Matrix rotation = nearest_orthogonal(m);
    if (t.determinant() < 0)
        for (auto& row : rotation)
            for (double& x : row) x = -x;
    pose.rotation = quaternion_of(rotation);
    const auto entry = [&](std::size_t i, std::size_t j) {
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) sum += 0.5 * (rotation[k][i] * m[k][j] + rotation[k][j] * m[k][i]);
        return sum;
    };
    pose.stretch = {entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)};
    return pose;
}

std::array<double, 4> slerp(const std::array<double, 4>& a, const std::array<double, 4>& b, double fraction)
{
    double cosine = 0;
    for (std::size_t i = 0; i < 4; ++i) cosine += a[i] * b[i];
    const double sign = cosine < 0 ? -1 : 1;
    const double angle = std::acos(std::min(1.0, std::abs(cosine)));
    double wa = 1 - fraction, wb = fraction;
    if (angle > 1e-6) wa = std::sin(wa * angle) / std::sin(angle), wb = std::sin(wb * angle) / std::sin(angle);
    std::array<double, 4> q;
    for (std::size_t i = 0; i < 4; ++i) q[i] = wa * a[i] + sign * wb * b[i];
    return q;
}

Pose interpolate(const Pose& a, const Pose& b, double fraction)
{
    Pose pose;
    pose.translation = a.translation + (b.translation - a.translation) * fraction;
    for (std::size_t i = 0; i < 6; ++i) pose.stretch[i] = a.stretch[i] + (b.stretch[i] - a.stretch[i]) * fraction;
    pose.rotation = slerp(a.rotation, b.rotation, fraction);
    return pose;
}

Transform transform_at(const Node& node, double time)
{
    if (node.motion.empty()) return node.parent_from_node;
    const std::size_t i = last_before(node.motion, time);
    const double f = fraction_after(node.motion, i, time);
    if (f == 0) return node.motion[i].parent_from_node;
    return interpolate(pose_of(node.motion[i].parent_from_node), pose_of(node.motion[i + 1].parent_from_node), f)
        .transform();
}

bool moves(const Node& node, double open, double close)
{
    return changes(node.motion, open, close,
                   [](const NodeKey& a, const NodeKey& b) { return a.parent_from_node.m == b.parent_from_node.m; });
}

bool moves(const Mesh& mesh, double open, double close)
{
    return changes(mesh.motion, open, close, [](const MeshKey& a, const MeshKey& b) {
        return same_points(a.positions, b.positions) && same_points(a.normals, b.normals);
    });
}

bool moves(const Curves& curves, double open, double close)
{
    return changes(curves.motion, open, close, [](const CurvesKey& a, const CurvesKey& b) {
        return same_points(a.points, b.points) && a.radii == b.radii;
    });
}

namespace {

/// The key at a time: an existing one, or an interpolation of its neighbors.
///
/// mix_keys  interpolates two keys, given the fraction of the second
template <class Key, class Mix>
Key key_at(const std::vector<Key>& keys, double time, Mix mix_keys)
{
    const std::size_t i = last_before(keys, time);
    const double f = fraction_after(keys, i, time);
    return f == 0 ? keys[i] : mix_keys(keys[i], keys[i + 1], f);
}

}  // namespace

MeshKey vertices_at(const Mesh& mesh, double time)
{
    return key_at(mesh.motion, time, [&](const MeshKey& a, const MeshKey& b, double f) {
        return MeshKey{time, mix(a.positions, b.positions, f), mix(a.normals, b.normals, f)};
    });
}

CurvesKey points_at(const Curves& curves, double time)
{
    return key_at(curves.motion, time, [&](const CurvesKey& a, const CurvesKey& b, double f) {
        return CurvesKey{time, mix(a.points, b.points, f), mix(a.radii, b.radii, f)};
    });
}

}  // namespace fathom
