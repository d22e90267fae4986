// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

/// A sphere of 4,800 triangles, with or without vertex normals.
Mesh ball(bool normals)
{
    Mesh mesh;
    constexpr std::uint32_t around = 60, down = 40;
    for (std::uint32_t j = 0; j <= down; ++j)
        for (std::uint32_t i = 0; i <= around; ++i) {
            const double phi = 2 * std::numbers::pi * i / around, theta = std::numbers::pi * j / down;
            const Vec3f p{float(std::sin(theta) * std::cos(phi)), float(std::cos(theta)),
                          float(std::sin(theta) * std::sin(phi))};
            mesh.positions.push_back(p);
            if (normals) mesh.normals.push_back(p);
        }
    for (std::uint32_t j = 0; j < down; ++j)
        for (std::uint32_t i = 0; i < around; ++i) {
            const std::uint32_t a = j * (around + 1) + i, b = a + around + 1;
            for (std::uint32_t v : {a, a + 1, b, a + 1, b + 1, b}) mesh.indices.push_back(v);
        }
    return mesh;
}

/// Instances render like transformed copies: stretched and mirrored, nested three deep, with colored glass, which needs
/// inside and outside, and directional light.
TEST(InstanceImages, is_that_of_the_mesh_itself)
{
    for (bool normals : {false, true})
        for (bool glass : {false, true}) {
            Mean means[2];
            for (bool instances : {false, true}) {
                SceneBuilder s;
                s.scene.environment.kind = EnvironmentKind::gradient;
                s.scene.environment.bottom = {0.1f, 0.2f, 0.3f};
                Material m;
                m.base_color.value = {0.8f, 0.6f, 0.4f};
                if (glass) {
                    m.kind = MaterialKind::glass;
                    m.base_color.value = {1, 1, 1};
                    m.interior.attenuation_color = {0.2f, 0.6f, 0.9f};
                    m.interior.attenuation_distance = 1;
                }
                const int material = s.material(m);
                Light sun;
                sun.kind = LightKind::directional;
                s.light(sun, Transform::rotate({1, 2, 0}, 1));
                // The outer node has two placements, the middle one is mirrored and stretched, and the inner one has
                // the shape.
                for (int outer = 0; outer < 2; ++outer)
                    for (int middle = 0; middle < 2; ++middle) {
                        if (!instances || s.scene.meshes.empty()) s.scene.meshes.push_back(ball(normals));
                        const int node = int(s.scene.nodes.size());
                        Node a, b, c;
                        a.parent_from_node =
                            Transform::translate({outer ? 1.3 : -1.3, 0, 0}) * Transform::rotate({1, 1, 0}, outer);
                        a.children = {node + 1};
                        b.parent_from_node = Transform::translate({0, middle ? 1.1 : -1.1, 0}) *
                                             Transform::scale({middle ? -1. : 1., 0.7, outer ? 0.5 : 1.});
                        b.children = {node + 2};
                        c.parent_from_node = Transform::rotate({0, 0, 1}, 0.5) * Transform::scale({0.5, 0.8, 0.8});
                        c.shapes.push_back({MeshInstance{int(s.scene.meshes.size()) - 1}, material, ""});
                        s.scene.roots.push_back(node);
                        s.scene.nodes.insert(s.scene.nodes.end(), {a, b, c});
                    }
                s.camera({0, 1, 7}, {0, 0, 0});
                Warnings warnings;
                const Scene scene = Scene::compile(s.scene, "", warnings);
                EXPECT_EQ(scene.statistics().instances, instances ? 4u : 0u);
                means[instances] = mean_of(render_film(s.scene, small_image_settings(), 64));
            }
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(means[0].value[c], means[1].value[c], 2e-3 * means[0].value[c]) << normals << glass << c;
        }
}

}  // namespace
}  // namespace fathom
