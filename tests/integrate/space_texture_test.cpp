// SPDX-License-Identifier: Apache-2.0
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

/// Texture coordinates of a plane that is fixed in world space, for any transform of the shape.
TEST(SpaceTextures, FollowTheirTransform)
{
    const Transform world_from_texture =
        Transform::translate({1, 2, 3}) * Transform::rotate({1, 2, 3}, 0.8) * Transform::scale({2, 3, 4});
    for (const double shift : {0.0, 0.25}) {
        SceneBuilder b;
        Texture place;
        place.kind = TextureKind::coordinates;
        place.mapping = TextureMapping::planar;
        place.world_from_texture = world_from_texture;
        b.scene.textures.push_back(place);
        Material m;
        m.kind = MaterialKind::unlit;
        m.base_color = {{1, 1, 1}, 0};
        Node node;
        node.parent_from_node = Transform::translate({shift, shift, 0});
        node.shapes.push_back({Rectangle{{9, 9, 0}, {2, 0, 0}, {0, 2, 0}}, b.material(m), ""});
        b.scene.roots.push_back(int(b.scene.nodes.size()));
        b.scene.nodes.push_back(node);
        b.camera({10.5, 10.25, 1}, {10.5, 10.25, 0}, 0.05);
        const Mean mean = mean_of(render_film(b.scene, small_image_settings(1, 1), 4));
        const Vec3d p = world_from_texture.inverse().point({10.5, 10.25, 0});
        EXPECT_NEAR(mean.value[0], std::abs(p.x), 1e-3);
        EXPECT_NEAR(mean.value[1], std::abs(p.y), 1e-3);
        EXPECT_GT(std::min(p.x, p.y), 0);
    }
}

/// The texture is the cosine of the geometric normal with a world-space direction, for rotated and mirrored shapes and
/// those seen from behind.
TEST(SpaceTextures, FacingIsOfTheWorld)
{
    const Vec3d direction = normalize(Vec3d{0.3, -0.7, 0.5});
    for (const Transform& transform : {Transform::rotate({3, 1, 2}, 0.7), Transform::scale({-2, 1, 1})})
        for (const bool behind : {false, true}) {
            SceneBuilder b;
            Texture facing;
            facing.kind = TextureKind::facing;
            facing.direction = direction * 3;
            b.scene.textures.push_back(facing);
            Material m;
            m.kind = MaterialKind::unlit;
            m.base_color = {{1, 1, 1}, 0};
            const int material = b.material(m);
            Node node;
            node.parent_from_node = transform;
            node.shapes.push_back({Rectangle{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}, material, ""});
            b.scene.roots.push_back(int(b.scene.nodes.size()));
            b.scene.nodes.push_back(node);
            const Vec3d normal = normalize(transform.vector({0, 0, 1}));
            b.camera(normal * (behind ? -2.0 : 2.0), {0, 0, 0}, 0.05);
            EXPECT_NEAR(mean_of(render_film(b.scene, small_image_settings(1, 1), 4)).value[0],
                        std::abs(dot(normal, direction)), 1e-4);
        }
}

}  // namespace
}  // namespace fathom
