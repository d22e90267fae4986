/// Building: items, a binary tree over them, whose nodes are moved to better places, and its collapse to wide nodes.
/// Nothing depends on the number of threads.

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/bvh/build/collapse.h"
#include "geometry/bvh/build/motion.h"
#include "geometry/bvh/build/reinsertion.h"
#include "geometry/bvh/build/spatial.h"

namespace fathom {

namespace bvh {

namespace {

std::uint32_t shape_end(const GeometryTables& tables, std::uint32_t shape)
{
    std::uint32_t end = tables.shapes[shape].first_primitive;
    while (end < tables.primitive_count() && tables.shape_of_primitive[end] == shape) ++end;
    return end;
}

/// Nodes from a reference down to the deepest leaf.
int depth_of(const BvhData& bvh, std::uint32_t reference)
{
    if (!BvhReference::is_node(reference)) return 0;
    const BvhNode& node = bvh.nodes[BvhReference::node(reference)];
    int depth = 0;
    for (int k = 0; k < bvh_width && node.bounds[0][k] <= node.bounds[3][k]; ++k)
        depth = std::max(depth, depth_of(bvh, node.child[k]));
    return depth + 1;
}

/// At each level all children but one wait; on top there is room for a vector, and an end for each of the two spaces.
int stack_size_of(const BvhData& bvh)
{
    int world = bvh.empty ? 0 : depth_of(bvh, bvh.root), mesh = 0;
    for (const BvhData::Mesh& m : bvh.meshes)
        if (!m.empty) mesh = std::max(mesh, depth_of(bvh, m.root));
    return ((bvh_width - 1) * (world + mesh) + bvh_deferred + 2 + 2 * bvh_width) / bvh_width * bvh_width;
}

void count_children(BvhData& bvh, std::uint32_t reference)
{
    if (!BvhReference::is_node(reference)) return;
    const BvhNode& node = bvh.nodes[BvhReference::node(reference)];
    ++bvh.statistics.nodes;
    for (int k = 0; k < bvh_width && node.bounds[0][k] <= node.bounds[3][k]; ++k) {
        ++bvh.statistics.children;
        count_children(bvh, node.child[k]);
    }
}

/// Triangles that stand still: those of quads count twice.
std::size_t count_triangles(const GeometryTables& tables)
{
    std::size_t n = tables.triangle_count() + 2 * tables.quads.size();
    if (tables.vertex_times.empty()) return n;
    for (std::uint32_t i = 0; i < tables.triangle_count(); ++i)
        n -= tables.shapes[tables.shape_of_primitive[i]].moving_vertices > 0;
    return n;
}

/// A few rounds over the largest hundredths find most of what there is to gain in interiors, and take a tenth of the
/// time; all nodes gain a little more, and on foliage.
constexpr Reinsertion few{3, 0.02}, many{1, 1.0};

/// The largest of what building took at its stages.
struct Peak {
    std::size_t bytes = 0;
    void see(std::size_t now) { bytes = std::max(bytes, now); }
};

BinaryTree split_and_reinsert(const GeometryTables& tables, ItemList& list, TreeBuild level, bool cut, Peak& peak)
{
    BinaryTree tree = split_items(tables, list, level, cut);
    peak.see(tree.peak_bytes);
    if (level == TreeBuild::fast) return tree;
    reinsert(tree, few);
    peak.see(tree.bytes() + few.bytes(tree.nodes.size()));
    return tree;
}

/// make_list  makes the same list each time
template <class MakeList>
BinaryTree binary_tree(const GeometryTables& tables, TreeBuild level, const MakeList& make_list, ItemList& list,
                       Peak& peak)
{
    BinaryTree tree = split_and_reinsert(tables, list, level, false, peak);
    if (level != TreeBuild::high) return tree;
    const auto again = [&](bool cut) {
        tree = {};
        list = make_list();
        tree = split_and_reinsert(tables, list, level, cut, peak);
        return expected_cost(tables, tree);
    };
    float cost = expected_cost(tables, tree);
    // Cuts help much where triangles are large and lie aslant, but may harm where they are axis-aligned.
    bool cut = false;
    if (list.triangles > 0) {
        const float cost_cut = again(true);
        cut = cost_cut < cost;
        cost = cut ? cost_cut : again(false);
    }
    reinsert(tree, many);
    peak.see(tree.bytes() + many.bytes(tree.nodes.size()));
    // The sum of areas, which reinsertion lowers, is not quite what wide nodes cost.
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

}  // namespace bvh

void build_bvh(const GeometryTables& tables, BvhData& tree, TreeBuild level)
{
    using namespace bvh;
    tree.tables = &tables;
    for (const ShapeRecord& shape : tables.shapes)
        tree.any_alpha_shape |= (shape.flags & ShapeRecord::alpha_tested) != 0;

    tree.moving = anything_moves(tables);

    // What instances place, in order of their first use.
    std::vector<std::uint32_t> mesh_shapes;
    for (const InstanceRecord& instance : tables.instances) {
        if (instance.mesh_shape >= tree.meshes.size()) tree.meshes.resize(instance.mesh_shape + 1);
        BvhData::Mesh& mesh = tree.meshes[instance.mesh_shape];
        if (mesh.root == 0) mesh_shapes.push_back(instance.mesh_shape);
        mesh.root = 1;  // seen
    }
    std::size_t triangles = count_triangles(tables);
    // Room that stays empty takes no memory.
    if (level == TreeBuild::high) triangles += std::size_t(most_cuts * double(triangles));
    if (triangles > BvhReference::max_triangles)
        throw std::length_error("a scene can have at most 134,217,728 triangles");
    tree.triangles = LargeArray<float>(9 * triangles + bvh_width);
    tree.keys = LargeArray<BvhKey>(triangles + bvh_width);

    std::vector<BvhNode> nodes;
    std::size_t next_triangle = 0;
    Peak peak;
    const auto leaves_bytes = [&] {
        return (9 * sizeof(float) + sizeof(BvhKey)) * (next_triangle + bvh_width) + tree.others.size() * 4;
    };
    std::vector<MovingBox> mesh_boxes(tree.meshes.size());
    /// Its box and root are then known.
    const auto add_tree = [&](const auto& make_list, ItemList& list, std::uint32_t& root) {
        tree.statistics.leaf_primitives += list.count;
        const std::size_t first = nodes.size();
        Peak binary_peak;
        BinaryTree binary = binary_tree(tables, level, make_list, list, binary_peak);
        peak.see(leaves_bytes() + nodes.size() * sizeof(BvhNode) + binary_peak.bytes);
        const std::size_t binary_bytes = binary.bytes(), others_before = tree.others.size() * 4;
        root = collapse(tables, binary, tree, nodes, next_triangle, level == TreeBuild::compact);
        // With the binary tree, then while what chunks hold is moved.
        const std::size_t moved = (nodes.size() - first) * sizeof(BvhNode) + tree.others.size() * 4 - others_before;
        peak.see(leaves_bytes() + nodes.size() * sizeof(BvhNode) + std::max(binary_bytes, moved));
        if (!tree.moving) return MovingBox{list.box, list.box};
        return add_motion(tables, tree, mesh_boxes, nodes, first, root, list.box);
    };
    for (std::uint32_t shape : mesh_shapes) {
        const auto make_list = [&] {
            return shape_items(tables, tree, tables.shapes[shape].first_primitive, shape_end(tables, shape));
        };
        ItemList list = make_list();
        BvhData::Mesh& mesh = tree.meshes[shape];
        mesh.empty = list.count == 0;
        if (!mesh.empty) mesh_boxes[shape] = add_tree(make_list, list, mesh.root);
        if (!mesh.empty) mesh.radius = mesh_boxes[shape].radius();
    }
    {
        const auto make_list = [&] { return world_items(tables, tree, mesh_boxes); };
        ItemList list = make_list();
        tree.empty = list.count == 0;
        if (!tree.empty)
            tree.statistics.diagonal =
                std::hypot(list.box.high(0) - list.box.low(0), list.box.high(1) - list.box.low(1),
                           list.box.high(2) - list.box.low(2));
        if (!tree.empty) tree.radius = add_tree(make_list, list, tree.root).radius();
    }
    // Readers take 16 floats at once.
    std::fill_n(tree.triangles.data() + 9 * next_triangle, bvh_width, 0.f);
    tree.others.resize(tree.others.size() + bvh_width);
    tree.nodes = LargeArray<BvhNode>(nodes.size());
    if (!nodes.empty()) std::memcpy(tree.nodes.data(), nodes.data(), nodes.size() * sizeof(BvhNode));
    if (!tree.empty) count_children(tree, tree.root);
    for (const BvhData::Mesh& mesh : tree.meshes)
        if (!mesh.empty) count_children(tree, mesh.root);
    tree.stack_size = stack_size_of(tree);
    BvhStatistics& s = tree.statistics;
    s.bytes = tree.nodes.bytes() + leaves_bytes() + tree.meshes.size() * sizeof(BvhData::Mesh);
    peak.see(s.bytes + tree.nodes.bytes());
    s.peak_bytes = peak.bytes;
}

}  // namespace fathom
