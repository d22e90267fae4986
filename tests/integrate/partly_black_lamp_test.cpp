// SPDX-License-Identifier: Apache-2.0
#include "picture_helpers.h"

// Lamps whose emission texture is black on most triangles, which are not sampled.
namespace fathom {
namespace {

using namespace test;

/// A strip of 32 x 2 triangles, each square of which shows one texel of an image of 32 columns. Every eighth column is
/// lit, and most others are known to be black.
void add_strip(SceneBuilder& b, bool is_instanced)
{
    constexpr int columns = 32;
    std::string file = "PF\n32 1\n-1\n";
    for (int i = 0; i < columns; ++i) {
        const float texel[3] = {i % 8 ? 0.f : 1.f, i % 8 ? 0.f : 0.5f, 0};
        file.append(reinterpret_cast<const char*>(texel), sizeof texel);
    }
    ImageFile image;
    image.name = "strip.pfm";
    for (char c : file) image.bytes.push_back(std::byte(c));
    b.scene.images.push_back(image);
    Texture texture;
    texture.kind = TextureKind::image;
    texture.image = 0;
    texture.nearest = true;
    b.scene.textures.push_back(texture);
    Mesh mesh;
    mesh.movable = is_instanced;
    for (int i = 0; i < columns; ++i)
        for (int corner = 0; corner < 4; ++corner) {
            const float x = -1 + float(i + corner % 2) * 2 / columns;
            mesh.positions.push_back({x, 1, float(corner / 2) * -0.5f});
            mesh.uvs[0].push_back({(float(i) + 0.5f) / columns, 0.5f});
        }
    for (std::uint32_t i = 0; i < columns; ++i)
        for (std::uint32_t k : {0u, 2u, 1u, 1u, 2u, 3u}) mesh.indices.push_back(i * 4 + k);
    b.scene.meshes.push_back(mesh);
    const int lamp = b.diffuse(0, {3, 3, 3}, true);
    b.scene.materials[std::size_t(lamp)].emission.radiance.texture = 0;
    b.add(MeshInstance{int(b.scene.meshes.size()) - 1}, lamp);
}

/// Rays see the lit texels, and a floor receives the same light by all ways of sampling.
TEST(PartlyBlackLamp, LightsAsItsTextureSays)
{
    for (bool is_instanced : {false, true}) {
        SceneBuilder b;
        // Triangles before those of the lamp.
        Mesh other;
        other.positions = {{0, -2, 0}, {1, -2, 0}, {0, -2, 1}};
        for (int i = 0; i < 6; ++i) other.indices.insert(other.indices.end(), {0, 1, 2});
        b.scene.meshes.push_back(other);
        b.add(MeshInstance{0}, b.diffuse(0.5f));
        add_strip(b, is_instanced);
        b.add(Rectangle{{-50, 0, 50}, {100, 0, 0}, {0, 0, -100}}, b.diffuse(0.5f));
        SceneBuilder seen = b;
        seen.camera({0, 0.5, -0.25}, {0, 1, -0.25});
        Camera& camera = seen.scene.cameras[0];
        camera.kind = CameraKind::orthographic, camera.height = 0.25;
        RenderSettings settings = small_image_settings(2, 1);
        settings.max_depth = 0;
        const Mean direct = mean_of(render_film(seen.scene, settings, 4096));
        EXPECT_NEAR(direct.value[0], 0.375, 0.005);
        EXPECT_NEAR(direct.value[1], 0.1875, 0.003);
        EXPECT_EQ(direct.value[2], 0);

        b.camera({0, 3, 2}, {0, 0, 0}, 20);
        settings = small_image_settings(8, 8);
        settings.light_sampling = false;
        const Mean by_rays = mean_of(render_film(b.scene, settings, 4096));
        settings.light_sampling = true;
        for (const Mean& m : means_by_selection(b.scene, settings, 1024))
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(m.value[c], by_rays.value[c], 4 * std::hypot(m.error[c], by_rays.error[c])) << c;
        EXPECT_GT(by_rays.value[0], 10 * by_rays.error[0]);
    }
}

}  // namespace
}  // namespace fathom
