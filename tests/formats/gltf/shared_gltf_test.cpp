// SPDX-License-Identifier: Apache-2.0
#include <functional>
#include <vector>

#include "formats/import_test_helpers.h"
#include "formats/mesh/mesh_fault_counts.h"
#include "support/waiting.h"

namespace fathom::test {
namespace {

const std::filesystem::path shared = FATHOM_SHARED_SCENES;

std::size_t triangles_below(const SceneDescription& scene, int index)
{
    std::size_t triangles = 0;
    const Node& node = scene.nodes[index];
    for (const Shape& shape : node.shapes)
        if (const auto* mesh = std::get_if<MeshInstance>(&shape.geometry))
            triangles += scene.meshes[mesh->mesh].indices.size() / 3;
    for (int child : node.children) triangles += triangles_below(scene, child);
    return triangles;
}

struct Model {
    const char* file;
    std::size_t triangles;  ///< counted over all instances, including degenerate triangles
    std::size_t materials, images, cameras, lights;
};
/// Prints the model in the test's name.
void PrintTo(const Model& model, std::ostream* out)
{
    *out << model.file;
}

class SharedGltf : public ImportTest, public ::testing::WithParamInterface<Model> {
protected:
    void SetUp() override
    {
        if (!std::filesystem::exists(shared / "gltf")) GTEST_SKIP() << "no sample models at " << shared;
        ImportTest::SetUp();
    }
};

TEST_P(SharedGltf, HasWhatItShouldHave)
{
    const Model& model = GetParam();
    const SceneDescription scene = load_scene(shared / "gltf" / model.file, {}, warnings_);
    std::size_t triangles = count_in_all(warnings_, "degenerate triangles");
    for (int root : scene.roots) triangles += triangles_below(scene, root);
    EXPECT_EQ(triangles, model.triangles);
    EXPECT_EQ(scene.materials.size(), model.materials);
    EXPECT_EQ(scene.images.size(), model.images);
    EXPECT_EQ(scene.cameras.size(), model.cameras);
    EXPECT_EQ(scene.lights.size(), model.lights);
    for (const ImageFile& image : scene.images)
        EXPECT_TRUE(!image.bytes.empty() || std::filesystem::exists(image.path)) << image.path;
}

INSTANTIATE_TEST_SUITE_P(
    Khronos, SharedGltf,
    ::testing::Values(
        Model{"AlphaBlendModeTest/AlphaBlendModeTest.glb", 61, 6, 4, 0, 0},
        Model{"AnimatedMorphCube/AnimatedMorphCube.glb", 12, 1, 0, 0, 0},
        Model{"AnisotropyBarnLamp/glTF-KTX2-Basisu/AnisotropyBarnLamp.gltf", 10203, 3, 4, 0, 0},
        Model{"AnisotropyStrengthTest/AnisotropyStrengthTest.glb", 97240, 50, 1, 0, 0},
        Model{"AttenuationTest/AttenuationTest.glb", 292, 18, 2, 0, 0},
        Model{"BoxAnimated/BoxAnimated.glb", 254, 2, 0, 0, 0},
        Model{"BoxInterleaved/BoxInterleaved.gltf", 12, 1, 0, 0, 0},
        Model{"BoxTexturedNonPowerOfTwo/glTF-Embedded/BoxTexturedNonPowerOfTwo.gltf", 12, 1, 1, 0, 0},
        Model{"Cameras/Cameras.gltf", 2, 1, 0, 2, 0},
        Model{"ClearCoatCarPaint/ClearCoatCarPaint.glb", 3072, 1, 1, 0, 0},
        Model{"ClearCoatTest/ClearCoatTest.glb", 37116, 19, 6, 0, 0},
        Model{"DamagedHelmet/DamagedHelmet.glb", 15452, 1, 4, 0, 0},
        Model{"Duck/glTF-Embedded/Duck.gltf", 4212, 1, 1, 1, 0},
        Model{"Duck/glTF-Quantized/Duck.gltf", 4212, 1, 1, 1, 0},
        Model{"EmissiveStrengthTest/EmissiveStrengthTest.glb", 90, 6, 1, 0, 0}, Model{"Fox/Fox.glb", 576, 1, 1, 0, 0},
        Model{"InterpolationTest/InterpolationTest.glb", 110, 10, 1, 0, 0},
        Model{"IridescenceSuzanne/IridescenceSuzanne.glb", 11808, 3, 1, 0, 1},
        Model{"LightsPunctualLamp/LightsPunctualLamp.gltf", 6000, 3, 7, 0, 5},
        Model{"MeshPrimitiveModes/MeshPrimitiveModes.gltf", 16, 1, 0, 0, 0},
        Model{"MetalRoughSpheresNoTextures/MetalRoughSpheresNoTextures.glb", 1040409, 99, 0, 0, 0},
        Model{"MorphPrimitivesTest/MorphPrimitivesTest.glb", 32, 2, 1, 0, 0},
        Model{"MorphStressTest/MorphStressTest.glb", 2412, 2, 2, 0, 0},
        Model{"MultiUVTest/MultiUVTest.glb", 12, 1, 2, 1, 0},
        Model{"MultipleScenes/MultipleScenes.gltf", 2, 1, 0, 0, 0},
        Model{"NegativeScaleTest/NegativeScaleTest.glb", 7724, 6, 2, 0, 0},
        Model{"OrientationTest/OrientationTest.glb", 524, 7, 0, 0, 0},
        Model{"RecursiveSkeletons/RecursiveSkeletons.glb", 6384, 1, 0, 0, 0},
        Model{"RiggedFigure/RiggedFigure.glb", 256, 1, 0, 0, 0}, Model{"SheenChair/SheenChair.gltf", 39936, 4, 5, 0, 0},
        Model{"SimpleInstancing/SimpleInstancing.glb", 1500, 1, 0, 0, 0},
        Model{"SimpleSkin/SimpleSkin.gltf", 8, 1, 0, 0, 0},
        Model{"SimpleSparseAccessor/SimpleSparseAccessor.gltf", 12, 1, 0, 0, 0},
        Model{"SpecularTest/SpecularTest.glb", 44828, 24, 4, 0, 0},
        Model{"TextureCoordinateTest/TextureCoordinateTest.glb", 10, 5, 1, 0, 0},
        Model{"TextureEncodingTest/TextureEncodingTest.glb", 3844, 14, 8, 0, 0},
        Model{"TextureLinearInterpolationTest/TextureLinearInterpolationTest.glb", 642, 3, 2, 0, 0},
        Model{"TextureSettingsTest/TextureSettingsTest.glb", 72, 10, 3, 0, 0},
        Model{"TextureTransformMultiTest/TextureTransformMultiTest.glb", 3956, 29, 4, 0, 0},
        Model{"TextureTransformTest/TextureTransformTest.gltf", 24, 9, 5, 0, 0},
        Model{"ToyCar/ToyCar.gltf", 108936, 3, 7, 8, 0},
        Model{"TransmissionRoughnessTest/TransmissionRoughnessTest.glb", 77792, 9, 5, 0, 0},
        Model{"TransmissionTest/TransmissionTest.glb", 128775, 14, 9, 1, 0},
        Model{"TriangleWithoutIndices/TriangleWithoutIndices.gltf", 1, 1, 0, 0, 0},
        Model{"TwoSidedPlane/TwoSidedPlane.gltf", 2, 1, 3, 0, 0}, Model{"UnlitTest/UnlitTest.glb", 88, 2, 0, 0, 0},
        Model{"VertexColorTest/VertexColorTest.glb", 36, 2, 2, 0, 0}));

class SharedFiles : public SharedGltf {};

TEST_F(SharedFiles, BoundsOfKnownModels)
{
    const auto bounds_of = [&](const char* file) {
        return world_bounds(load_scene(shared / "gltf" / file, {}, warnings_));
    };
    const Bounds helmet = bounds_of("DamagedHelmet/DamagedHelmet.glb");
    expect_near(helmet.min, {-0.947459, -0.900974, -1.18716}, 1e-5);
    expect_near(helmet.max, {0.942495, 0.900995, 0.812845}, 1e-5);
    // Both encodings of the duck model have equal bounds.
    const Bounds duck = bounds_of("Duck/glTF-Embedded/Duck.gltf"),
                 quantized = bounds_of("Duck/glTF-Quantized/Duck.gltf");
    expect_near(duck.min, quantized.min, 2e-4);
    expect_near(duck.max, quantized.max, 2e-4);
    expect_near(bounds_of("SimpleSparseAccessor/SimpleSparseAccessor.gltf").max, {6, 4, 0}, 0);
    expect_near(bounds_of("RiggedFigure/RiggedFigure.glb").max, {0.589461, 1.44992, 0.194977}, 1e-4);
}

/// Compressed models equal the original except for quantization.
TEST_F(SharedFiles, CompressedModels)
{
    const auto load = [&](const std::string& file) { return load_scene(shared / file, {}, warnings_); };
    const SceneDescription duck = load("gltf/Duck/glTF-Embedded/Duck.gltf"),
                           draco = load("gltf/Duck/glTF-Draco/Duck.gltf");
    ASSERT_EQ(draco.meshes.size(), 1u);
    EXPECT_NEAR(double(draco.meshes[0].indices.size()), double(duck.meshes[0].indices.size()), 30);
    expect_near(world_bounds(draco).min, world_bounds(duck).min, 1e-3);
    expect_near(world_bounds(draco).max, world_bounds(duck).max, 1e-3);
    for (const char* file : {"BoxDraco.gltf", "BoxMeshopt.gltf", "BoxMeshopt.glb"}) {
        const SceneDescription box = load(std::string("gltf-extras/gltf-transform/") + file);
        ASSERT_EQ(box.meshes.size(), 1u) << file;
        EXPECT_EQ(box.meshes[0].indices.size(), 36u) << file;
        EXPECT_EQ(box.meshes[0].normals.size(), box.meshes[0].positions.size()) << file;
        expect_near(world_bounds(box).min, {-0.5, -0.5, -0.5}, 1e-3);
        expect_near(world_bounds(box).max, {0.5, 0.5, 0.5}, 1e-3);
    }
    EXPECT_EQ(load("gltf-extras/gltf-transform/DracoSparseMesh.gltf").meshes.size(), 1u);
}

TEST_F(SharedFiles, Extras)
{
    const std::filesystem::path extras = shared / "gltf-extras";
    const SceneDescription trees =
        load_scene(extras / "blender-io/24_gpu_instancing/24_gpu_instancing.gltf", {}, warnings_);
    EXPECT_GT(trees.nodes.size(), 100u);
    EXPECT_EQ(trees.meshes.size(), 2u);
    const SceneDescription colored =
        load_scene(extras / "blender-io/22_vertex_color/22_vertex_color.gltf", {}, warnings_);
    EXPECT_TRUE(colored.materials.at(0).use_vertex_color);
    const SceneDescription gloss =
        load_scene(extras / "gltf-transform/BoxTextured_glTF-pbrSpecularGlossiness/BoxTextured.gltf", {}, warnings_);
    EXPECT_EQ(gloss.materials.at(0).metallic.value, 0);
    EXPECT_GE(gloss.materials.at(0).base_color.texture, 0);
}

/// Every file in a folder loads or is rejected with a one-line error, without crashing or taking long.
void load_all(const std::filesystem::path& folder, std::size_t least,
              const std::function<void(const std::filesystem::path&)>& check)
{
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        const auto extension = entry.path().extension();
        if (extension != ".gltf" && extension != ".glb") continue;
        SCOPED_TRACE(entry.path().string());
        const double start_s = test::processor_seconds();
        check(entry.path());
        EXPECT_LT(test::processor_seconds() - start_s, 5);
        ++files;
    }
    EXPECT_GE(files, least);
}

TEST_F(SharedFiles, MalformedFilesLoadOrAreRefused)
{
    if (!std::filesystem::exists(shared / "malformed")) GTEST_SKIP() << "no broken files at " << shared;
    const auto check = [&](const std::filesystem::path& path) { error_of(path); };
    load_all(shared / "malformed/gltf-validator", 300, check);
    load_all(shared / "malformed/assimp/glTF2", 10, check);
}

}  // namespace
}  // namespace fathom::test
