// SPDX-License-Identifier: Apache-2.0
#include "geometry/bvh/builder/leaf_data.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace fathom::bvh {

namespace {

/// Rounds up to a multiple of BvhLeaf::unit, at which leaves start.
std::size_t in_units(std::size_t words)
{
    return (words + BvhLeaf::unit - 1) / BvhLeaf::unit * BvhLeaf::unit;
}

/// The arrays of a leaf, n numbers each, after its header.
class Arrays {
public:
    Arrays(std::vector<std::uint32_t>& words, std::size_t n, std::size_t count)
        : words_(words), n_(n), first_(words.size())
    {
        words.resize(first_ + count * n);
    }
    void set(std::size_t array, std::size_t i, float value)
    {
        words_[first_ + array * n_ + i] = std::bit_cast<std::uint32_t>(value);
    }
    void set_vector(std::size_t array, std::size_t i, const CurvePoint<float>& p)
    {
        set(array, i, p.x), set(array + 1, i, p.y), set(array + 2, i, p.z);
    }

private:
    std::vector<std::uint32_t>& words_;
    std::size_t n_, first_;
};

bool any_moves(const GeometryTables& tables, const std::vector<std::uint32_t>& ids)
{
    return !tables.vertex_times.empty() && std::any_of(ids.begin(), ids.end(), [&](std::uint32_t id) {
        return shape_of_segment(tables, id >> piece_bits).moving_vertices > 0;
    });
}

void put_curves_at(const GeometryTables& tables, const std::vector<std::uint32_t>& ids, bool ribbons, std::size_t key,
                   std::vector<std::uint32_t>& words)
{
    Arrays arrays(words, ids.size(), std::size_t(CurveLeaf::arrays_at_time(ribbons)));
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const std::uint32_t flags = shape_of_segment(tables, ids[i] >> piece_bits).flags;
        const PieceEnds ends = piece_ends(tables, ids[i], flags & ShapeRecord::linear_curves, key);
        arrays.set_vector(0, i, ends.a);
        arrays.set(3, i, flags & ShapeRecord::solid_curves ? -ends.a.r : ends.a.r);
        arrays.set_vector(4, i, ends.b);
        arrays.set(7, i, flags & ShapeRecord::fibers ? -ends.b.r : ends.b.r);
        if (!ribbons) continue;
        arrays.set_vector(8, i, ends.tangent_a);
        arrays.set_vector(11, i, ends.tangent_b);
    }
}

void put_curves(const GeometryTables& tables, const std::vector<std::uint32_t>& ids, bool ribbons,
                std::vector<std::uint32_t>& words)
{
    Arrays places(words, ids.size(), CurveLeaf::first_time);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const std::uint32_t piece = ids[i] & (CurveRecord::max_pieces - 1);
        const float share = 1 / float(tables.curves[ids[i] >> piece_bits].pieces);
        places.set(0, i, float(piece) * share);
        places.set(1, i, share);
    }
    const std::size_t times = any_moves(tables, ids) ? tables.vertex_times.size() : 1;
    for (std::size_t key = 0; key < times; ++key) put_curves_at(tables, ids, ribbons, key, words);
}

void put_points(const GeometryTables& tables, const std::vector<std::uint32_t>& ids, std::vector<std::uint32_t>& words)
{
    Arrays arrays(words, ids.size(), 4);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const Vec4f& p = tables.points[ids[i]];
        arrays.set_vector(0, i, {p.x, p.y, p.z, 0});
        arrays.set(3, i, p.w);
    }
}

}  // namespace

const ShapeRecord& shape_of_segment(const GeometryTables& tables, std::uint32_t segment)
{
    return tables.shapes[tables.shape_of_primitive[tables.first_curve() + segment]];
}

PieceEnds piece_ends(const GeometryTables& tables, std::uint32_t id, bool linear, std::size_t key)
{
    const CurveRecord& curve = tables.curves[id >> piece_bits];
    const std::uint32_t piece = id & (CurveRecord::max_pieces - 1);
    std::size_t first = curve.first_point;
    if (key > 0) first += key * shape_of_segment(tables, id >> piece_bits).moving_vertices;
    CurvePoint<float> p[4];
    for (std::size_t i = 0; i < (linear ? 2 : 4); ++i) {
        const Vec4f& v = tables.curve_points[first + i];
        p[i] = {v.x, v.y, v.z, v.w};
    }
    if (linear) {
        const CurvePoint<float> along{p[1].x - p[0].x, p[1].y - p[0].y, p[1].z - p[0].z, 0};
        return {p[0], p[1], along, along};
    }
    const float share = 1 / float(curve.pieces), begin = float(piece) * share, end = float(piece + 1) * share;
    return {bezier(p, begin), bezier(p, end), bezier_tangent(p, begin), bezier_tangent(p, end)};
}

Box box_of(const PieceEnds& ends)
{
    const CurvePoint<float>&a = ends.a, &b = ends.b;
    // The radii are enlarged slightly because computed distances have rounding errors of their own.
    const double ra = a.r * (1 + 0x1p-16), rb = b.r * (1 + 0x1p-16);
    const double low[3] = {std::min(a.x - ra, b.x - rb), std::min(a.y - ra, b.y - rb), std::min(a.z - ra, b.z - rb)};
    const double high[3] = {std::max(a.x + ra, b.x + rb), std::max(a.y + ra, b.y + rb), std::max(a.z + ra, b.z + rb)};
    // The box is rounded outward so that it contains the exact one.
    constexpr float inf = std::numeric_limits<float>::infinity();
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        box.v[axis] = std::nextafter(float(low[axis]), -inf);
        box.v[4 + axis] = std::nextafter(float(-high[axis]), -inf);
    }
    return box;
}

IndexedTriangles::Vertex IndexedTriangles::vertex(BvhKey key, int corner, const Vec3f& position) const
{
    if (moving_) return {tables_.triangles[3 * std::size_t(key >> 1) + std::size_t(corner)], 0, 0};
    return std::bit_cast<Vertex>(position);
}

bool IndexedTriangles::add(BvhKey key)
{
    if (count_ == bvh_width) return false;
    const int before = vertex_count_;
    Vec3f positions[3];
    vertices_of(tables_, key, positions);
    for (int k = 0; k < 3; ++k) {
        const Vertex v = vertex(key, k, positions[k]);
        const int number = int(std::find(vertices_, vertices_ + vertex_count_, v) - vertices_);
        if (number == IndexedLeaf::max_vertices) {
            vertex_count_ = before;
            return false;
        }
        if (number == vertex_count_) {
            vertices_[vertex_count_] = v;
            triangle_[vertex_count_] = std::uint8_t(count_);
            corner_[vertex_count_++] = std::uint8_t(k);
        }
        corners_[k][count_] = std::uint8_t(number);
    }
    keys_[count_++] = key;
    return true;
}

std::size_t IndexedTriangles::words() const
{
    const std::size_t n = std::size_t(count_), v = std::size_t(vertex_count_);
    return in_units(BvhLeaf::header(n) + IndexedLeaf::corner_words(n) + 3 * v * times());
}

std::size_t IndexedTriangles::put(std::vector<std::uint32_t>& words) const
{
    const std::size_t first = words.size(), n = std::size_t(count_), v = std::size_t(vertex_count_);
    words.push_back(std::uint32_t(n | v << IndexedLeaf::vertices_shift) | (moving_ ? IndexedLeaf::moving_bit : 0));
    words.insert(words.end(), keys_, keys_ + n);
    words.resize(first + BvhLeaf::header(n) + IndexedLeaf::corner_words(n));
    auto* const bytes = reinterpret_cast<std::uint8_t*>(&words[first + BvhLeaf::header(n)]);
    for (std::size_t k = 0; k < 3; ++k) std::memcpy(bytes + k * n, corners_[k], n);
    for (std::size_t time = 0; time < times(); ++time) {
        Arrays arrays(words, v, 3);
        for (std::size_t i = 0; i < v; ++i) {
            Vec3f corners[3];
            vertices_of(tables_, keys_[triangle_[i]], corners, time);
            const Vec3f& p = corners[corner_[i]];
            arrays.set_vector(0, i, {p.x, p.y, p.z, 0});
        }
    }
    words.resize(in_units(words.size()));
    return first;
}

bool fit_together(const GeometryTables& tables, std::uint32_t kinds, const std::uint32_t* ids, std::size_t n)
{
    if (kinds != Item::moving_triangle || 3 * n <= IndexedLeaf::max_vertices) return true;
    IndexedTriangles triangles(tables, true);
    for (std::size_t i = 0; i < n; ++i)
        if (!triangles.add(ids[i])) return false;
    return true;
}

std::size_t put_leaf(const GeometryTables& tables, std::uint32_t kind, const std::uint32_t* first_id, std::size_t n,
                     std::vector<std::uint32_t>& words)
{
    std::vector<std::uint32_t> ids(first_id, first_id + n);
    std::sort(ids.begin(), ids.end());
    const std::size_t first = words.size();
    const bool curves = kind == Item::curve || kind == Item::ribbon;
    if (kind == Item::moving_triangle) {
        IndexedTriangles triangles(tables, true);
        for (std::uint32_t id : ids) triangles.add(id);
        return triangles.put(words);
    }
    words.push_back(std::uint32_t(n) | (curves && any_moves(tables, ids) ? BvhLeaf::moving_bit : 0));
    for (std::uint32_t id : ids) words.push_back(curves ? id >> piece_bits : id);
    if (curves) put_curves(tables, ids, kind == Item::ribbon, words);
    if (kind == Item::point) put_points(tables, ids, words);
    words.resize(in_units(words.size()));
    return first;
}

}  // namespace fathom::bvh
