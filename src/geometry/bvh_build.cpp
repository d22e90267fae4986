/// Building: items, then an upper tree split by all threads together, then treelets one thread each, then the upper
/// tree is collapsed over their roots. Nothing depends on the number of threads.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/bvh_data.h"
#include "geometry/bvh_items.h"
#include "geometry/bvh_morton.h"
#include "geometry/bvh_motion.h"
#include "geometry/bvh_treelet.h"

namespace fathom {

namespace bvh {

namespace {

constexpr std::size_t treelet_size = 1 << 15;
/// By TreeBuild: so many items stay together where one leaf can hold them. To split four takes half of the time and
/// gains little.
constexpr std::size_t together[] = {4, 4, 4, 4};
constexpr std::size_t parallel_binning = 1 << 17;
constexpr int halving_depth = 50;

struct UpperNode {
    Box box;
    std::unique_ptr<UpperNode> left, right;  ///< none: a treelet
    std::size_t treelet = 0;
    Choices choices{};
    // While splitting:
    Item* items = nullptr;
    std::size_t count = 0;
    CenterBounds centers;
    const std::uint32_t* codes = nullptr;  ///< as in Treelet
    ItemSide side;
};

Split parallel_split(const Item* items, std::size_t n, const CenterBounds& centers, BinMap& map)
{
    if (n < parallel_binning) return find_split(items, n, centers, map);
    map = BinMap(centers, Bins::max);
    // Minima and counts: the same in any order.
    const Bins bins = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, n, parallel_binning / 8), Bins(Bins::max),
        [&](const tbb::blocked_range<std::size_t>& range, const Bins& before) {
            Bins sum = before;
            sum.add(items + range.begin(), range.size(), map);
            return sum;
        },
        [](const Bins& a, const Bins& b) {
            Bins sum = a;
            sum.merge(b);
            return sum;
        });
    return best_split(bins, map);
}

/// Boxes are found when the treelets are built.
void split_sorted(UpperNode& node)
{
    if (node.count <= treelet_size) return;
    const std::size_t middle = morton_split(node.codes, node.count);
    node.left = std::make_unique<UpperNode>();
    node.right = std::make_unique<UpperNode>();
    node.left->items = node.items;
    node.left->codes = node.codes;
    node.left->count = middle;
    node.right->items = node.items + middle;
    node.right->codes = node.codes + middle;
    node.right->count = node.count - middle;
    split_sorted(*node.left);
    split_sorted(*node.right);
}

void split_upper(UpperNode& node, int depth)
{
    if (node.count <= treelet_size) return;
    BinMap map(node.centers, Bins::max);
    Split split;
    if (depth < halving_depth) split = parallel_split(node.items, node.count, node.centers, map);
    node.left = std::make_unique<UpperNode>();
    node.right = std::make_unique<UpperNode>();
    std::size_t middle = 0;
    if (split.axis >= 0)
        middle = partition(node.items, node.count, map, split, node.left->centers, node.right->centers);
    else
        middle = halve(node.items, node.count, split, node.left->centers, node.right->centers);
    node.left->box = split.left;
    node.left->items = node.items;
    node.left->count = middle;
    node.right->box = split.right;
    node.right->items = node.items + middle;
    node.right->count = node.count - middle;
    tbb::parallel_invoke([&] { split_upper(*node.left, depth + 1); }, [&] { split_upper(*node.right, depth + 1); });
}

void split_space(UpperNode& node, const SpatialSplitter& splitter, int depth)
{
    if (node.side.items.size() <= treelet_size) return;
    node.left = std::make_unique<UpperNode>();
    node.right = std::make_unique<UpperNode>();
    splitter.split(node.side, depth, node.left->side, node.right->side);
    tbb::parallel_invoke([&] { split_space(*node.left, splitter, depth + 1); },
                         [&] { split_space(*node.right, splitter, depth + 1); });
}

class TreeBuilder {
public:
    TreeBuilder(const SceneTables& tables, BvhData& bvh, std::vector<BvhNode>& nodes, std::size_t& next_triangle,
                TreeBuild level)
        : tables_(tables), bvh_(bvh), nodes_(nodes), next_triangle_(next_triangle), level_(level)
    {
    }

    /// Adds a tree over the items to nodes and bvh; its root.
    std::uint32_t build(ItemList& list)
    {
        std::vector<std::uint32_t> codes;
        if (level_ == TreeBuild::fast) codes = sort_by_morton_code(list);
        UpperNode top;
        top.box = list.box;
        root_area_ = list.box.half_area();
        if (level_ == TreeBuild::high) {
            top.side.items.assign(list.items.data(), list.items.data() + list.count);
            top.side.box = list.box;
            top.side.centers = list.centers;
            top.side.budget = std::size_t(most_cuts * double(list.triangles));
            list.items = {};
            split_space(top, SpatialSplitter(tables_, root_area_), 0);
        } else {
            top.items = list.items.data();
            top.count = list.count;
            top.centers = list.centers;
            top.codes = codes.empty() ? nullptr : codes.data();
            top.codes ? split_sorted(top) : split_upper(top, 0);
        }
        gather_treelets(top, 0);
        tbb::parallel_for(std::size_t(0), treelets_.size(), [&](std::size_t i) {
            Treelet& t = treelets_[i];
            for (const Item& item : t.side.items) t.triangles += item.kind == Item::triangle;
            for (std::size_t k = 0; k < t.count; ++k) t.triangles += t.items[k].kind == Item::triangle;
        });
        std::size_t room = next_triangle_;
        for (Treelet& t : treelets_) {
            t.first_triangle = room;
            room += t.most_triangles();
        }
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, treelets_.size(), 1),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              for (std::size_t i = range.begin(); i < range.end(); ++i)
                                  treelets_[i].build(tables_, bvh_);
                          });
        list.items = {};
        std::size_t other_words = 0, treelet_nodes = 0;
        for (Treelet& t : treelets_) {
            close_gap(t);
            other_words += t.others.size();
            treelet_nodes += t.nodes.size();
        }
        make_room(bvh_.others, other_words + bvh_width);
        make_room(nodes_, treelet_nodes + treelets_.size());
        bvh_.statistics.cost += solve(top).c[0] / std::max(top.box.half_area(), std::numeric_limits<float>::min());
        for (const Treelet& t : treelets_) bvh_.statistics.leaves += t.leaves;
        return emit(top).reference;
    }

private:
    void gather_treelets(UpperNode& node, int depth)
    {
        if (node.left) {
            gather_treelets(*node.left, depth + 1);
            gather_treelets(*node.right, depth + 1);
            return;
        }
        node.treelet = treelets_.size();
        Treelet treelet;
        treelet.items = node.items;
        treelet.count = node.count;
        treelet.box = node.box;
        treelet.centers = node.centers;
        treelet.depth = depth;
        treelet.codes = node.codes;
        treelet.side = std::move(node.side);
        treelet.root_area = root_area_;
        treelet.together = together[std::size_t(level_)];
        treelet.compact = level_ == TreeBuild::compact;
        treelets_.push_back(std::move(treelet));
    }

    /// Moves the treelet's triangles to the end of those before: how many it has was not known.
    void close_gap(Treelet& t)
    {
        t.moved = t.first_triangle - next_triangle_;
        const float* const triangles = t.compact ? t.triangles_apart.data() : &bvh_.triangles[9 * t.first_triangle];
        const BvhKey* const keys = t.compact ? t.keys_apart.data() : &bvh_.keys[t.first_triangle];
        if (t.triangles > 0 && (t.compact || t.moved > 0)) {
            std::memmove(&bvh_.triangles[9 * next_triangle_], triangles, 36 * t.triangles);
            std::memmove(&bvh_.keys[next_triangle_], keys, 4 * t.triangles);
        }
        next_triangle_ += t.triangles;
        t.triangles_apart = {};
        t.keys_apart = {};
    }

    /// So that many more fit; where few are added often, for more.
    template <class Vector>
    static void make_room(Vector& v, std::size_t more)
    {
        if (v.size() + more > v.capacity()) v.reserve(std::max(v.size() + more, v.size() * 3 / 2));
    }

    Costs solve(UpperNode& node)
    {
        if (!node.left) {
            node.box = treelets_[node.treelet].box;
            Costs costs;
            costs.c.fill(treelets_[node.treelet].cost);
            return costs;
        }
        const Costs left = solve(*node.left), right = solve(*node.right);
        node.box = node.left->box;
        node.box.extend(node.right->box);
        return join(left, right, node.box.half_area(), leaf_cost(0, 0), node.choices);
    }

    void collect(const UpperNode& node, int j, const UpperNode** out, int& count) const
    {
        const int k = j == 1 || !node.left ? 0 : node.choices[std::size_t(j - 1)];
        if (k == 0) {
            out[count++] = &node;
            return;
        }
        collect(*node.left, k, out, count);
        collect(*node.right, j - k, out, count);
    }

    Subtree emit(const UpperNode& node)
    {
        if (!node.left) return emit_treelet(treelets_[node.treelet]);
        const std::size_t self = nodes_.size();
        nodes_.emplace_back();
        const UpperNode* children[bvh_width];
        int count = 0;
        const int k = node.choices[0];
        collect(*node.left, k, children, count);
        collect(*node.right, bvh_width - k, children, count);
        Box boxes[bvh_width];
        Subtree subtrees[bvh_width];
        for (int i = 0; i < count; ++i) {
            boxes[i] = children[i]->box;
            subtrees[i] = emit(*children[i]);
        }
        Subtree all = finish_node(nodes_[self], boxes, subtrees, count);
        all.reference = std::uint32_t(self);
        return all;
    }

    /// Moves the treelet's nodes behind the others; its root.
    Subtree emit_treelet(Treelet& treelet)
    {
        const std::size_t first_node = nodes_.size(), first_other = bvh_.others.size();
        const auto place = [&](std::uint32_t reference) {
            if (BvhReference::is_node(reference)) return std::uint32_t(reference + first_node);
            if (BvhReference::is_triangles(reference)) return std::uint32_t(reference - treelet.moved);
            if (BvhReference::is_indexed_triangles(reference))
                return std::uint32_t(reference + first_other / BvhLeaf::unit);
            if (BvhReference::other_kind(reference) == BvhReference::instance) return reference;
            if (BvhReference::place(reference) + first_other / BvhLeaf::unit >= BvhReference::max_others)
                throw std::length_error("the scene has too many spheres, disks, curves or points");
            return std::uint32_t(reference + first_other / BvhLeaf::unit);
        };
        for (BvhNode& node : treelet.nodes) {
            for (int i = 0; i < bvh_width && node.bounds[0][i] <= node.bounds[3][i]; ++i)
                node.child[i] = place(node.child[i]);
        }
        nodes_.insert(nodes_.end(), treelet.nodes.begin(), treelet.nodes.end());
        bvh_.others.insert(bvh_.others.end(), treelet.others.begin(), treelet.others.end());
        if (bvh_.others.size() / BvhLeaf::unit > BvhReference::max_indexed)
            throw std::length_error("the scene has too many moving triangles");
        treelet.nodes = {};
        treelet.others = {};
        treelet.root.reference = place(treelet.root.reference);
        return treelet.root;
    }

    const SceneTables& tables_;
    BvhData& bvh_;
    std::vector<BvhNode>& nodes_;
    std::size_t& next_triangle_;
    TreeBuild level_;
    float root_area_ = 0;
    std::vector<Treelet> treelets_;
};

std::uint32_t shape_end(const SceneTables& tables, std::uint32_t shape)
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
std::size_t count_triangles(const SceneTables& tables)
{
    std::size_t n = tables.triangle_count() + 2 * tables.quads.size();
    if (tables.vertex_times.empty()) return n;
    for (std::uint32_t i = 0; i < tables.triangle_count(); ++i)
        n -= tables.shapes[tables.shape_of_primitive[i]].moving_vertices > 0;
    return n;
}

/// What the items that the tree is made of take, and what a level of building keeps beside them.
std::size_t bytes_of_items(TreeBuild level, const ItemList& list)
{
    switch (level) {
        case TreeBuild::fast:
            return list.items.bytes() + list.count * 4;  // codes; sorting takes less than the tree
        case TreeBuild::high:
            return list.count * std::size_t(2 * (1 + most_cuts) * sizeof(Item));  // while one is split
        default:
            return list.items.bytes();
    }
}

bool anything_moves(const SceneTables& tables)
{
    if (!shutter_takes_time(tables)) return false;
    if (!tables.vertex_times.empty() || !tables.poses.empty()) return true;
    return std::any_of(tables.spheres.begin(), tables.spheres.end(),
                       [](const SphereTable& s) { return s.motion.x != 0 || s.motion.y != 0 || s.motion.z != 0; });
}

}  // namespace

}  // namespace bvh

void build_bvh(const SceneTables& tables, BvhData& tree, TreeBuild level)
{
    using namespace bvh;
    tree.tables = &tables;
    for (const ShapeTable& shape : tables.shapes) tree.any_alpha_shape |= (shape.flags & ShapeTable::alpha_tested) != 0;

    tree.moving = anything_moves(tables);

    // What instances place, in order of their first use.
    std::vector<std::uint32_t> mesh_shapes;
    for (const InstanceTable& instance : tables.instances) {
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
    std::size_t next_triangle = 0, items_bytes = 0;
    std::vector<MovingBox> mesh_boxes(tree.meshes.size());
    /// Its box and root are then known.
    const auto add_tree = [&](ItemList& list, std::uint32_t& root) {
        tree.statistics.leaf_primitives += list.count;
        items_bytes = std::max(items_bytes, bytes_of_items(level, list));
        const std::size_t first = nodes.size();
        root = TreeBuilder(tables, tree, nodes, next_triangle, level).build(list);
        if (!tree.moving) return MovingBox{list.box, list.box};
        return add_motion(tables, tree, mesh_boxes, nodes, first, root, list.box);
    };
    for (std::uint32_t shape : mesh_shapes) {
        ItemList list = shape_items(tables, tree, tables.shapes[shape].first_primitive, shape_end(tables, shape));
        BvhData::Mesh& mesh = tree.meshes[shape];
        mesh.empty = list.count == 0;
        if (!mesh.empty) mesh_boxes[shape] = add_tree(list, mesh.root);
        if (!mesh.empty) mesh.radius = mesh_boxes[shape].radius();
    }
    {
        ItemList list = world_items(tables, tree, mesh_boxes);
        tree.empty = list.count == 0;
        if (!tree.empty)
            tree.statistics.diagonal =
                std::hypot(list.box.high(0) - list.box.low(0), list.box.high(1) - list.box.low(1),
                           list.box.high(2) - list.box.low(2));
        if (!tree.empty) tree.radius = add_tree(list, tree.root).radius();
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
    const std::size_t others_bytes = tree.others.size() * sizeof(tree.others[0]);
    s.bytes = tree.nodes.bytes() + (9 * sizeof(float) + sizeof(BvhKey)) * (next_triangle + bvh_width) + others_bytes +
              tree.meshes.size() * sizeof(BvhData::Mesh);
    // Either with all items and what treelets are made of them, or without items while the latter are joined.
    s.peak_bytes = s.bytes + std::max(items_bytes, tree.nodes.bytes() + others_bytes);
}

}  // namespace fathom
