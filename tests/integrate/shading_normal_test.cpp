// SPDX-License-Identifier: Apache-2.0
/// Tests of shading normals that differ from geometric normals: mirrors and glass still conserve energy.
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

/// A unit sphere of about `count` triangles with smooth shading normals.
Mesh smooth_ball(int count)
{
    Mesh mesh;
    const int rings = int(std::sqrt(count / 4.0)) + 1, around = 2 * rings;
    for (int j = 0; j <= rings; ++j)
        for (int i = 0; i <= around; ++i) {
            const double theta = std::numbers::pi * j / rings, phi = 2 * std::numbers::pi * i / around;
            const Vec3d n{std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi)};
            mesh.positions.push_back(rounded(n));
            mesh.normals.push_back(rounded(n));
        }
    for (int j = 0; j < rings; ++j)
        for (int i = 0; i < around; ++i) {
            const auto a = std::uint32_t(j * (around + 1) + i), b = a + 1, c = a + std::uint32_t(around) + 1, d = c + 1;
            if (j > 0) mesh.indices.insert(mesh.indices.end(), {a, c, b});
            if (j + 1 < rings) mesh.indices.insert(mesh.indices.end(), {b, c, d});
        }
    return mesh;
}

struct Extremes {
    double least = 1e9, most = 0, mean = 0;
};
Extremes extremes_of(const Film& film)
{
    Extremes e;
    const Image image = film.image(false, false);
    const auto& pixels = image.layers[0].pixels;
    for (float v : pixels) {
        e.least = std::min(e.least, double(v)), e.most = std::max(e.most, double(v));
        e.mean += double(v) / double(pixels.size());
    }
    return e;
}

/// Lossless objects are white under a white sky, up to their silhouette.
TEST(ShadingNormal, SmoothBallsOfFewTrianglesHaveNoBlackRim)
{
    for (const MaterialKind kind : {MaterialKind::metal, MaterialKind::glass})
        for (const int count : {60, 200, 1000}) {
            SceneBuilder b;
            Material m;
            m.kind = kind;
            m.base_color.value = {1, 1, 1};
            b.scene.meshes.push_back(smooth_ball(count));
            b.add(MeshInstance{0}, b.material(m));
            b.scene.environment = uniform_sky();
            b.camera({0.5, 1, 4}, {0, 0, 0}, 32);
            const Extremes e = extremes_of(render_film(b.scene, small_image_settings(64, 64), 64));
            SCOPED_TRACE(std::to_string(int(kind)) + " " + std::to_string(count));
            // In glass some light is totally reflected until the depth limit.
            const bool mirror = kind == MaterialKind::metal;
            EXPECT_GT(e.least, mirror ? 0.999 : count < 200 ? 0.2 : 0.7);
            EXPECT_LT(e.most, 1.1);
            EXPECT_NEAR(e.mean, 1, mirror ? 1e-4 : count < 200 ? 6e-3 : 2e-3);
        }
}

/// A white material whose normal map alternates between two colors.
Material with_waves(SceneBuilder& b, TextureKind pattern, float scale, Color low, Color high)
{
    Texture waves;
    waves.kind = pattern;
    waves.scale = scale;
    waves.color_a.value = low;
    waves.color_b.value = high;
    b.scene.textures.push_back(waves);
    Material m;
    m.base_color.value = {1, 1, 1};
    m.normal_map.texture = int(b.scene.textures.size()) - 1;
    return m;
}

/// A mirror, a rough metal and glass with steep waves that turn normals by up to 60 degrees.
TEST(ShadingNormal, StrongNormalMapsLeaveNoHoles)
{
    struct Case {
        MaterialKind kind;
        float roughness;
        double least, mean;
    };
    // Samples of rough lobes below the geometric surface are lost.
    for (const Case& c : {Case{MaterialKind::metal, 0, 0.999, 1e-4}, Case{MaterialKind::metal, 0.4f, 0.4, 0.42},
                          Case{MaterialKind::principled, 0.3f, 0.4, 0.42},
                          Case{MaterialKind::fuzz_metal, 0, 0.999, 1e-4}, Case{MaterialKind::glass, 0, 0.9, 0.01}}) {
        SceneBuilder b;
        Material m = with_waves(b, TextureKind::checker_uv, 40, {0.93f, 0.5f, 0.75f}, {0.2f, 0.15f, 0.75f});
        m.kind = c.kind;
        m.roughness.value = c.roughness;
        m.metallic.value = 1;
        m.fuzz = 0;
        b.add(Box{{-20, -0.5, -20}, {20, 0, 20}}, b.material(m));
        b.scene.environment = uniform_sky();
        for (const double height : {0.3, 1.0, 4.0}) {
            SceneBuilder seen = b;
            seen.camera({0, height, 2}, {0, 0, 0}, 20);
            const Extremes e = extremes_of(render_film(seen.scene, small_image_settings(), 64));
            SCOPED_TRACE(std::to_string(int(c.kind)) + " " + std::to_string(height));
            EXPECT_GT(e.least, c.least);
            EXPECT_NEAR(e.mean, 1, c.mean);
        }
    }
}

/// Shading normals let no light through closed walls.
TEST(ShadingNormal, ClosedRoomsAreDark)
{
    for (const MaterialKind kind : {MaterialKind::metal, MaterialKind::principled}) {
        SceneBuilder b;
        Material m = with_waves(b, TextureKind::noise, 7, {0, 0, 0.5f}, {1, 1, 0.6f});
        m.kind = kind;
        b.add(Box{{-1, -1, -1}, {1, 1, 1}}, b.material(m));
        b.scene.environment = uniform_sky();
        b.camera({0.1, 0.2, 0.3}, {0.9, 0.8, -0.7}, 100);
        EXPECT_EQ(mean_of(render_film(b.scene, small_image_settings(), 64)).value[0], 0);
    }
}

}  // namespace
}  // namespace fathom
