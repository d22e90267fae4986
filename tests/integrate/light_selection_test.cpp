// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "fathom/editable_scene.h"
#include "picture_helpers.h"

// Many lights of which one is sampled per vertex: the selection strategy changes only the noise.
namespace fathom {
namespace {

using namespace test;

class RandomNumbers {
public:
    explicit RandomNumbers(unsigned seed) : engine_(seed) {}
    double operator()(double lo, double hi) { return lo + (hi - lo) * double(engine_() >> 8) * 0x1p-24; }
    Vec3d point() { return {(*this)(-2, 2), (*this)(0.3, 3), (*this)(-2, 2)}; }
    Vec3d direction()
    {
        for (;;) {
            const Vec3d d{(*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)};
            if (dot(d, d) < 1 && dot(d, d) > 1e-2) return normalize(d);
        }
    }

private:
    std::mt19937 engine_;
};

Mesh random_triangles(RandomNumbers& chance, int n)
{
    Mesh mesh;
    for (int i = 0; i < n; ++i) {
        const Vec3d a = chance.point(), u = chance.direction() * chance(0.05, 0.4), v = chance.direction() * 0.3;
        for (const Vec3d& p : {a, a + u, a + v}) {
            mesh.indices.push_back(std::uint32_t(mesh.positions.size()));
            mesh.positions.push_back(rounded(p));
        }
    }
    return mesh;
}

/// Index of the node with lights that moves.
constexpr int carried_lamps = 1;

std::vector<NodeKey> random_motion(RandomNumbers& chance)
{
    std::vector<NodeKey> keys{{0, {}}};
    for (const double time : {0.2, 0.5})
        keys.push_back({time, Transform::translate(chance.direction() * 0.4) *
                                  Transform::rotate(chance.direction(), chance(-1, 1)) *
                                  Transform::scale({chance(0.7, 1.2), chance(0.7, 1.2), 1})});
    return keys;
}

/// Adds triangles, a panel and a spot light in a moving node, and triangles with moving vertices.
void add_moving_lights(SceneBuilder& b, RandomNumbers& chance)
{
    Mesh mesh = random_triangles(chance, 5);
    b.scene.meshes.push_back(mesh);
    Node node;
    node.motion = random_motion(chance);
    node.movable = true;
    node.shapes = {{MeshInstance{int(b.scene.meshes.size()) - 1}, b.diffuse(0, {5, 4, 3}), ""},
                   {Rectangle{{-0.2, 1.5, -0.6}, {0.6, 0, 0}, {0, 0.1, 0.5}}, b.diffuse(0, {3, 4, 5}, true), ""}};
    Light spot;
    spot.kind = LightKind::spot;
    spot.outer_angle = 0.8;
    b.light(spot, Transform::translate({0, 1.5, 0}) * rotate_to({0.3, -1, 0}));
    node.children = {b.scene.roots.back()};
    b.scene.roots.back() = int(b.scene.nodes.size());
    b.scene.nodes.push_back(node);
    std::swap(b.scene.nodes[carried_lamps], b.scene.nodes.back());
    b.scene.nodes[carried_lamps].children = {b.scene.roots.back()};
    b.scene.roots.back() = carried_lamps;

    mesh.motion = {{0, mesh.positions, {}}, {0.3, mesh.positions, {}}, {0.5, mesh.positions, {}}};
    for (MeshKey& key : mesh.motion)
        for (Vec3f& p : key.positions) p.y += float(chance(0, 0.2)), p.x += float(chance(-0.3, 0.3));
    b.scene.meshes.push_back(mesh);
    b.add(MeshInstance{int(b.scene.meshes.size()) - 1}, b.diffuse(0, {3, 3, 6}));
}

/// A glossy floor and a wall under all kinds of lights: one- and two-sided triangles, instances, moving lights,
/// spheres, disks, points, spots, and a sun in every third scene.
SceneDescription random_lights(unsigned seed)
{
    RandomNumbers chance(seed);
    SceneBuilder b;
    Material glossy;
    glossy.kind = MaterialKind::principled;
    glossy.base_color.value = {0.7f, 0.7f, 0.7f};
    glossy.metallic.value = 1;
    glossy.roughness.value = 0.4f;
    b.add(Rectangle{{-3, 0, 3}, {6, 0, 0}, {0, 0, -6}}, b.material(glossy));
    b.add(Rectangle{{-3, 0, -3}, {6, 0, 0}, {0, 4, 0}}, b.diffuse(0.6f));
    // NEE and BSDF samples both find this panel. Its highlight on the floor would be wrong if their probabilities
    // disagreed.
    b.add(Rectangle{{-1, 0.1, -1.5}, {2, 0, 0}, {0, 0.8, 0}}, b.diffuse(0, {3, 3, 3}));
    for (const bool two_sided : {false, true}) {
        b.scene.meshes.push_back(random_triangles(chance, int(seed) * 2));
        b.add(MeshInstance{int(two_sided)}, b.diffuse(0, {6, 5, 4}, two_sided));
    }
    Node again;
    again.shapes = {b.scene.nodes[0].shapes.back()};
    add_moving_lights(b, chance);
    again.movable = true;
    for (int i = 0; i < 2; ++i) {
        again.parent_from_node = Transform::translate({0.3, 0.2 * i, 0.1}) * Transform::rotate({0, 1, 0}, 1 + i) *
                                 Transform::scale({1, 0.8, 1});
        b.scene.roots.push_back(int(b.scene.nodes.size()));
        b.scene.nodes.push_back(again);
    }
    for (unsigned i = 0; i < seed % 7; ++i) {
        const Vec3d center = chance.point();
        Sphere ball{center, chance(0.02, 0.15), {}};
        if (i % 2) ball.center_end = center + chance.direction();
        b.add(ball, b.diffuse(0, {4, 6, 8}));
        b.add(Disk{chance.point(), chance.direction(), chance(0.02, 0.2)}, b.diffuse(0, {8, 6, 4}, i % 3 == 0));
    }
    for (unsigned i = 0; i < seed % 5; ++i) {
        Light light;
        light.kind = i == 3 ? LightKind::beam : i % 2 ? LightKind::spot : LightKind::point;
        light.outer_angle = chance(0.2, 1.2);
        light.intensity = {1, 1, 1};
        b.light(light, Transform::translate(chance.point()) * rotate_to({chance(-1, 1), -1, chance(-1, 1)}));
    }
    if (seed % 3 == 0) {
        Light sun;
        sun.kind = LightKind::directional;
        b.light(sun, rotate_to({1, -2, 0.5}));
    }
    b.camera({0.5, 2, 5.5}, {0, 1, 0}, 50);
    b.scene.cameras[0].shutter_close = 0.5;
    return b.scene;
}

TEST(LightSelections, OnlyChangeTheNoise)
{
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const SceneDescription scene = random_lights(seed);
        RenderSettings settings = small_image_settings(24, 18);
        settings.max_depth = 3;
        const std::array<Mean, 3> means = means_by_selection(scene, settings, 256);
        const Mean& tree = means[int(LightSelection::tree)];
        EXPECT_GT(tree.value[0], 0.01);
        EXPECT_LT(tree.error[0], 0.03 * tree.value[0]) << "seed " << seed;
        for (const LightSelection other : {LightSelection::power, LightSelection::uniform})
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(tree.value[c], means[int(other)].value[c],
                            4.5 * std::hypot(tree.error[c], means[int(other)].error[c]))
                    << "seed " << seed << ", channel " << c << ", selection " << int(other);
    }
}

/// After an edit that moves lights, the light tree equals that of the scene compiled anew.
TEST(LightSelections, FollowAnEdit)
{
    SceneDescription scene = random_lights(9);
    Warnings warnings;
    EditableScene edit(scene);
    edit.compile(warnings);
    const int lamps = scene.roots.back() - 5;  // the moving instance precedes four lights and the sun
    const Transform moved = Transform::translate({-0.5, 0.4, 0.7});
    edit.set_transform(lamps, moved);
    scene.nodes[std::size_t(lamps)].parent_from_node = moved;
    const std::vector<NodeKey> motion{{0, moved}, {0.4, Transform::rotate({1, 1, 0}, 0.5)}};
    edit.set_motion(carried_lamps, motion);
    scene.nodes[carried_lamps].motion = motion;
    Light dim;
    dim.intensity = {0.1f, 0.2f, 0.3f};
    edit.set_light(0, dim);
    scene.lights[0] = dim;
    const RenderSettings settings = small_image_settings(24, 18);
    const auto picture = [&](const Scene& compiled) {
        const RenderJob job(compiled, settings);
        Film film(job);
        EXPECT_TRUE(render(job, {0, 4}, film));
        return film.image(false, false).layers[0].pixels;
    };
    ASSERT_TRUE(scene.nodes[std::size_t(lamps)].movable);
    EXPECT_EQ(picture(edit.compile(warnings)), picture(Scene::compile(scene, "", warnings)));
    EXPECT_FALSE(edit.recompiled());
}

}  // namespace
}  // namespace fathom
