// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <functional>

#include "formats/import_test_helpers.h"
#include "formats/json/json.h"
#include "support/memory_limit.h"

// Large, deeply nested or demanding files: time and memory grow linearly with the file.
namespace fathom::test {
namespace {

class Growth : public ImportTest {
protected:
    /// CPU time of a file of four times the size over that of the file, each the shortest of three runs; CPU time
    /// doesn't depend on other programs.
    double ratio(const std::string& name, const std::function<std::string(int)>& content, int size)
    {
        const auto seconds = [&](int n) {
            const std::filesystem::path file = write(name, content(n));
            double least = 1e9;
            for (int i = 0; i < 3; ++i) {
                const std::clock_t start = std::clock();
                Warnings warnings;
                SceneDescription scene = load_scene(file, {}, warnings);
                add_default_camera(scene, {});
                least = std::min(least, double(std::clock() - start) / CLOCKS_PER_SEC);
            }
            return least;
        };
        const double small = seconds(size);
        return seconds(4 * size) / small;
    }
};

/// Linear time gives a ratio of 4, quadratic time 16.
constexpr double most = 9;

std::string joined(int count, const std::function<std::string(int)>& part)
{
    std::string text;
    for (int i = 0; i < count; ++i) text += (i > 0 ? ",\n" : "") + part(i);
    return text;
}

TEST_F(Growth, NodesOfJson)
{
    EXPECT_LT(ratio(
                  "a.json",
                  [](int n) {
                      return R"({"fathom": 1, "scene": [)" +
                             joined(n,
                                    [](int i) {
                                        return fmt::format(R"({{"sphere": {{"center": [{}, 0, 0], "radius": 0.5}}}})",
                                                           i);
                                    }) +
                             "]}";
                  },
                  10000),
              most);
}

TEST_F(Growth, NamesOfJson)
{
    const auto named = [](int n, const char* table, const char* value) {
        return fmt::format("\"{}\": {{", table) +
               joined(n, [&](int i) { return fmt::format("\"{} {}\": {}", table, i, value); }) + "}";
    };
    EXPECT_LT(
        ratio(
            "a.json",
            [&](int n) {
                return R"({"fathom": 1, )" + named(n, "materials", "{}") + "," +
                       named(n, "nodes", R"({"sphere": {}})") + R"(, "scene": [)" +
                       joined(n,
                              [](int i) {
                                  return fmt::format(
                                      R"({{"instance": "nodes {}"}}, {{"sphere": {{}}, "material": "materials {}"}})",
                                      i, i);
                              }) +
                       "]}";
            },
            10000),
        most);
}

TEST_F(Growth, InvisibleNodesOfGltf)
{
    EXPECT_LT(
        ratio(
            "a.gltf",
            [](int n) {
                return R"({"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_node_visibility"], "nodes": [)" +
                       joined(n,
                              [](int) {
                                  return std::string(
                                      R"({"extensions": {"KHR_node_visibility": {"visible": false}}, "children": []})");
                              }) +
                       "]}";
            },
            20000),
        most);
}

TEST_F(Growth, TexturesOfMtl)
{
    write("none.png", "");
    EXPECT_LT(ratio(
                  "a.obj",
                  [&](int n) {
                      std::string mtl;
                      for (int i = 0; i < n; ++i) mtl += fmt::format("newmtl m{}\nmap_Kd {}.png\n", i, i);
                      write("a.mtl", mtl);
                      return "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
                  },
                  10000),
              most);
}

TEST_F(Growth, MovingNodesWithinMovingNodes)
{
    // Doubling the time at each level would take 2^60 steps.
    std::string scene = R"({"sphere": {"radius": 1}})";
    for (int i = 0; i < 60; ++i)
        scene = R"({"motion": [{"time": 0}, {"time": 1, "transform": {"translate": [1, 0, 0]}}], "children": [)" +
                scene + "]}";
    const SceneDescription loaded = load("a.json", R"({"fathom": 1, "scene": [)" + scene + "]}");
    const Bounds bounds = world_bounds(loaded);
    expect_near(bounds.min, {-1, -1, -1});
    expect_near(bounds.max, {61, 1, 1});
}

TEST_F(Growth, BoundsOfNestedMotionAreThoseOfItsTimes)
{
    // The outer node moves out and back while the inner one stands, and vice versa: both offsets never add up.
    const auto moving = [](const char* times, const std::string& inner) {
        std::string keys;
        const std::string text = times;
        for (std::size_t i = 0; i < 3; ++i)
            keys += fmt::format(R"({}{{"time": {}, "transform": {{"translate": [{}, 0, 0]}}}})", i ? "," : "", text[i],
                                i == 1 ? 10 : 0);
        return fmt::format(R"({{"motion": [{}], "children": [{}]}})", keys, inner);
    };
    const SceneDescription scene = load(
        "a.json", R"({"fathom": 1, "scene": [)" + moving("012", moving("246", R"({"sphere": {"radius": 1}})")) + "]}");
    const Bounds bounds = world_bounds(scene);
    expect_near(bounds.min, {-1, -1, -1});
    expect_near(bounds.max, {11, 1, 1});
}

TEST_F(Growth, NestedTransformsAreRefused)
{
    const std::string deep(100000, '['), end(100000, ']');
    const std::string error =
        error_of("a.json", R"({"fathom": 1, "scene": [{"sphere": {}, "transform": )" + deep + end + "}]}");
    EXPECT_NE(error.find("arrays of transforms are nested more than 32 deep"), std::string::npos) << error;
    EXPECT_EQ(error_of("b.json", R"({"fathom": 1, "scene": [{"sphere": {}, "transform": [[[{"scale": 2}]]]}]})"),
              "loaded");
}

TEST_F(Growth, InvisibleLeavesAreNotRendered)
{
    const SceneDescription scene =
        load("a.gltf", R"({"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_node_visibility"], "cameras": [{"type":
            "perspective", "perspective": {"yfov": 1, "znear": 1}}], "nodes": [{"camera": 0, "extensions":
            {"KHR_node_visibility": {"visible": false}}}, {"camera": 0}]})");
    EXPECT_EQ(scene.nodes.at(0).camera, -1);
    EXPECT_EQ(scene.nodes.at(1).camera, 0);
}

/// A scene file with 2^levels spheres by nested references.
std::string doubled(int levels, const char* again)
{
    std::string nodes = R"("n0": {"sphere": {}})";
    for (int i = 1; i <= levels; ++i)
        nodes += fmt::format(R"(, "n{}": {{"children": ["n{}", "n{}"]}})", i, i - 1, i - 1);
    std::string scene;
    for (int i = 0; i < 8; ++i) scene += fmt::format(R"({}"{}")", i ? "," : "", again);
    return fmt::format(R"({{"fathom": 1, "nodes": {{{}}}, "scene": [{}]}})", nodes, scene);
}

TEST_F(Growth, ManyRootsCountTogether)
{
    // 2^24 spheres with twice that many nodes are below the limit; eight times as many exceed it.
    EXPECT_EQ(error_of("a.json", doubled(24, "n24")),
              "roots: its instances expand to more than 100 million nodes and shapes");
}

TEST_F(Growth, WhatInstancesNeedIsLookedAtBeforeItIsTaken)
{
    const auto file = write("a.json", doubled(20, "n20"));
    const MemoryLimit limit(rlim_t(2) << 30);
    const std::string error = error_of(file);
    EXPECT_EQ(error.rfind("its instances make 8388608 shapes, which need about 4.3 GB of memory; ", 0), 0u) << error;
}

TEST_F(Growth, CopiesOfAModelAreLookedAtBeforeTheyAreMade)
{
    // Each node that overrides a model's material copies all nodes of the model.
    write("model.json",
          R"({"fathom": 1, "scene": [)" + joined(20000, [](int) { return std::string(R"({"sphere": {}})"); }) + "]}");
    const auto file = write("a.json", R"({"fathom": 1, "materials": {"m": {}}, "scene": [)" + joined(2000, [](int) {
                                          return std::string(R"({"model": "model.json", "material": "m"})");
                                      }) + "]}");
    const MemoryLimit limit(rlim_t(1) << 30);
    const std::string error = error_of(file);
    EXPECT_NE(error.find("a copy of the model with other materials needs "), std::string::npos) << error;
}

TEST(JsonObjects, FindKeysAmongMany)
{
    std::string text = "{";
    for (int i = 0; i < 1000; ++i) text += fmt::format("{}\"k{}\": {}", i ? "," : "", i * 7919 % 1000, i);
    Json json = parse_json("a", text + "}", DuplicateKeys::error);
    ASSERT_EQ(json.size(), 1000u);
    int position = 0;
    for (const auto& [key, value] : json.items()) {
        EXPECT_EQ(key, fmt::format("k{}", position * 7919 % 1000));
        EXPECT_EQ(value, position++);
    }
    for (int i = 0; i < 1000; ++i) EXPECT_EQ(json[fmt::format("k{}", i * 7919 % 1000)], i);
    EXPECT_FALSE(json.contains("k1000"));
    // Erasing and inserting keys works, although Fathom itself never does so.
    json.erase("k5");
    json["new"] = 1;
    json["k5"] = 2;
    EXPECT_EQ(json.size(), 1001u);
    EXPECT_EQ(json["k5"], 2);
    EXPECT_EQ(json["k6"], parse_json("a", text + "}", DuplicateKeys::error)["k6"]);
    EXPECT_THROW(parse_json("a", text + ", \"k5\": 0}", DuplicateKeys::error), Error);
    EXPECT_EQ(parse_json("a", text + ", \"k5\": 0}", DuplicateKeys::last_wins)["k5"], 0);
}

}  // namespace
}  // namespace fathom::test
