// SPDX-License-Identifier: Apache-2.0
#include "formats/import_test_helpers.h"
#include "gltf_builder.h"

namespace fathom::test {
namespace {

/// Tests of glTF material extensions that add layers.
class GltfLayers : public ImportTest {
protected:
    /// Material of a file that has texture 0 (my.png); json: members of the material.
    Material material(const std::string& json)
    {
        GltfBuilder b;
        const int positions = b.triangle();
        scene_ = load("a.gltf", b.gltf(fmt::format(R"("nodes": [{{"mesh": 0}}], "scenes": [{{"nodes": [0]}}],
            "meshes": [{{"primitives": [{{"material": 0, "attributes": {{"POSITION": {}}}}}]}}],
            "images": [{{"uri": "my.png"}}], "textures": [{{"source": 0}}], "materials": [{{{}}}])",
                                                   positions, json)));
        EXPECT_EQ(scene_.materials.size(), 1u);
        EXPECT_TRUE(warnings_.counts().empty());
        return scene_.materials.empty() ? Material{} : scene_.materials[0];
    }
    Material extended(const std::string& extension)
    {
        return material(R"("pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0.5, 0.25, 1, 1]},
                           "extensions": {)" +
                        extension + "}");
    }
    void expect(const FloatInput& input, float value, int channel, const char* what)
    {
        EXPECT_EQ(input.value, value) << what;
        EXPECT_EQ(input.channel, channel) << what;
        ASSERT_GE(input.texture, 0) << what;
        EXPECT_EQ(scene_.textures[std::size_t(input.texture)].color_space, ColorSpace::linear) << what;
    }
    void expect(const ColorInput& input, Color value, const char* what)
    {
        EXPECT_EQ(input.value, value) << what;
        ASSERT_GE(input.texture, 0) << what;
        EXPECT_EQ(scene_.textures[std::size_t(input.texture)].color_space, ColorSpace::srgb) << what;
    }

    SceneDescription scene_;
};

TEST_F(GltfLayers, NoneByDefault)
{
    const Material m = material("");
    EXPECT_EQ(m.kind, MaterialKind::principled);
    EXPECT_EQ(m.coat.weight.value, 0);
    EXPECT_EQ(m.sheen.color.value, (Color{0, 0, 0}));
    EXPECT_EQ(m.transmission.weight.value, 0);
    EXPECT_EQ(m.diffuse_transmission.weight.value, 0);
    EXPECT_EQ(m.thin_film.weight.value, 0);
    EXPECT_EQ(m.microfacets.anisotropy.value, 0);
    EXPECT_EQ(m.specular.weight.value, 1);
    EXPECT_EQ(m.ior, 1.5f);
    EXPECT_TRUE(m.sheen.reciprocal);
}
TEST_F(GltfLayers, Clearcoat)
{
    const Material m =
        extended(R"("KHR_materials_clearcoat": {"clearcoatFactor": 0.75, "clearcoatTexture": {"index": 0},
        "clearcoatRoughnessFactor": 0.125, "clearcoatRoughnessTexture": {"index": 0},
        "clearcoatNormalTexture": {"index": 0, "scale": 2}})");
    expect(m.coat.weight, 0.75f, 0, "coat");
    expect(m.coat.roughness, 0.125f, 1, "roughness");
    ASSERT_GE(m.coat.normal_texture, 0);
    EXPECT_EQ(scene_.textures[std::size_t(m.coat.normal_texture)].color_space, ColorSpace::linear);
    EXPECT_EQ(m.coat.normal_scale, 2);
    EXPECT_EQ(m.normal_map.texture, -1);
    EXPECT_EQ(m.coat.darkening, 0);
    EXPECT_EQ(m.coat.ior, 1.5f);
}
TEST_F(GltfLayers, Sheen)
{
    const Material m = extended(R"("KHR_materials_sheen": {"sheenColorFactor": [0.5, 0.25, 0.125],
        "sheenColorTexture": {"index": 0}, "sheenRoughnessFactor": 0.375, "sheenRoughnessTexture": {"index": 0}})");
    expect(m.sheen.color, {0.5f, 0.25f, 0.125f}, "color");
    expect(m.sheen.roughness, 0.375f, 3, "roughness");
}
TEST_F(GltfLayers, Specular)
{
    const Material m = extended(R"("KHR_materials_specular": {"specularFactor": 0.5, "specularTexture": {"index": 0},
        "specularColorFactor": [1.5, 0.25, 0.125], "specularColorTexture": {"index": 0}}, "KHR_materials_ior": {"ior": 1.75})");
    expect(m.specular.weight, 0.5f, 3, "strength");
    expect(m.specular.color, {1.5f, 0.25f, 0.125f}, "color");
    EXPECT_EQ(m.ior, 1.75f);
}
TEST_F(GltfLayers, IorOfZeroReflectsAllThatItMay)
{
    const Material m = extended(
        R"("KHR_materials_ior": {"ior": 0}, "KHR_materials_specular": {"specularColorFactor": [0.2, 0.3, 0.4]})");
    const float root = (m.ior - 1) / (m.ior + 1);
    EXPECT_NEAR(root * root, 1, 1e-3);
    EXPECT_EQ(m.specular.color.value, (Color{0.2f, 0.3f, 0.4f}));
}
TEST_F(GltfLayers, TransmissionOfASheet)
{
    const Material m =
        extended(R"("KHR_materials_transmission": {"transmissionFactor": 0.375, "transmissionTexture": {"index": 0}})");
    EXPECT_EQ(m.kind, MaterialKind::principled);
    expect(m.transmission.weight, 0.375f, 0, "transmission");
    EXPECT_EQ(m.transmission.color.value, (Color{0.5f, 0.25f, 1}));
    EXPECT_TRUE(m.interior.thin);
}
TEST_F(GltfLayers, TransmissionOfASolid)
{
    const Material m = extended(R"("KHR_materials_transmission": {"transmissionFactor": 1},
        "KHR_materials_volume": {"thicknessFactor": 1, "attenuationColor": [0.5, 1, 0.25], "attenuationDistance": 2},
        "KHR_materials_dispersion": {"dispersion": 0.5})");
    EXPECT_FALSE(m.interior.thin);
    EXPECT_EQ(m.interior.attenuation_color, (Color{0.5f, 1, 0.25f}));
    EXPECT_EQ(m.interior.attenuation_distance, 2);
    EXPECT_EQ(m.transmission.dispersion, 0.5f);
}
TEST_F(GltfLayers, ScatterWithinAVolume)
{
    const char* json = R"("KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 1},
        "KHR_materials_volume": {"thicknessFactor": 1, "attenuationColor": [0.5, 1, 0.25], "attenuationDistance": 2},
        "KHR_materials_volume_scatter": {"multiscatterColor": [0, 1, 0.6], "scatterAnisotropy": 0.25})";
    const Material m = extended(json);
    EXPECT_EQ(m.interior.attenuation_distance, 2);
    EXPECT_EQ(m.interior.scatter_anisotropy, 0.25f);
    EXPECT_EQ(m.interior.scatter.r, 0);
    EXPECT_EQ(m.interior.scatter.g, 0);
    // KHR_materials_volume_scatter: 1 - (4.09712 + 4.20863 m - sqrt(9.59217 + 41.6808 m + 17.7126 m^2))^2 times ln 4.
    EXPECT_NEAR(m.interior.scatter.b, 0.951179 * std::log(4.0), 1e-4);
}
TEST_F(GltfLayers, DiffuseTransmission)
{
    const Material m = extended(R"("KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.25,
        "diffuseTransmissionTexture": {"index": 0}, "diffuseTransmissionColorFactor": [0.5, 0.75, 0.125],
        "diffuseTransmissionColorTexture": {"index": 0}})");
    expect(m.diffuse_transmission.weight, 0.25f, 3, "share");
    expect(m.diffuse_transmission.color, {0.5f, 0.75f, 0.125f}, "color");
    EXPECT_EQ(m.transmission.weight.value, 0);
}
TEST_F(GltfLayers, Iridescence)
{
    Material m = extended(R"("KHR_materials_iridescence": {"iridescenceFactor": 0.5, "iridescenceTexture": {"index": 0},
        "iridescenceIor": 1.75, "iridescenceThicknessMinimum": 200, "iridescenceThicknessMaximum": 500,
        "iridescenceThicknessTexture": {"index": 0}})");
    expect(m.thin_film.weight, 0.5f, 0, "film");
    EXPECT_EQ(m.thin_film.ior, 1.75f);
    EXPECT_EQ(m.thin_film.thickness.value, 1);
    ASSERT_GE(m.thin_film.thickness.texture, 0);
    const Texture& range = scene_.textures[std::size_t(m.thin_film.thickness.texture)];
    EXPECT_EQ(range.kind, TextureKind::mix);
    EXPECT_EQ(range.color_a.value.g, 200);
    EXPECT_EQ(range.color_b.value.g, 500);
    expect(range.factor, 1, 1, "thickness");
    // The maximum thickness is used if there is no texture.
    m = extended(R"("KHR_materials_iridescence": {"iridescenceFactor": 1})");
    EXPECT_EQ(m.thin_film.thickness.value, 400);
    EXPECT_EQ(m.thin_film.thickness.texture, -1);
    EXPECT_EQ(m.thin_film.ior, 1.3f);
}
TEST_F(GltfLayers, Anisotropy)
{
    const Material m = extended(R"("KHR_materials_anisotropy": {"anisotropyStrength": 0.625, "anisotropyRotation": 0.5,
        "anisotropyTexture": {"index": 0}})");
    expect(m.microfacets.anisotropy, 0.625f, 2, "strength");
    EXPECT_EQ(m.microfacets.anisotropy_rotation, 0.5);
    EXPECT_EQ(m.microfacets.anisotropy_texture, m.microfacets.anisotropy.texture);
}
TEST_F(GltfLayers, SpecularGlossiness)
{
    Material m =
        material(R"("extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.5, 0.25, 0.125, 1],
        "diffuseTexture": {"index": 0}, "specularFactor": [0.3, 0.2, 0.1], "glossinessFactor": 0.75,
        "specularGlossinessTexture": {"index": 0}}})");
    EXPECT_EQ(m.metallic.value, 0);
    expect(m.base_color, {0.5f, 0.25f, 0.125f}, "diffuse");
    expect(m.specular.color, {0.3f, 0.2f, 0.1f}, "specular");
    EXPECT_GT(m.ior, 1000);
    ASSERT_GE(m.roughness.texture, 0);
    const Texture& rough = scene_.textures[std::size_t(m.roughness.texture)];
    // Roughness is 1 where the texture's alpha is 0, and 1 - factor where it is 1.
    EXPECT_EQ(m.roughness.value, 1);
    EXPECT_EQ(rough.color_a.value.g, 1);
    EXPECT_EQ(rough.color_b.value.g, 0.25f);
    EXPECT_EQ(rough.factor.channel, 3);
    m = material(R"("extensions": {"KHR_materials_pbrSpecularGlossiness": {"glossinessFactor": 0.75}})");
    EXPECT_EQ(m.roughness.value, 0.25f);
    EXPECT_EQ(m.roughness.texture, -1);
}
TEST_F(GltfLayers, NumbersOfTheWrongKind)
{
    GltfBuilder b;
    const int positions = b.triangle();
    EXPECT_THROW(load("a.gltf", b.gltf(fmt::format(R"("nodes": [{{"mesh": 0}}], "scenes": [{{"nodes": [0]}}],
            "meshes": [{{"primitives": [{{"material": 0, "attributes": {{"POSITION": {}}}}}]}}],
            "materials": [{{"extensions": {{"KHR_materials_sheen": {{"sheenColorFactor": [1, 2]}}}}}}])",
                                                   positions))),
                 Error);
}

}  // namespace
}  // namespace fathom::test
