// SPDX-License-Identifier: Apache-2.0
/// BVH construction: items, a binary tree, its optimization by reinsertion, and its collapse to wide nodes. The result
/// does not depend on the number of threads.

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/bvh/builder/builder.h"
#include "geometry/bvh/builder/collapse.h"
#include "geometry/bvh/builder/motion.h"
#include "geometry/bvh/builder/reinsertion.h"
#include "geometry/bvh/builder/spatial.h"

namespace fathom {

namespace bvh {

namespace {

/// Prefetching costs time and gains nothing for trees that fit into the caches (measured); this is the assumed size.
constexpr std::size_t bytes_of_caches = std::size_t(32) << 20;

std::uint32_t shape_end(const GeometryTables& tables, std::uint32_t shape)
{
    std::uint32_t end = tables.shapes[shape].first_primitive;
    while (end < tables.primitive_count() && tables.shape_of_primitive[end] == shape) ++end;
    return end;
}

/// Size of the traversal stack: at each level all children but one may wait. The rest is padding for vector stores and
/// an end marker for each of the two spaces.
int stack_size_of(int world_depth, int mesh_depth)
{
    return ((bvh_width - 1) * (world_depth + mesh_depth) + bvh_deferred + 2 + 2 * bvh_width) / bvh_width * bvh_width;
}

/// Number of static triangles; a quad counts as two.
std::size_t count_triangles(const GeometryTables& tables)
{
    std::size_t n = tables.triangle_count() + 2 * tables.quads.size();
    if (tables.vertex_times.empty()) return n;
    for (std::uint32_t i = 0; i < tables.triangle_count(); ++i)
        n -= tables.shapes[tables.shape_of_primitive[i]].moving_vertices > 0;
    return n;
}

/// A few rounds over the 2 % largest nodes find most of the gain in interiors and take a tenth of the time of a round
/// over all nodes, which gains slightly more, and on foliage.
constexpr Reinsertion once{1, 0.02}, few{3, 0.02}, many{1, 1.0};

BinaryTree split_and_reinsert(const GeometryTables& tables, ItemList& list, BvhQuality level, bool cut, Peak& peak)
{
    BinaryTree tree = split_items(tables, list, level, cut);
    peak.track_peak(tree.peak_bytes);
    const Reinsertion& how = level == BvhQuality::fast ? once : few;
    reinsert(tree, how);
    peak.track_peak(tree.bytes() + how.bytes(tree.nodes.size()));
    return tree;
}

/// Builds the best binary tree at the given level. make_list: creates the item list anew; each call gives an equal
/// list.
template <class MakeList>
BinaryTree binary_tree(const GeometryTables& tables, BvhQuality level, const MakeList& make_list, ItemList& list,
                       Peak& peak)
{
    BinaryTree tree = split_and_reinsert(tables, list, level, false, peak);
    if (level != BvhQuality::high) return tree;
    const auto again = [&](bool cut) {
        tree = {};
        list = make_list();
        tree = split_and_reinsert(tables, list, level, cut, peak);
        return expected_cost(tables, tree);
    };
    float cost = expected_cost(tables, tree);
    // Spatial splits help for large, slanted triangles, but may hurt where triangles are axis-aligned.
    bool cut = false;
    if (list.triangles > 0) {
        const float cost_cut = again(true);
        cut = cost_cut < cost;
        cost = cut ? cost_cut : again(false);
    }
    reinsert(tree, many);
    peak.track_peak(tree.bytes() + many.bytes(tree.nodes.size()));
    // Reinsertion minimizes the sum of areas, which only approximates the cost of wide nodes; if that cost rose, the
    // tree is rebuilt without it.
    if (expected_cost(tables, tree) > cost) again(cut);
    return tree;
}

bool anything_moves(const GeometryTables& tables)
{
    if (!shutter_takes_time(tables)) return false;
    if (!tables.vertex_times.empty() || !tables.poses.empty()) return true;
    return std::any_of(tables.spheres.begin(), tables.spheres.end(),
                       [](const SphereRecord& s) { return s.motion.x != 0 || s.motion.y != 0 || s.motion.z != 0; });
}

}  // namespace

void BvhBuilder::build()
{
    tree_.tables = &tables_;
    tree_.moving = anything_moves(tables_);
    const std::vector<std::uint32_t> shapes = find_meshes();
    std::size_t triangles = count_triangles(tables_);
    // Space is reserved generously, since pages that are never written take no memory.
    if (level_ == BvhQuality::high) triangles += std::size_t(max_cuts * double(triangles));
    if (triangles > BvhReference::max_triangles)
        throw std::length_error("a scene can have at most 134,217,728 triangles");
    tree_.triangles = LargeArray<float>(9 * triangles + bvh_width);
    tree_.keys = LargeArray<BvhKey>(triangles + bvh_width);
    meshes_.resize(tree_.meshes.size());
    boxes_.resize(tree_.meshes.size());
    for (std::uint32_t shape : shapes) {
        meshes_[shape].first_triangle = next_triangle_;
        add_mesh(shape, level_);
        // A rebuilt mesh may need space for triangles that were degenerate before.
        if (tables_.editable)
            next_triangle_ = std::max(next_triangle_, meshes_[shape].first_triangle + max_triangles_in(shape));
    }
    still_ = add_part([&] { return world_items(tables_, tree_, boxes_); }, level_);
    // Vector loads read 16 floats past the last triangle.
    std::fill_n(tree_.triangles.data() + 9 * next_triangle_, bvh_width, 0.f);
    begin_of_movable_ = {tree_.nodes.size(), tree_.others.size()};
    most_ = {2 * tree_.nodes.size() + 1024, 2 * tree_.others.size() + (1 << 16)};
    add_movable();
    const std::size_t grown = tree_.nodes.capacity() * sizeof(BvhNode);
    if (!tables_.editable) tree_.nodes.shrink_to_fit();
    BvhStatistics& s = tree_.statistics;
    s.bytes = tree_.nodes.capacity() * sizeof(BvhNode) + leaves_bytes() + tree_.meshes.size() * sizeof(BvhData::Mesh);
    tree_.far = s.bytes > bytes_of_caches;
    peak_.track_peak(s.bytes + (tables_.editable ? 0 : grown));
    s.peak_bytes = peak_.bytes;
}

bool BvhBuilder::update(const std::vector<std::uint32_t>& changed)
{
    const BvhStatistics first = tree_.statistics;
    tree_.moving = anything_moves(tables_);
    tree_.nodes.resize(begin_of_movable_.node);
    tree_.others.resize(begin_of_movable_.other);
    for (std::uint32_t shape : changed) {
        // Spatial splits are not used because cut triangles might not fit.
        next_triangle_ = meshes_[shape].first_triangle;
        add_mesh(shape, level_ == BvhQuality::high ? BvhQuality::standard : level_);
    }
    begin_of_movable_ = {tree_.nodes.size(), tree_.others.size()};
    // When former versions of meshes waste too much memory, the caller rebuilds the tree.
    if (tree_.nodes.size() > most_.node || tree_.others.size() > most_.other) return false;
    add_movable();
    tree_.statistics = first;
    return true;
}

/// Lists the shapes that instances use, in order of first use, followed by those that later instances may use.
std::vector<std::uint32_t> BvhBuilder::find_meshes()
{
    std::vector<std::uint32_t> found;
    std::vector<bool> seen(tables_.shapes.size());
    const auto add = [&](std::uint32_t shape) {
        if (!seen[shape]) found.push_back(shape);
        seen[shape] = true;
    };
    for (const InstanceRecord& instance : tables_.instances) add(instance.mesh_shape);
    for (std::uint32_t i = 0; tables_.editable && i < tables_.shape_of_primitive.size(); ++i)
        if (const std::uint32_t shape = tables_.shape_of_primitive[i];
            tables_.shapes[shape].flags & ShapeRecord::only_instanced)
            add(shape);
    if (!found.empty()) tree_.meshes.resize(*std::max_element(found.begin(), found.end()) + 1);
    return found;
}

void BvhBuilder::add_mesh(std::uint32_t shape, BvhQuality level)
{
    const std::uint32_t first = tables_.shapes[shape].first_primitive, end = shape_end(tables_, shape);
    const Part part = add_part([&] { return shape_items(tables_, tree_, first, end); }, level);
    tree_.meshes[shape] = {part.root, part.empty ? 0 : part.box.radius(), part.empty};
    boxes_[shape] = part.box;
    meshes_[shape].depth = part.depth;
}

/// Upper bound on the triangles in a shape; a quad counts as two.
std::size_t BvhBuilder::max_triangles_in(std::uint32_t shape) const
{
    const std::uint32_t first = tables_.shapes[shape].first_primitive;
    if (first >= tables_.first_sphere() || tables_.shapes[shape].moving_vertices > 0) return 0;
    return (first < tables_.first_quad() ? 1u : 2u) * (shape_end(tables_, shape) - first);
}

/// Builds a subtree over one list of items and adds it to the arrays. make_list: creates the list; each call gives an
/// equal one.
template <class MakeList>
BvhBuilder::Part BvhBuilder::add_part(const MakeList& make_list, BvhQuality level)
{
    Part part;
    ItemList list = make_list();
    part.empty = list.count == 0;
    if (part.empty) return part;
    const std::size_t first = tree_.nodes.size();
    tree_.statistics.leaf_primitives += list.count;
    Peak binary_peak;
    BinaryTree binary = binary_tree(tables_, level, make_list, list, binary_peak);
    peak_.track_peak(leaves_bytes() + first * sizeof(BvhNode) + binary_peak.bytes);
    const std::size_t binary_bytes = binary.bytes(), others_before = tree_.others.size() * 4;
    const Collapsed collapsed = collapse(tables_, binary, tree_, next_triangle_, level == BvhQuality::compact);
    part.root = collapsed.root;
    part.depth = collapsed.depth;
    // Peak memory occurs either with the binary tree or while the contents of chunks are moved.
    const std::size_t moved = (tree_.nodes.size() - first) * sizeof(BvhNode) + tree_.others.size() * 4 - others_before;
    peak_.track_peak(leaves_bytes() + tree_.nodes.size() * sizeof(BvhNode) + std::max(binary_bytes, moved));
    part.box = {list.box, list.box};
    if (tree_.moving) part.box = add_motion(tables_, tree_, boxes_, first, part.root, list.box);
    return part;
}

/// Builds the BVH over movable instances and joins it with that of static items.
void BvhBuilder::add_movable()
{
    Part world = still_;
    if (tables_.editable) {
        const Part movable = add_part([&] { return movable_items(tables_, tree_, boxes_); }, BvhQuality::standard);
        world = still_.empty ? movable : movable.empty ? still_ : join(still_, movable);
    }
    // Vector loads read 16 words past the last leaf.
    tree_.others.resize(tree_.others.size() + bvh_width);
    tree_.empty = world.empty;
    if (!world.empty) {
        tree_.root = world.root;
        tree_.radius = world.box.radius();
        const Box box = world.box.middle();
        tree_.statistics.diagonal =
            std::hypot(box.high(0) - box.low(0), box.high(1) - box.low(1), box.high(2) - box.low(2));
    }
    int mesh_depth = 0;
    for (const Mesh& mesh : meshes_) mesh_depth = std::max(mesh_depth, mesh.depth);
    tree_.stack_size = stack_size_of(world.depth, mesh_depth);
}

BvhBuilder::Part BvhBuilder::join(const Part& a, const Part& b)
{
    BvhNode node{}, change{};
    const Box boxes[] = {a.box.middle(), b.box.middle()};
    const Subtree subtrees[] = {{a.root, 0.5f, node_cost}, {b.root, 0.5f, node_cost}};
    finish_node(node, boxes, subtrees, 2);
    ++tree_.statistics.nodes;
    tree_.statistics.children += 2;
    Part joined{std::uint32_t(tree_.nodes.size()), a.box, std::max(a.depth, b.depth) + 1, false};
    joined.box.extend(b.box);
    bool moves = false;
    for (int i = 0; i < 2; ++i) moves |= set_motion(node, change, i, node.child[i] == a.root ? a.box : b.box);
    tree_.nodes.push_back(node);
    if (moves) {
        joined.root |= BvhReference::moving_bit;
        tree_.nodes.push_back(change);
    }
    return joined;
}

std::size_t BvhBuilder::leaves_bytes() const
{
    return (9 * sizeof(float) + sizeof(BvhKey)) * (next_triangle_ + bvh_width) + tree_.others.size() * 4;
}

}  // namespace bvh

}  // namespace fathom
