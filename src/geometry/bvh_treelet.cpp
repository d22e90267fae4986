#include "geometry/bvh_treelet.h"

#include "geometry/bvh_leaf_data.h"
#include "geometry/bvh_morton.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace fathom::bvh {

namespace {

using V16 = float __attribute__((vector_size(64)));
using V16i = std::int32_t __attribute__((vector_size(64)));

// In units of one node visited; measured on interiors, terrain and foliage (bench/rays.cpp).
constexpr float node_cost = 1.f, triangle_leaf_cost = 0.3f, triangle_cost = 0.06f, other_leaf_cost = 0.7f,
                other_cost = 0.05f, instance_cost = 4.f, moving_leaf_cost = 0.4f, moving_triangle_cost = 0.06f,
                curve_leaf_cost = 1.5f, curve_cost = 0.1f, point_leaf_cost = 0.5f, point_cost = 0.05f;

constexpr int halving_depth = 50;

}  // namespace

float leaf_cost(std::uint32_t kinds, std::size_t count)
{
    constexpr float none = std::numeric_limits<float>::infinity();
    if (count > bvh_width) return none;
    switch (kinds) {
        case Item::triangle:
            return triangle_leaf_cost + triangle_cost * float(count);
        case Item::sphere:
        case Item::disk:
            return other_leaf_cost + other_cost * float(count);
        case Item::instance:
            return count == 1 ? instance_cost : none;
        case Item::moving_triangle:
            return moving_leaf_cost + moving_triangle_cost * float(count);
        case Item::curve:
        case Item::ribbon:
            return curve_leaf_cost + curve_cost * float(count);
        case Item::point:
            return point_leaf_cost + point_cost * float(count);
        default:
            return none;
    }
}

Costs join(const Costs& left, const Costs& right, float half_area, float leaf, Choices& choices)
{
    // padded[15 + j]: the right side as j + 1 children; none below that.
    alignas(64) float padded[2 * bvh_width];
    for (int i = 0; i < bvh_width; ++i) padded[i] = std::numeric_limits<float>::infinity();
    std::memcpy(padded + bvh_width, right.c.data(), sizeof right);
    // Lane i is for i + 1 children, of which the left side gets k.
    V16 best;
    std::memcpy(&best, padded, sizeof best);
    V16i best_k = {};
    for (int k = 1; k < bvh_width; ++k) {
        V16 r;
        std::memcpy(&r, padded + bvh_width - k, sizeof r);
        const V16 sum = left.c[std::size_t(k - 1)] + r;
        const V16i less = sum < best;
        best = less ? sum : best;
        best_k = less ? V16i{} + k : best_k;
    }
    const float node = half_area * node_cost + best[bvh_width - 1];
    const float one = std::min(node, half_area * leaf);
    const V16i split = best < V16{} + one;
    best = split ? best : V16{} + one;
    const V16i stored = split ? best_k : V16i{};
    for (std::size_t i = 1; i < bvh_width; ++i) choices[i] = std::uint8_t(stored[i]);
    choices[0] = half_area * leaf <= node ? 0 : std::uint8_t(best_k[bvh_width - 1]);
    Costs costs;
    std::memcpy(costs.c.data(), &best, sizeof best);
    costs.c[0] = one;
    return costs;
}

namespace {

/// Slots by share of rays stopped, for the work it takes.
void order_by_blocking(const Subtree* children, int count, int* slots)
{
    for (int i = 0; i < count; ++i) {
        slots[i] = i;
        const auto gain = [&](int slot) { return children[slot].blocking / children[slot].cost; };
        for (int j = i; j > 0 && gain(slots[j]) < gain(slots[j - 1]); --j) std::swap(slots[j], slots[j - 1]);
    }
}

/// Slots by octant, from far to near: by the centre's place along the octant's diagonal.
void order_by_distance(BvhNode& node, int count)
{
    for (int octant = 0; octant < 4; ++octant) {
        // The opposite octant goes the other way round.
        float key[bvh_width];
        int slots[bvh_width];
        for (int i = 0; i < bvh_width; ++i) {
            slots[i] = i;
            key[i] = -std::numeric_limits<float>::infinity();
            if (i >= count) continue;
            key[i] = 0;
            for (int axis = 0; axis < 3; ++axis) {
                const float c = node.bounds[axis][i] + node.bounds[3 + axis][i];
                key[i] += octant >> axis & 1 ? -c : c;
            }
        }
        for (int i = 1; i < bvh_width; ++i)
            for (int j = i; j > 0 && key[slots[j]] > key[slots[j - 1]]; --j) std::swap(slots[j], slots[j - 1]);
        std::uint64_t order = 0, opposite = 0;
        for (int i = 0; i < bvh_width; ++i) {
            order |= std::uint64_t(slots[i]) << 4 * i;
            opposite |= std::uint64_t(slots[bvh_width - 1 - i]) << 4 * i;
        }
        for (int word = 0; word < 2; ++word) {
            node.order[octant][word] = std::uint32_t(order >> 32 * word);
            node.order[octant ^ 7][word] = std::uint32_t(opposite >> 32 * word);
        }
    }
}

}  // namespace

Subtree finish_node(BvhNode& node, const Box* boxes, const Subtree* children, int count)
{
    int from[bvh_width];
    order_by_blocking(children, count, from);
    Box all;
    for (int i = 0; i < count; ++i) all.extend(boxes[i]);
    const float half_area = std::max(all.half_area(), std::numeric_limits<float>::min());
    float passing = 1, cost = node_cost;
    constexpr float inf = std::numeric_limits<float>::infinity();
    for (int i = 0; i < bvh_width; ++i) {
        const bool used = i < count;
        node.child[i] = used ? children[from[i]].reference : 0;
        for (int axis = 0; axis < 3; ++axis) {
            node.bounds[axis][i] = used ? boxes[from[i]].low(axis) : inf;
            node.bounds[3 + axis][i] = used ? boxes[from[i]].high(axis) : -inf;
        }
        if (!used) continue;
        const float share = boxes[from[i]].half_area() / half_area;
        passing *= 1 - share * children[from[i]].blocking;
        cost += share * children[from[i]].cost;
    }
    order_by_distance(node, count);
    return {0, 1 - passing, cost};
}

std::size_t halve(const Item* items, std::size_t n, Split& split, CenterBounds& left, CenterBounds& right)
{
    const std::size_t middle = n / 2;
    split.left = split.right = Box();
    for (std::size_t i = 0; i < n; ++i) {
        (i < middle ? split.left : split.right).extend(items[i]);
        (i < middle ? left : right).extend(center2(items[i]));
    }
    return middle;
}

namespace {

class TreeletBuilder {
public:
    TreeletBuilder(Treelet& treelet, const SceneTables& tables, BvhData& bvh)
        : treelet_(treelet), tables_(tables), bvh_(bvh), next_triangle_(treelet.first_triangle)
    {
    }

    void run()
    {
        nodes_.reserve(2 * treelet_.count);
        const Costs costs = build_nodes();
        treelet_.box = nodes_[0].box;
        treelet_.cost = costs.c[0];
        treelet_.nodes.reserve(treelet_.count / 64 + 1);
        treelet_.root = emit(0);
        treelet_.triangles = next_triangle_ - treelet_.first_triangle;
    }

private:
    Costs build_nodes()
    {
        if (treelet_.codes) return split_sorted(0, treelet_.count);
        if (treelet_.side.items.empty())
            return split(treelet_.items, treelet_.count, treelet_.box, treelet_.centers, treelet_.depth);
        pieces_.reserve(treelet_.side.items.size() + treelet_.side.budget);
        return split_space(treelet_.side, treelet_.depth);
    }

    struct Node {
        Box box;
        Choices choices;
        Item* items;
        std::uint32_t count, kinds, right;  ///< the left child follows its parent
        bool whole;                         ///< has no children
    };

    /// Whether a node's few items make one leaf, and then its costs.
    bool stay_together(Node& node, Costs& costs) const
    {
        if (node.count > treelet_.together) return false;
        std::uint32_t kinds = 0;
        for (std::size_t i = 0; i < node.count; ++i) kinds |= node.items[i].kind;
        const float cost = leaf_cost(kinds, node.count);
        if (!(cost < std::numeric_limits<float>::infinity())) return false;
        node.kinds = kinds;
        node.whole = true;
        costs.c.fill(node.box.half_area() * cost);
        return true;
    }

    /// Whether a leaf can hold what would be in it is asked only where a leaf would be best.
    Costs join_sides(Node& node, const Costs& left, const Costs& right, float half_area) const
    {
        const Costs costs = join(left, right, half_area, leaf_cost(node.kinds, node.count), node.choices);
        if (node.choices[0] != 0 || fit_together(tables_, node.kinds, node.items, node.count)) return costs;
        return join(left, right, half_area, std::numeric_limits<float>::infinity(), node.choices);
    }

    /// Adds the node of n items from the first on, split by their codes, and all below.
    Costs split_sorted(std::size_t first, std::size_t n)
    {
        const std::uint32_t self = std::uint32_t(nodes_.size());
        Item* const items = treelet_.items + first;
        nodes_.push_back({Box(), {}, items, std::uint32_t(n), 0, 0, false});
        if (n <= treelet_.together) {
            for (std::size_t i = 0; i < n; ++i) nodes_[self].box.extend(items[i]);
            if (Costs costs; stay_together(nodes_[self], costs)) return costs;
        }
        const std::size_t middle = morton_split(treelet_.codes + first, n);
        const Costs l = split_sorted(first, middle);
        const std::uint32_t right_child = std::uint32_t(nodes_.size());
        const Costs r = split_sorted(first + middle, n - middle);
        Node& node = nodes_[self];
        node.right = right_child;
        node.kinds = nodes_[self + 1].kinds | nodes_[right_child].kinds;
        node.box = nodes_[self + 1].box;
        node.box.extend(nodes_[right_child].box);
        return join_sides(node, l, r, node.box.half_area());
    }

    /// Adds the node of these items, which are moved to pieces_, and all below.
    Costs split_space(ItemSide& all, int depth)
    {
        const std::uint32_t self = std::uint32_t(nodes_.size());
        const std::size_t first = pieces_.size();
        nodes_.push_back({all.box, {}, pieces_.data() + first, std::uint32_t(all.items.size()), 0, 0, false});
        const float area = all.box.half_area();
        if (all.items.size() <= treelet_.together) {
            pieces_.insert(pieces_.end(), all.items.begin(), all.items.end());
            if (Costs costs; stay_together(nodes_[self], costs)) return costs;
            pieces_.resize(first);
        }
        ItemSide left, right;
        SpatialSplitter(tables_, treelet_.root_area).split(all, depth, left, right);
        const Costs l = split_space(left, depth + 1);
        const std::uint32_t right_child = std::uint32_t(nodes_.size());
        const Costs r = split_space(right, depth + 1);
        Node& node = nodes_[self];
        node.right = right_child;
        node.count = std::uint32_t(pieces_.size() - first);
        node.kinds = nodes_[self + 1].kinds | nodes_[right_child].kinds;
        return join_sides(node, l, r, area);
    }

    /// Adds the node of these items and all below.
    Costs split(Item* items, std::size_t n, const Box& box, const CenterBounds& centers, int depth)
    {
        const std::uint32_t self = std::uint32_t(nodes_.size());
        nodes_.push_back({box, {}, items, std::uint32_t(n), 0, 0, false});
        const float area = box.half_area();
        if (Costs costs; stay_together(nodes_[self], costs)) return costs;
        BinMap map(centers, Bins::max);
        Split found;
        CenterBounds left, right;
        std::size_t middle = 0;
        if (n > 2 && depth < halving_depth) found = find_split(items, n, centers, map);
        if (found.axis >= 0)
            middle = partition(items, n, map, found, left, right);
        else
            middle = halve(items, n, found, left, right);
        const Costs l = split(items, middle, found.left, left, depth + 1);
        const std::uint32_t right_child = std::uint32_t(nodes_.size());
        const Costs r = split(items + middle, n - middle, found.right, right, depth + 1);
        Node& node = nodes_[self];
        node.right = right_child;
        node.kinds = nodes_[self + 1].kinds | nodes_[right_child].kinds;
        return join_sides(node, l, r, area);
    }

    /// The nodes that stand for `node` where it may be up to j children.
    void collect(std::uint32_t node, int j, std::uint32_t* out, int& count) const
    {
        const int k = j == 1 || nodes_[node].whole ? 0 : nodes_[node].choices[std::size_t(j - 1)];
        if (k == 0) {
            out[count++] = node;
            return;
        }
        collect(node + 1, k, out, count);
        collect(nodes_[node].right, j - k, out, count);
    }

    bool is_leaf(std::uint32_t node) const { return nodes_[node].whole || nodes_[node].choices[0] == 0; }

    Subtree emit(std::uint32_t node)
    {
        if (is_leaf(node)) return emit_leaf(nodes_[node]);
        const std::uint32_t self = std::uint32_t(treelet_.nodes.size());
        treelet_.nodes.emplace_back();
        std::uint32_t children[bvh_width];
        int count = 0;
        const int k = nodes_[node].choices[0];
        collect(node + 1, k, children, count);
        collect(nodes_[node].right, bvh_width - k, children, count);
        Box boxes[bvh_width];
        for (int i = 0; i < count; ++i) boxes[i] = nodes_[children[i]].box;
        Subtree subtrees[bvh_width];
        // The leaves of one node lie side by side.
        for (int i = 0; i < count; ++i)
            if (is_leaf(children[i])) subtrees[i] = emit_leaf(nodes_[children[i]]);
        for (int i = 0; i < count; ++i)
            if (!is_leaf(children[i])) subtrees[i] = emit(children[i]);
        Subtree all = finish_node(treelet_.nodes[self], boxes, subtrees, count);
        all.reference = self;
        return all;
    }

    Subtree emit_leaf(const Node& node)
    {
        ++treelet_.leaves;
        const float cost = leaf_cost(node.kinds, node.count);
        if (node.kinds == Item::triangle) {
            float area = 0;
            const std::uint32_t reference = emit_triangles(node, area);
            // A ray through the box meets a triangle of area a with a probability of a / half_area, wherever it lies.
            return {reference, 1 - std::exp(-area / std::max(node.box.half_area(), std::numeric_limits<float>::min())),
                    cost};
        }
        constexpr float unknown = 0.5f;
        if (node.kinds == Item::instance)
            return {BvhReference::others(BvhReference::instance, node.items->id), unknown, cost};
        const std::size_t first = put_leaf(tables_, node.items, node.count, treelet_.others);
        const std::uint32_t reference = node.kinds == Item::moving_triangle
                                            ? BvhReference::indexed_triangles(first / BvhLeaf::unit)
                                            : BvhReference::others(reference_kind(node.kinds), first / BvhLeaf::unit);
        return {reference, unknown, cost};
    }

    static float area_of(const Vec3f v[3])
    {
        const float ax = v[1].x - v[0].x, ay = v[1].y - v[0].y, az = v[1].z - v[0].z;
        const float bx = v[2].x - v[0].x, by = v[2].y - v[0].y, bz = v[2].z - v[0].z;
        return 0.5f * std::hypot(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx);
    }

    static BvhReference::Kind reference_kind(std::uint32_t item_kind)
    {
        switch (item_kind) {
            case Item::sphere:
                return BvhReference::spheres;
            case Item::disk:
                return BvhReference::disks;
            case Item::curve:
                return BvhReference::curves;
            case Item::ribbon:
                return BvhReference::ribbons;
            default:
                return BvhReference::points;
        }
    }

    /// area: of them all, added to.
    std::uint32_t emit_triangles(const Node& node, float& area)
    {
        std::sort(node.items, node.items + node.count, [](const Item& a, const Item& b) { return a.id < b.id; });
        // Pieces of one triangle may meet again.
        Item* const end =
            std::unique(node.items, node.items + node.count, [](const Item& a, const Item& b) { return a.id == b.id; });
        const std::size_t n = std::size_t(end - node.items);
        std::uint32_t indexed = 0;
        if (treelet_.compact && emit_indexed(node.items, n, indexed, area)) return indexed;
        const std::size_t first = next_triangle_;
        next_triangle_ += n;
        float* out = &bvh_.triangles[9 * first];
        BvhKey* keys = &bvh_.keys[first];
        if (treelet_.compact) {
            const std::size_t before = treelet_.keys_apart.size();
            treelet_.triangles_apart.resize(9 * (before + n));
            treelet_.keys_apart.resize(before + n);
            out = &treelet_.triangles_apart[9 * before];
            keys = &treelet_.keys_apart[before];
        }
        for (std::size_t i = 0; i < n; ++i) {
            const BvhKey key = node.items[i].id;
            keys[i] = key;
            Vec3f vertices[3];
            vertices_of(tables_, key, vertices);
            area += area_of(vertices);
            for (std::size_t v = 0; v < 3; ++v) {
                out[(3 * v + 0) * n + i] = vertices[v].x;
                out[(3 * v + 1) * n + i] = vertices[v].y;
                out[(3 * v + 2) * n + i] = vertices[v].z;
            }
        }
        return BvhReference::triangles(first, n);
    }

    /// As a leaf that holds each vertex once, if that is smaller by a quarter, as where triangles form a mesh; else
    /// false. For less it isn't worth while: rays that meet leaves of both kinds in turn take longer.
    bool emit_indexed(const Item* items, std::size_t n, std::uint32_t& reference, float& area)
    {
        IndexedTriangles triangles(tables_, false);
        for (std::size_t i = 0; i < n; ++i)
            if (!triangles.add(items[i].id)) return false;
        constexpr std::size_t plain_words = 10;
        if (4 * triangles.words() > 3 * plain_words * n) return false;
        for (std::size_t i = 0; i < n; ++i) {
            Vec3f vertices[3];
            vertices_of(tables_, items[i].id, vertices);
            area += area_of(vertices);
        }
        const std::size_t first = triangles.put(treelet_.others);
        reference = BvhReference::indexed_triangles(first / BvhLeaf::unit);
        return true;
    }

    Treelet& treelet_;
    const SceneTables& tables_;
    BvhData& bvh_;
    std::size_t next_triangle_;
    std::vector<Node> nodes_;
    std::vector<Item> pieces_;  ///< of split_space, from left to right
};

}  // namespace

void Treelet::build(const SceneTables& tables, BvhData& bvh)
{
    TreeletBuilder(*this, tables, bvh).run();
}

}  // namespace fathom::bvh
