// SPDX-License-Identifier: Apache-2.0
#include <functional>

#include "fathom/scene_file.h"
#include "formats/import_test_helpers.h"
#include "gltf_builder.h"

namespace fathom::test {
namespace {

/// Tests of the selection of a scene and of a material variant in glTF files.
class GltfChoices : public ImportTest {
protected:
    /// Three colors: the first and second variants select the first two, the default material is the third.
    static std::string two_variants(const std::string& mappings)
    {
        GltfBuilder builder;
        return builder.one_primitive(fmt::format(R"("attributes": {{"POSITION": {}}}, "material": 2,
                           "extensions": {{"KHR_materials_variants": {{"mappings": {}}}}})",
                                                 builder.triangle(), mappings),
                                     R"("materials": [{"name": "red"}, {"name": "green"}, {"name": "blue"}],
               "extensionsUsed": ["KHR_materials_variants"], "extensionsRequired": ["KHR_materials_variants"],
               "extensions": {"KHR_materials_variants": {"variants":
                   [{"name": "dawn"}, {"name": "noon"}, {"name": "dusk"}]}})");
    }
    std::string material_of(const std::string& variant, const std::string& gltf)
    {
        LoadOptions options;
        options.variant = variant;
        const SceneFileContents file = load_scene_file(write("a.gltf", gltf), options, warnings_);
        EXPECT_EQ(file.variants, (std::vector<std::string>{"dawn", "noon", "dusk"}));
        return file.scene.materials.at(std::size_t(file.scene.nodes.at(0).shapes.at(0).material)).name;
    }
    std::string error_of_variant(const std::string& variant, const std::string& gltf)
    {
        try {
            return material_of(variant, gltf);
        } catch (const Error& e) {
            return (e.place().empty() ? "" : e.place() + ": ") + e.message();
        }
    }
};

constexpr const char* mappings = R"([{"material": 0, "variants": [0]}, {"material": 1, "variants": [1]}])";

/// Name of the image of a texture with these members.
std::string picture_of(const std::function<SceneDescription(const std::string&)>& load, const std::string& texture)
{
    GltfBuilder b;
    const SceneDescription scene = load(b.one_primitive(
        fmt::format(R"("attributes": {{"POSITION": {}}}, "material": 0)", b.triangle()),
        fmt::format(
            R"("materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}}}}}], "textures": [{{{}}}],
               "images": [{{"uri": "0.png"}}, {{"uri": "1.webp"}}, {{"uri": "2.avif"}}],
               "extensionsUsed": ["EXT_texture_webp", "EXT_texture_avif"],
               "extensionsRequired": ["EXT_texture_webp", "EXT_texture_avif"])",
            texture)));
    const int shown = scene.materials.at(0).base_color.texture;
    return shown < 0 ? "none" : scene.images.at(std::size_t(scene.textures.at(std::size_t(shown)).image)).name;
}

TEST_F(GltfChoices, PrefersImagesInNewerFormats)
{
    const auto read = [&](const std::string& gltf) { return load("a.gltf", gltf); };
    const std::string webp = R"("EXT_texture_webp": {"source": 1})", avif = R"("EXT_texture_avif": {"source": 2})";
    EXPECT_EQ(picture_of(read, R"("source": 0)"), "0.png");
    EXPECT_EQ(picture_of(read, R"("source": 0, "extensions": {)" + webp + "}"), "1.webp");
    EXPECT_EQ(picture_of(read, R"("source": 0, "extensions": {)" + avif + "}"), "2.avif");
    EXPECT_EQ(picture_of(read, R"("extensions": {)" + webp + ", " + avif + "}"), "2.avif");
    EXPECT_EQ(picture_of(read, R"("source": 0, "extensions": {"EXT_texture_avif": {}})"), "0.png");
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(GltfChoices, AppliesMaterialVariants)
{
    const std::string gltf = two_variants(mappings);
    EXPECT_EQ(material_of("", gltf), "blue");
    EXPECT_EQ(material_of("dawn", gltf), "red");
    EXPECT_EQ(material_of("noon", gltf), "green");
    EXPECT_EQ(material_of("1", gltf), "green");
    // A variant without a mapping for a primitive keeps the default material.
    EXPECT_EQ(material_of("dusk", gltf), "blue");
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(GltfChoices, UnknownAndBrokenVariants)
{
    EXPECT_EQ(error_of_variant("moon", two_variants(mappings)),
              "there is no variant 'moon' among 'dawn', 'noon', 'dusk'; did you mean 'noon'?");
    EXPECT_EQ(error_of_variant("3", two_variants(mappings)), "there is no variant '3' among 'dawn', 'noon', 'dusk'");
    EXPECT_EQ(
        error_of_variant("noon", two_variants(R"([{"material": 7, "variants": [1]}])")),
        "meshes[0].primitives[0].extensions.KHR_materials_variants.mappings[0].material: there is no materials[7]: "
        "the file has 3");
    EXPECT_EQ(error_of_variant("noon", two_variants(R"([{"variants": [1]}])")),
              "meshes[0].primitives[0].extensions.KHR_materials_variants.mappings[0]: key 'material' is missing");
    EXPECT_EQ(error_of_variant("noon", two_variants(R"([{"material": 0, "variants": 1}])")),
              "meshes[0].primitives[0].extensions.KHR_materials_variants.mappings[0].variants: expected an array, "
              "found a number");
    LoadOptions options;
    options.variant = "noon";
    EXPECT_THROW(load_scene(write("a.obj", "v 0 0 0\n"), options, warnings_), Error);
    EXPECT_THROW(load_scene(write("b.gltf", R"({"asset": {"version": "2.0"}})"), options, warnings_), Error);
}

TEST_F(GltfChoices, ScenesAreListed)
{
    const SceneFileContents file = load_scene_file(
        write("a.gltf", R"({"asset": {"version": "2.0"}, "scene": 1, "scenes": [{"name": "a"}, {}], "nodes": [{}]})"),
        {}, warnings_);
    EXPECT_EQ(file.scenes, (std::vector<std::string>{"a", "1"}));
    LoadOptions options;
    options.scene = "b2";
    try {
        load_scene(write("a.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"name": "b1"}, {"name": "c1"}]})"),
                   options, warnings_);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.message(), "there is no scene 'b2' among 'b1', 'c1'");
    }
}

}  // namespace
}  // namespace fathom::test
