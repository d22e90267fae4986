// SPDX-License-Identifier: Apache-2.0
/// Tests of opacity, textures, absorption and the camera, against closed forms.
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

TEST(Alpha, OfEveryShape)
{
    const std::vector<decltype(Shape::geometry)> shapes = {Sphere{{0, 0, -5}, 2, {}}, Disk{{0, 0, -5}, {0, 0, 1}, 2},
                                                           Rectangle{{-2, -2, -5}, {4, 0, 0}, {0, 4, 0}},
                                                           Box{{-2, -2, -6}, {2, 2, -5}}};
    for (const auto& shape : shapes) {
        SceneBuilder b;
        Material m;
        m.kind = MaterialKind::none;
        m.emission.radiance.value = {1, 1, 1};
        m.opacity.mode = AlphaMode::blend;
        m.opacity.alpha.value = 0.25f;
        b.scene.nodes[0].shapes.push_back({shape, b.material(m), ""});
        b.camera({0, 0, 0}, {0, 0, -1}, 10);
        expect_mean(render_film(b.scene, small_image_settings(), 256), 0.25, 0.01);
    }
}

/// Each layer decides independently whether it stops a ray: n layers transmit (1 - alpha)^n, as separate shapes or as
/// instances of one mesh, also directly behind each other.
TEST(Alpha, OfAStackOfLayers)
{
    constexpr std::uint32_t n = 48;
    Mesh grid;  // the mesh is large enough that copies become instances
    for (std::uint32_t i = 0; i <= n; ++i)
        for (std::uint32_t j = 0; j <= n; ++j)
            grid.positions.push_back({4 * float(i) / n - 2, 4 * float(j) / n - 2, 0});
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
            grid.indices.insert(grid.indices.end(), {a, b, a + 1, a + 1, b, b + 1});
        }
    for (const bool copies : {false, true})
        for (const double distance : {0.5, 0.0})
            for (const float alpha : {0.2f, 0.5f}) {
                SceneBuilder b;
                Material m;
                m.kind = MaterialKind::none;
                m.opacity.mode = AlphaMode::blend;
                m.opacity.alpha.value = alpha;
                const int layer = b.material(m);
                b.scene.meshes.push_back(grid);
                for (int i = 0; i < 4; ++i) {
                    Node node;
                    node.parent_from_node = Transform::translate({0, 0, -5 - distance * i});
                    if (copies)
                        node.shapes.push_back({MeshInstance{0}, layer, ""});
                    else
                        node.shapes.push_back({Rectangle{{-2, -2, 0}, {4, 0, 0}, {0, 4, 0}}, layer, ""});
                    b.scene.roots.push_back(int(b.scene.nodes.size()));
                    b.scene.nodes.push_back(node);
                }
                b.scene.environment = uniform_sky();
                b.camera({0, 0, 0}, {0, 0, -1}, 10);
                b.scene.cameras[0].kind = CameraKind::orthographic;
                SCOPED_TRACE(std::to_string(copies) + " " + std::to_string(distance));
                expect_mean(render_film(b.scene, small_image_settings(), 64), std::pow(1 - alpha, 4), 0);
            }
}

/// The alpha and color of a texture match: black in front of white and white in front of black add up to white.
TEST(Alpha, OfEveryTexture)
{
    for (const TextureKind kind : {TextureKind::checker_uv, TextureKind::checker_space, TextureKind::noise,
                                   TextureKind::turbulence, TextureKind::marble}) {
        Texture texture;
        texture.kind = kind;
        texture.scale = 3;
        texture.color_a.value = {0.25f, 0, 0};
        double sum = 0, error2 = 0;
        for (const bool as_alpha : {false, true}) {
            SceneBuilder b;
            b.scene.textures.push_back(texture);
            Material m;
            m.kind = MaterialKind::none;
            if (as_alpha) {
                m.opacity.mode = AlphaMode::blend;
                m.opacity.alpha = {1, 0, 0};
                b.scene.environment = uniform_sky();
            } else {
                m.emission.radiance = {{1, 1, 1}, 0};
            }
            b.add(Rectangle{{-2, -2, -5}, {4, 0, 0}, {0, 4, 0}}, b.material(m));
            b.camera({0, 0, 0}, {0, 0, -1}, 30);
            const Mean mean = mean_of(render_film(b.scene, small_image_settings(), 256));
            EXPECT_GT(mean.value[0], 0.1);
            EXPECT_LT(mean.value[0], 0.9);
            sum += mean.value[0], error2 += mean.error[0] * mean.error[0];
        }
        EXPECT_NEAR(sum, 1, 4 * std::sqrt(error2)) << int(kind);
    }
}

/// A disk keeps its texture mapping when a transform turns it into an ellipse.
TEST(Textures, OfADistortedDisk)
{
    const auto mean = [](const Transform& transform) {
        SceneBuilder b;
        Texture checker;
        checker.kind = TextureKind::checker_uv;
        checker.scale = 2;
        b.scene.textures.push_back(checker);
        Material m;
        m.kind = MaterialKind::none;
        m.emission.radiance = {{1, 1, 1}, 0};
        Node node;
        node.parent_from_node = transform;
        node.shapes.push_back({Disk{{0, 0, 0}, {0.2, -0.4, 1}, 1}, b.material(m), ""});
        b.scene.roots.push_back(1);
        b.scene.nodes.push_back(node);
        b.camera({0.3, 0.1, 3}, {0.3, 0.1, 0}, 10);
        return mean_of(render_film(b.scene, small_image_settings(), 64)).value[0];
    };
    // The transform makes an ellipse, but so close to a circle that the image is unchanged.
    const double expected = mean({});
    EXPECT_GT(expected, 0.1);
    EXPECT_LT(expected, 0.9);
    EXPECT_NEAR(mean(Transform::scale({1.0002, 1, 1})), expected, 0.01);
}

/// Textures rotate with their node: the image equals that of a camera rotated the other way and, for mirroring nodes,
/// its mirror image, because cameras are not mirrored.
TEST(Textures, TurnWithTheNode)
{
    const Transform turn = Transform::rotate({0.3, 1, 0.5}, 1.1) * Transform::rotate({1, 0, 0}, 0.4);
    const Transform mirror = Transform::scale({-1.5, 1.5, 1.5});
    Points points;
    points.centers = {{0, 0, 0}};
    points.radii = {1};
    const std::vector<decltype(Shape::geometry)> shapes = {Sphere{{0, 0, 0}, 1, {}}, Disk{{0, 0, 0}, {0.2, 0.3, 1}, 1},
                                                           PointsInstance{0}};
    for (const auto& shape : shapes)
        for (const bool mirrors : {false, true}) {
            const Transform transform = mirrors ? turn * mirror : turn;
            Image pictures[2];
            for (const bool turns_camera : {false, true}) {
                SceneBuilder b;
                b.scene.points.push_back(points);
                Texture checker;
                checker.kind = TextureKind::checker_uv;
                checker.uv_scale = {4, 4};
                checker.color_b.value = {1, 0.5f, 0.25f};
                b.scene.textures.push_back(checker);
                Material m;
                m.kind = MaterialKind::none;
                m.emission.radiance = {{1, 1, 1}, 0};
                m.emission.two_sided = true;
                Node node;
                if (!turns_camera) node.parent_from_node = transform;
                node.shapes.push_back({shape, b.material(m), ""});
                b.scene.roots.push_back(1);
                b.scene.nodes.push_back(node);
                b.camera({0.3, 0.2, 4}, {0, 0, 0}, 50);
                if (turns_camera) b.scene.nodes[0].parent_from_node = transform.inverse();
                pictures[turns_camera] = render_film(b.scene, small_image_settings(), 64).image(false, false);
            }
            double difference = 0;
            for (int y = 0; y < 24; ++y)
                for (int x = 0; x < 32; ++x) {
                    const auto at = [&](int picture, int column) {
                        return double(pictures[picture].layers[0].pixels[std::size_t(3 * (y * 32 + column) + 1)]);
                    };
                    difference += std::abs(at(0, x) - at(1, mirrors ? 31 - x : x)) / (32 * 24);
                }
            EXPECT_LT(difference, 0.02) << shape.index() << " " << mirrors;
        }
}

TEST(Glass, AbsorbsByPathLength)
{
    // A slab at normal incidence has two transmissions, absorption, and a geometric series of internal reflections.
    SceneBuilder b;
    Material glass;
    glass.kind = MaterialKind::glass;
    glass.interior.attenuation_color = {0.5f, 0.5f, 0.5f};
    glass.interior.attenuation_distance = 2;
    b.add(Box{{-50, -50, -1}, {50, 50, 0}}, b.material(glass));
    b.scene.environment = uniform_sky();
    b.camera({0, 0, 1}, {0, 0, 0}, 0.5);
    const double r = 0.04, a = std::sqrt(0.5);
    expect_mean(render_film(b.scene, small_image_settings(16, 16), 1024),
                r + (1 - r) * (1 - r) * (a + a * a * r) / (1 - r * r * a * a), 0.005);
}

TEST(Camera, DepthNormalAndPositionOfAPlane)
{
    SceneBuilder b;
    b.add(Rectangle{{-50, -50, -3}, {100, 0, 0}, {0, 100, 0}}, b.diffuse(0.25f));
    b.camera({1, 2, 4}, {1, 2, 0}, 30);
    RenderSettings settings = small_image_settings();
    settings.aovs = {Aov::albedo, Aov::normal, Aov::depth, Aov::position, Aov::material_id};
    const Image image = render_film(b.scene, settings, 4).image(false, false);
    for (std::size_t i = 0; i < 32 * 24; ++i) {
        EXPECT_NEAR(image.find("depth")->pixels[i], 7, 1e-3);
        EXPECT_NEAR(image.find("normal")->pixels[3 * i + 2], 1, 1e-6);
        EXPECT_NEAR(image.find("albedo")->pixels[3 * i], 0.25, 1e-6);
        EXPECT_NEAR(image.find("position")->pixels[3 * i + 2], -3, 1e-3);
        EXPECT_EQ(image.find("material")->pixels[i], 0);
    }
    // The image's center looks along the axis; x grows to the right, y upwards.
    const auto& p = image.find("position")->pixels;
    EXPECT_LT(p[3 * (12 * 32 + 2)], p[3 * (12 * 32 + 29)]);
    EXPECT_GT(p[3 * (2 * 32 + 16) + 1], p[3 * (21 * 32 + 16) + 1]);
}

}  // namespace
}  // namespace fathom
