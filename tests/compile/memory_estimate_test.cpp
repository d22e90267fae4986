// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <limits>

#include "base/machine.h"
#include "fathom/error.h"
#include "fathom/image.h"
#include "fathom/memory.h"
#include "fathom/render.h"
#include "scene/check.h"

namespace fathom {
namespace {

double of(const std::vector<MemoryEstimate>& needs, const std::string& what)
{
    for (const MemoryEstimate& need : needs)
        if (need.what == what) return need.bytes;
    return -1;
}

/// A triangle fan around the origin.
Mesh fan(std::uint32_t triangles)
{
    Mesh mesh;
    mesh.positions.push_back({0, 0, 0});
    for (std::uint32_t i = 0; i <= triangles; ++i) mesh.positions.push_back({1, float(i), 0});
    for (std::uint32_t i = 0; i < triangles; ++i)
        for (const std::uint32_t corner : {0u, i + 1, i + 2}) mesh.indices.push_back(corner);
    return mesh;
}

/// A chain of nodes, each with `children` copies of the next one; the last node has the mesh.
SceneDescription nested(const Mesh& mesh, int depth, int children, const Material& material = {})
{
    SceneDescription scene;
    scene.file = "a.json";
    scene.meshes = {mesh};
    scene.materials = {material};
    scene.cameras.emplace_back();
    for (int i = 0; i < depth; ++i) {
        Node& node = scene.nodes.emplace_back();
        if (i + 1 < depth) node.children.assign(std::size_t(children), i + 1);
    }
    scene.nodes.back().shapes = {{MeshInstance{0}, 0, ""}};
    scene.roots = {0};
    return scene;
}

Material glowing()
{
    Material material;
    material.emission.radiance.value = {1, 1, 1};
    return material;
}

TEST(MemoryEstimates, InstancedMeshesCountOnceUnlessSmall)
{
    const double alone = of(estimate_memory(nested(fan(1000), 1, 0), BvhQuality::standard), "triangles");
    EXPECT_GT(alone, 1000 * 100.0);
    // Three copies of three copies make nine: stored once if instanced, nine times if flattened.
    EXPECT_EQ(of(estimate_memory(nested(fan(1000), 3, 3), BvhQuality::standard), "triangles"), alone);
    const double small = of(estimate_memory(nested(fan(10), 1, 0), BvhQuality::standard), "triangles");
    EXPECT_EQ(of(estimate_memory(nested(fan(10), 3, 3), BvhQuality::standard), "triangles"), 9 * small);
    EXPECT_EQ(of(estimate_memory(nested(fan(10), 3, 3), BvhQuality::standard), "shape instances"),
              9 * bytes_per_occurrence);
}

TEST(MemoryEstimates, EachInstancedEmissiveTriangleIsALight)
{
    EXPECT_EQ(of(estimate_memory(nested(fan(1000), 3, 3), BvhQuality::standard), "lights"), 0);
    const double one = of(estimate_memory(nested(fan(1), 1, 0, glowing()), BvhQuality::standard), "lights");
    EXPECT_GE(one, 128);
    EXPECT_EQ(of(estimate_memory(nested(fan(1000), 3, 3, glowing()), BvhQuality::standard), "lights"), 9000 * one);
}

TEST(MemoryEstimates, UnreachableNodesAreNotCounted)
{
    SceneDescription scene = nested(fan(1000), 2, 1);
    scene.roots = {};
    const std::vector<MemoryEstimate> needs = estimate_memory(scene, BvhQuality::standard);
    for (const MemoryEstimate& need : needs) EXPECT_EQ(need.bytes, 0) << need.what;
}

class ImageFileEstimate : public ::testing::Test {
protected:
    ImageFileEstimate()
        : file_(std::filesystem::temp_directory_path() / ("fathom_needs_" + std::to_string(getpid()) + ".png"))
    {
    }
    ~ImageFileEstimate() override { std::filesystem::remove(file_); }

    void write(int bits) const
    {
        Image image;
        image.width = 40, image.height = 30;
        image.layers.push_back({"", {"R", "G", "B"}, std::vector<float>(40 * 30 * 3, 0.3f)});
        WriteOptions options;
        options.png_bits = bits;
        write_image(file_, image, options);
    }
    double textures(std::vector<ColorSpace> spaces) const
    {
        SceneDescription scene = nested(fan(1), 1, 0);
        scene.images.push_back({"a", file_, {}});
        for (const ColorSpace space : spaces) {
            Texture& texture = scene.textures.emplace_back();
            texture.image = 0;
            texture.color_space = space;
        }
        return of(estimate_memory(scene, BvhQuality::standard), "textures");
    }
    std::filesystem::path file_;
};

TEST_F(ImageFileEstimate, TexelsComeFromTheFileHeader)
{
    write(8);
    EXPECT_EQ(textures({ColorSpace::srgb}), 40 * 30 * 4);
    // Two equal uses of an image are stored once.
    EXPECT_EQ(textures({ColorSpace::srgb, ColorSpace::srgb}), 40 * 30 * 4);
    EXPECT_EQ(textures({ColorSpace::srgb, ColorSpace::linear}), 2 * 40 * 30 * 4);
    write(16);
    EXPECT_EQ(textures({ColorSpace::linear}), 40 * 30 * 8);
    EXPECT_EQ(textures({ColorSpace::srgb}), 40 * 30 * 32);
}

TEST_F(ImageFileEstimate, MissingFilesAreNotCounted)
{
    EXPECT_EQ(textures({ColorSpace::srgb}), 0);
}

/// Removes the memory limit at the end of a test.
class Limited {
public:
    explicit Limited(std::uint64_t bytes) { limit_memory(bytes, "--memory"); }
    ~Limited() { limit_memory(std::numeric_limits<std::uint64_t>::max(), "no limit"); }
};

TEST(MemoryLimit, TellsTheLargestTakersAndWhatIsAllowed)
{
    const Limited limit(8000000000);
    EXPECT_LE(available_memory_bytes(), 8000000000u);
    try {
        check_memory("a.json",
                     {{"triangles", 2.9e9}, {"film of 8192x8192", 1.3e9}, {"textures", 5.1e9}, {"lights", 1e6}});
        FAIL() << "not refused";
    } catch (const Error& error) {
        EXPECT_STREQ(
            error.what(),
            "a.json: needs about 9.3 GB (textures 5.1, triangles 2.9, film of 8192x8192 1.3), --memory allows 8 GB");
    }
    check_memory("a.json", {{"triangles", 2.9e9}, {"film of 8192x8192", 1.3e9}});
}

TEST(MemoryLimit, WhatIsTakenCounts)
{
    constexpr std::uint64_t more = 100000000;
    {
        const Limited limit(resident_memory("/") + more);
        EXPECT_LT(available_memory_bytes(), 2 * more);
        EXPECT_THROW(check_memory("a.json", {{"film", 2e8}}), Error);
    }
    // The resident memory already exceeds the limit.
    const Limited limit(1000000);
    EXPECT_EQ(available_memory_bytes(), 0u);
    EXPECT_EQ(available_memory_text(), "0 MB of the 1 MB allowed by --memory are left");
    EXPECT_THROW(check_memory("a.json", {{"film", 1}}), Error);
}

TEST(MemoryLimit, LightsThatDoNotFitAreRefusedBeforeTheyAreMade)
{
    // The memory of the triangles fits twice, but not their lights as well.
    SceneDescription scene = nested(fan(300000), 2, 1, glowing());
    scene.nodes[0].camera = 0;
    const double triangles = of(estimate_memory(scene, BvhQuality::standard), "triangles");
    const Limited limit(resident_memory("/") + std::uint64_t(2 * triangles));
    Warnings warnings;
    try {
        Scene::compile(scene, "", warnings);
        FAIL() << "not refused";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("lights"), std::string::npos) << error.what();
    }
}

TEST(MemoryLimit, InWords)
{
    EXPECT_EQ(memory_text(512e6), "512 MB");
    EXPECT_EQ(memory_text(999.6e6), "1 GB");
    EXPECT_EQ(memory_text(8e9), "8 GB");
    EXPECT_EQ(memory_text(1.5 * 1024 * 1024 * 1024), "1.6 GB");
}

}  // namespace
}  // namespace fathom
