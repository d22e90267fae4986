// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

/// Adds a material with a bump map of slope `value` in red or green of the texture coordinates.
int bumped(SceneBuilder& b, TextureMapping mapping, int channel, float value)
{
    Texture place;
    place.kind = TextureKind::coordinates;
    place.mapping = mapping;
    b.scene.textures.push_back(place);
    Material m;
    m.bump = {value, int(b.scene.textures.size()) - 1, channel};
    return b.material(m);
}

void expect_near(Vec3d a, Vec3d b, const std::string& what)
{
    EXPECT_LT(length(a - b), 2e-3) << what << ": " << a.x << " " << a.y << " " << a.z << ", not " << b.x << " " << b.y
                                   << " " << b.z;
}

/// Normal of a surface with normal n displaced by a height of gradient g.
Vec3d displaced_normal(Vec3d n, Vec3d g)
{
    return normalize(n - (g - n * dot(g, n)));
}

struct Case {
    const char* name;
    decltype(Shape::geometry) shape;
    Vec3d at, normal;
    Vec3d along_u, along_v;  ///< gradients of the texture coordinates
};

/// Shapes with the frame at the point that the camera sees from outside.
std::vector<Case> cases()
{
    const double r = 0.5, turn = 2 * std::numbers::pi * r;
    const Vec3d out = normalize(Vec3d{0.3, 0.4, 0.8});
    const double from_axis = std::hypot(out.x, out.z);
    const Vec3d east = normalize(Vec3d{out.z, 0, -out.x}), south = cross(east, out);
    return {{"rectangle",
             Rectangle{{-1, -1, 0}, {2, 0, 0}, {0, 4, 0}},
             {0.1, 0.2, 0},
             {0, 0, 1},
             {0.5, 0, 0},
             {0, -0.25, 0}},
            {"box", Box{{-1, -1, -1}, {1, 1, 0}}, {0.1, 0.2, 0}, {0, 0, 1}, {0.5, 0, 0}, {0, -0.5, 0}},
            {"disk", Disk{{0, 0, 0}, {0, 0, 1}, 2}, {0.1, 0.2, 0}, {0, 0, 1}, {0.25, 0, 0}, {0, -0.25, 0}},
            {"mesh", MeshInstance{0}, {0.1, 0.2, 0}, {0, 0, 1}, {0.25, 0.5, 0}, {-1, 0.125, 0}},
            {"sphere", Sphere{{0, 0, 0}, r, {}}, out * r, out, east * (1 / (turn * from_axis)), south * (2 / turn)}};
}

/// A square, with enough triangles that two copies become instances, where (u, v) = (x / 4 + y / 2, y / 8 - x).
Mesh sheet()
{
    constexpr std::uint32_t n = 48;
    Mesh mesh;
    for (std::uint32_t i = 0; i <= n; ++i)
        for (std::uint32_t j = 0; j <= n; ++j) {
            const float x = 2.0f * float(i) / n - 1, y = 2.0f * float(j) / n - 1;
            mesh.positions.push_back({x, y, 0});
            mesh.uvs[0].push_back({x / 4 + y / 2, y / 8 - x});
        }
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t c = i * (n + 1) + j, d = c + n + 1;
            mesh.indices.insert(mesh.indices.end(), {c, d, c + 1, c + 1, d, d + 1});
        }
    return mesh;
}

SceneDescription scene_of(SceneBuilder& b, const Case& c, const Transform& transform, int material)
{
    b.scene.meshes.push_back(sheet());
    for (int i = 0; i < 2; ++i) {
        Node node;
        node.parent_from_node = Transform::translate({0, 0, -100.0 * i}) * transform;
        node.shapes.push_back({c.shape, material, ""});
        b.scene.roots.push_back(int(b.scene.nodes.size()));
        b.scene.nodes.push_back(node);
    }
    const Vec3d at = transform.point(c.at);
    b.camera(at + normalize(transform.vector(c.normal)), at, 0.05);
    return b.scene;
}

/// Bump heights are in world units regardless of the node's scale; slopes follow the gradients of the texture
/// coordinates.
TEST(Bump, BendsNormalsByTheSlope)
{
    for (const double size : {1.0, 3.0}) {
        const Transform transform =
            Transform::translate({5, -3, 2}) * Transform::rotate({1, 2, 3}, 0.8) * Transform::scale({size, size, size});
        for (const Case& c : cases())
            for (int channel = 0; channel < 2; ++channel) {
                SceneBuilder b;
                const int material = bumped(b, TextureMapping::uv, channel, 0.75f);
                const Vec3d gradient = transform.vector(channel == 0 ? c.along_u : c.along_v) * (0.75 / (size * size)),
                            normal = normalize(transform.vector(c.normal));
                expect_near(normalize(shown_normal(scene_of(b, c, transform, material), 16)),
                            displaced_normal(normal, gradient), std::string(c.name) + " " + std::to_string(channel));
            }
    }
}

/// Textures that are mapped by position bump surfaces without texture coordinates.
TEST(Bump, SpaceTexturesBump)
{
    const Transform transform = Transform::translate({1, -3, 2}) * Transform::rotate({1, 2, 3}, 0.8);
    for (const Case& c : cases())
        for (const float value : {0.5f, -0.25f}) {
            SceneBuilder b;
            const int material = bumped(b, TextureMapping::planar, 0, value);
            expect_near(normalize(shown_normal(scene_of(b, c, transform, material), 16)),
                        displaced_normal(normalize(transform.vector(c.normal)), {double(value), 0, 0}), c.name);
        }
}

}  // namespace
}  // namespace fathom
