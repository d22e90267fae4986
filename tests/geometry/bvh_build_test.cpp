/// Binary trees before they are collapsed: whether they stay trees, and get better.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "compare_with_force.h"
#include "geometry/bvh/build/collapse.h"
#include "geometry/bvh/build/reinsertion.h"

namespace fathom {
namespace {

using bvh::BinaryNode;
using bvh::BinaryTree;

/// Many small triangles and a few large ones, for which splits find no good place.
GeometryTables small_and_large(int small, int large)
{
    Random random(31);
    GeometryTables tables = soup(small, 100, 1, 32);
    for (int i = 0; i < large; ++i) add_triangle(tables, random.point(100), random.point(100), random.point(100));
    tables.shape_of_primitive.clear();
    finish(tables);
    return tables;
}

BinaryTree split(const GeometryTables& tables, TreeBuild level, bool cut)
{
    BvhData bvh;
    bvh.tables = &tables;
    bvh::ItemList list = bvh::world_items(tables, bvh, {});
    return bvh::split_items(tables, list, level, cut);
}

double sum_of_areas(const BinaryTree& tree)
{
    double sum = 0;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i)
        if (!tree.nodes[i].leaf) sum += tree.nodes[i].box().half_area();
    return sum;
}

bool contains(const BinaryNode& node, const BinaryNode& child)
{
    for (int axis = 0; axis < 3; ++axis)
        if (!(node.low[axis] <= child.low[axis] && node.minus_high[axis] <= child.minus_high[axis])) return false;
    return true;
}

/// The ids of all leaves, sorted; each node is met once, by its parent, whose box holds it.
std::vector<std::uint32_t> check(const BinaryTree& tree, std::size_t& deepest)
{
    std::vector<std::uint32_t> ids;
    std::size_t met = 0;
    std::vector<std::pair<std::uint32_t, std::size_t>> waiting{{0, 0}};
    deepest = 0;
    while (!waiting.empty()) {
        const auto [i, depth] = waiting.back();
        waiting.pop_back();
        deepest = std::max(deepest, depth);
        if (++met > tree.nodes.size()) {
            ADD_FAILURE() << "no tree";
            return ids;
        }
        const BinaryNode& node = tree.nodes[i];
        if (node.leaf) {
            ids.insert(ids.end(), &tree.ids[node.left], &tree.ids[node.left] + node.count);
            continue;
        }
        for (std::uint32_t child : {node.left, node.right}) {
            EXPECT_EQ(tree.nodes[child].parent, i);
            EXPECT_TRUE(contains(node, tree.nodes[child]));
            waiting.push_back({child, depth + 1});
        }
    }
    EXPECT_EQ(met, tree.nodes.size());
    std::sort(ids.begin(), ids.end());
    return ids;
}

TEST(BvhBuild, reinsertion_lowers_the_cost_of_the_same_leaves)
{
    const GeometryTables tables = small_and_large(50'000, 500);
    for (const bool cut : {false, true}) {
        SCOPED_TRACE(cut);
        BinaryTree tree = split(tables, TreeBuild::high, cut);
        std::size_t deepest = 0;
        const auto ids = check(tree, deepest);
        EXPECT_GE(ids.size(), tables.triangle_count());
        double areas = sum_of_areas(tree);
        const double first_areas = areas, first_cost = bvh::expected_cost(tables, tree);
        for (int round = 0; round < 4; ++round) {
            bvh::reinsert(tree, {1, round == 0 ? 0.02 : 1.0});
            EXPECT_EQ(check(tree, deepest), ids);
            const double now = sum_of_areas(tree);
            EXPECT_LE(now, areas);
            areas = now;
        }
        EXPECT_LT(areas, 0.9 * first_areas);
        // Where triangles were cut already, inner boxes that wide nodes do without may gain at the others' cost.
        EXPECT_LT(bvh::expected_cost(tables, tree), (cut ? 1.1 : 0.8) * first_cost);
    }
}

TEST(BvhBuild, reinsertion_of_the_largest_finds_most)
{
    const GeometryTables tables = small_and_large(50'000, 500);
    BinaryTree some = split(tables, TreeBuild::standard, false), all = split(tables, TreeBuild::standard, false);
    const double before = sum_of_areas(some);
    bvh::reinsert(some, {3, 0.02});
    bvh::reinsert(all, {3, 1});
    EXPECT_LT(sum_of_areas(all), before);
    EXPECT_GT(before - sum_of_areas(some), 0.3 * (before - sum_of_areas(all)));
}

TEST(BvhBuild, reinsertion_is_the_same_for_any_number_of_threads)
{
    const GeometryTables tables = small_and_large(100'000, 1'000);
    const auto build = [&](std::size_t threads) {
        tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        BinaryTree tree = split(tables, TreeBuild::high, true);
        bvh::reinsert(tree, {2, 0.1});
        bvh::reinsert(tree, {2, 1});
        return tree;
    };
    const BinaryTree one = build(1);
    for (const std::size_t threads : {2, 3}) {
        const BinaryTree many = build(threads);
        ASSERT_EQ(one.nodes.size(), many.nodes.size());
        EXPECT_EQ(std::memcmp(one.nodes.data(), many.nodes.data(), one.nodes.bytes()), 0) << threads;
    }
}

/// Boxes in boxes want to become a list, which stacks have no room for.
TEST(BvhBuild, reinsertion_makes_no_deep_trees)
{
    GeometryTables tables;
    for (int i = 0; i < 20'000; ++i) {
        const float r = 1 + 0.001f * float(i);
        add_triangle(tables, {-r, -r, -r}, {r, r, -r}, {-r, r, r});
    }
    finish(tables);
    BinaryTree tree = split(tables, TreeBuild::high, false);
    std::size_t before = 0, after = 0;
    check(tree, before);
    bvh::reinsert(tree, {6, 1});
    check(tree, after);
    EXPECT_LE(after, std::max<std::size_t>(before, 96));
}

/// The goal for all levels, twice 64, where many triangles are cut.
TEST(BvhBuild, peak_bytes_of_a_triangle)
{
    const GeometryTables tables = small_and_large(150'000, 10'000);
    for (const TreeBuild level : {TreeBuild::fast, TreeBuild::standard, TreeBuild::high}) {
        Bvh bvh;
        bvh.build(tables, level);
        const double triangles = double(tables.triangle_count());
        EXPECT_LE(double(bvh.statistics().peak_bytes), 128 * triangles) << int(level);
        EXPECT_GE(double(bvh.statistics().peak_bytes), 80 * triangles) << int(level);
    }
}

/// Slanted triangles are best cut, axis-aligned ones left whole: the high level does what is better, and never worse
/// than the default one.
TEST(BvhBuild, the_high_level_does_what_is_best)
{
    for (const bool aslant : {false, true}) {
        SCOPED_TRACE(aslant);
        GeometryTables tables = soup(20'000, 100, 1, 33);
        Random random(34);
        for (int i = 0; i < 400; ++i) {
            const Vec3f a = random.point(100);
            const float z = aslant ? 50.f : 0.f;
            add_triangle(tables, a, {a.x + 60, a.y, a.z + z}, {a.x, a.y + 60, a.z + z});
        }
        tables.shape_of_primitive.clear();
        finish(tables);
        Bvh standard, high;
        standard.build(tables, TreeBuild::standard);
        high.build(tables, TreeBuild::high);
        EXPECT_LT(high.statistics().cost, (aslant ? 0.85 : 1.05) * standard.statistics().cost);
        BinaryTree cut = split(tables, TreeBuild::high, true), whole = split(tables, TreeBuild::high, false);
        bvh::reinsert(cut, {3, 0.02});
        bvh::reinsert(whole, {3, 0.02});
        const double best = std::min(bvh::expected_cost(tables, cut), bvh::expected_cost(tables, whole));
        EXPECT_LE(high.statistics().cost, best * 1.0001);
    }
}

}  // namespace
}  // namespace fathom
