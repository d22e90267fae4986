// SPDX-License-Identifier: Apache-2.0
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

/// Slopes along tangent and bitangent that red and green of the map stand for.
constexpr double red = 0.4, green = 0.3;

int normal_map(SceneBuilder& b)
{
    const double blue = std::sqrt(1 - red * red - green * green);
    Texture texture;
    texture.kind = TextureKind::checker_uv;
    texture.color_a.value =
        texture.color_b.value = {float(0.5 + red / 2), float(0.5 + green / 2), float(0.5 + blue / 2)};
    b.scene.textures.push_back(texture);
    Material m;
    m.normal_map.texture = 0;
    return b.material(m);
}

void expect_near(Vec3d a, Vec3d b, const std::string& what)
{
    EXPECT_LT(length(a - b), 1e-4) << what << ": " << a.x << " " << a.y << " " << a.z << ", not " << b.x << " " << b.y
                                   << " " << b.z;
}

const Transform mirrors[] = {Transform(), Transform::scale({-1, 1, 1}), Transform::scale({1, -1, 1}),
                             Transform::scale({1, 1, -1}), Transform::scale({-2, -2, -2})};
const Transform turn = Transform::rotate({1, 2, 3}, 0.8);

struct Sheet {
    bool mirrored_u, mirrored_v, tangents, normals, turned_normals;
};

/// The square [-1, 1]^2 with its front towards +z, in 2 n^2 triangles.
Mesh sheet_mesh(const Sheet& sheet, std::uint32_t n)
{
    Mesh mesh;
    const double su = sheet.mirrored_u ? -1 : 1, sv = sheet.mirrored_v ? -1 : 1;
    const float nz = sheet.turned_normals ? -1.f : 1.f;
    for (std::uint32_t i = 0; i <= n; ++i)
        for (std::uint32_t j = 0; j <= n; ++j) {
            const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1;
            mesh.positions.push_back({float(x), float(y), 0});
            mesh.uvs[0].push_back({float(0.5 + su * x / 2), float(0.5 - sv * y / 2)});
            if (sheet.normals) mesh.normals.push_back({0, 0, nz});
            // The bitangent of glTF, cross(normal, tangent) * w, points up in the image, towards increasing sv * y.
            if (sheet.tangents) mesh.tangents.push_back({float(su), 0, 0, float(sv * su * nz)});
        }
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
            mesh.indices.insert(mesh.indices.end(), {a, b, a + 1, a + 1, b, b + 1});
        }
    return mesh;
}

/// Red bends the normal towards increasing u, green up in the image, even if the mesh or its texture coordinates are
/// mirrored.
TEST(NormalMap, BendsAlongTheAxesOfTheImage)
{
    for (const bool copies : {false, true})
        for (const Transform& mirror : mirrors)
            for (int bits = 0; bits < 32; ++bits) {
                const Sheet sheet{bool(bits & 1), bool(bits & 2), bool(bits & 4), bool(bits & 8), bool(bits & 16)};
                if ((sheet.turned_normals || sheet.tangents) && !sheet.normals) continue;
                SceneBuilder b;
                const int material = normal_map(b);
                b.scene.meshes.push_back(sheet_mesh(sheet, copies ? 48 : 1));
                const Transform transform = turn * mirror;
                for (int i = 0; i <= int(copies); ++i) {  // two copies with enough triangles become instances
                    Node node;
                    node.parent_from_node = Transform::translate({0, 0, -100.0 * i}) * transform;
                    node.shapes.push_back({MeshInstance{0}, material, ""});
                    b.scene.roots.push_back(int(b.scene.nodes.size()));
                    b.scene.nodes.push_back(node);
                }
                const Vec3d tangent = normalize(transform.vector({sheet.mirrored_u ? -1.0 : 1.0, 0, 0})),
                            up = normalize(transform.vector({0, sheet.mirrored_v ? -1.0 : 1.0, 0})),
                            normal = normalize(transform.vector({0, 0, 1}));
                b.camera(transform.point({0.1, 0.2, 3}), transform.point({0.1, 0.2, 0}), 0.1);
                expect_near(
                    shown_normal(b.scene, 1),
                    tangent * red + up * green + normal * std::sqrt(1 - red * red - green * green),
                    std::to_string(copies) + " " + std::to_string(&mirror - mirrors) + " " + std::to_string(bits));
            }
}

/// Normal maps on shapes other than meshes: at the visible point, u increases along the first vector and the image's
/// top is along the second.
TEST(NormalMap, BendsAlongTheAxesOfShapes)
{
    const Rectangle rectangle{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}};
    struct Case {
        decltype(Shape::geometry) shape;
        Vec3d from, at, tangent, up, normal;
    };
    const Case cases[] = {
        {rectangle, {0.1, 0.2, 3}, {0.1, 0.2, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
        {Sphere{{0, 0, 0}, 1, {}}, {3, 0, 0}, {1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {1, 0, 0}},
        {Sphere{{0, 0, 0}, -1, {}}, {0, 0, 0}, {1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {-1, 0, 0}},
        {Disk{{0, 0, 0}, {0, 0, 1}, 1}, {0.1, 0.2, 3}, {0.1, 0.2, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    };
    for (const Case& c : cases)
        for (const Transform& mirror : mirrors) {
            SceneBuilder b;
            const Transform transform = turn * mirror;
            Node node;
            node.parent_from_node = transform;
            node.shapes.push_back({c.shape, normal_map(b), ""});
            b.scene.roots.push_back(1);
            b.scene.nodes.push_back(node);
            b.camera(transform.point(c.from), transform.point(c.at), 1e-4);
            const auto turned = [&](Vec3d v) { return normalize(transform.vector(v)); };
            expect_near(shown_normal(b.scene, 1),
                        turned(c.tangent) * red + turned(c.up) * green +
                            turned(c.normal) * std::sqrt(1 - red * red - green * green),
                        std::to_string(&c - cases) + " " + std::to_string(&mirror - mirrors));
        }
}

}  // namespace
}  // namespace fathom
