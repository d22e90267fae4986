// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "fathom/editable_scene.h"
#include "geometry/displacement/displacement_scenes.h"

// Displaced shapes in scenes: instances, motion, lights, threads and edits.
namespace fathom {
namespace {

using namespace test;

/// A mesh with two materials gets the displacement of each, as if it were alone.
TEST(Displacement, InstancesHaveWhatTheirMaterialsSay)
{
    TestScene s;
    const int plain = s.add_material({}), lifted = s.add_material(displacing(0.5f)),
              more = s.add_material(displacing(1));
    Mesh mesh;
    const int parts = 48;
    for (int j = 0; j <= parts; ++j)
        for (int i = 0; i <= parts; ++i) mesh.positions.push_back({float(i) / parts, float(j) / parts, 0});
    for (std::uint32_t j = 0; j < parts; ++j)
        for (std::uint32_t i = 0; i < parts; ++i) {
            const std::uint32_t a = j * (parts + 1) + i, b = a + parts + 1;
            mesh.indices.insert(mesh.indices.end(), {a, a + 1, b, b, a + 1, b + 1});
        }
    s.d.meshes.push_back(mesh);
    const int materials[] = {plain, lifted, more, lifted};
    const double heights[] = {0, 0.5, 1, 0.5};
    for (int i = 0; i < 4; ++i) {
        Node node;
        node.parent_from_node = Transform::translate({2.0 * i, 0, 0});
        node.shapes.push_back({MeshInstance{0}, materials[i], ""});
        s.d.roots.push_back(int(s.d.nodes.size()));
        s.d.nodes.push_back(node);
    }
    for (int i = 0; i < 4; ++i) {
        s.d.cameras[0].position = {2.0 * i + 0.51, 0.51, 5};
        s.d.cameras[0].look_at = {2.0 * i + 0.51, 0.51, 0};
        const Scene scene = s.compiled();
        EXPECT_EQ(scene.data().tables->instances.size(), 2u);
        EXPECT_NEAR(rendered(scene, {Aov::depth}).find("depth")->pixels.at(4), 5 - heights[i], 3e-4) << i;
    }
}

TEST(Displacement, MovingVerticesAreMovedAtEachKey)
{
    TestScene s;
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals.assign(3, {0, 0, 1});
    mesh.indices = {0, 1, 2};
    mesh.motion.push_back({0, mesh.positions, mesh.normals});
    // At the second key the triangle is rotated to face +x.
    mesh.motion.push_back({1, {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}, std::vector<Vec3f>(3, {1, 0, 0})});
    s.d.cameras[0].shutter_close = 1;
    s.add_mesh(mesh, s.add_material(displacing(0.5f)));
    const Scene scene = s.compiled();
    const SceneTables& t = *scene.data().tables;
    ASSERT_EQ(t.positions.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
        const Vec3d p = to_double(t.positions[i]) * (1 / t.render_scale) + t.origin;
        EXPECT_NEAR(i < 3 ? p.z : p.x, 0.5, 1e-6) << i;
        EXPECT_NEAR(i < 3 ? t.normals[i].z : t.normals[i].x, 1, 1e-6) << i;
    }
}

/// An emissive surface tilted by displacement illuminates like one that was built tilted.
TEST(Displacement, LampsShineFromWhereTheyAre)
{
    const HeightFile ramp(16, 16, [](double u, double) { return u; });
    const auto mean = [&](bool displaced, double& variance) {
        TestScene s;
        Material lamp;
        lamp.kind = MaterialKind::none;
        lamp.emission.radiance.value = {5, 5, 5};
        if (displaced) lamp.displacement.height = {0.5f, s.add_picture(ramp), 0};
        const int shining = s.add_material(lamp);
        // The image is constant before the center of the first texel and after that of the last.
        const auto height = [](int i) { return 1 - 0.5 * std::clamp(i / 16.0, 1 / 32.0, 31 / 32.0); };
        if (displaced) s.add(Rectangle{{-1, -1, 1}, {0, 2, 0}, {2, 0, 0}}, shining);
        for (int i = 0; !displaced && i < 16; ++i)
            s.add(Rectangle{{-1, i / 8.0 - 1, height(i)}, {0, 1 / 8.0, height(i + 1) - height(i)}, {2, 0, 0}}, shining);
        s.add(Rectangle{{-9, -9, 0}, {18, 0, 0}, {0, 18, 0}}, s.add_material({}));
        s.d.cameras[0].position = {3, 0.5, 0.4};
        s.d.cameras[0].look_at = {1.5, 0.5, 0};
        RenderSettings settings;
        settings.width = settings.height = 8;
        settings.max_depth = 1;
        settings.seed = displaced ? 1 : 2;
        const RenderJob job(s.compiled(), settings);
        Film film(job);
        render(job, {0, 1024}, film);
        const Image image = film.image(false, true);
        const Image::Layer* noise = image.find("variance");
        double sum = 0;
        variance = 0;
        for (std::size_t i = 0; i < 64; ++i) {
            sum += double(image.layers[0].pixels[3 * i]) / 64;
            if (noise) variance += double(noise->pixels[3 * i]) / (64 * 64);
        }
        return sum;
    };
    double v1, v2;
    const double by_map = mean(true, v1), by_hand = mean(false, v2);
    EXPECT_GT(by_hand, 0.01);
    ASSERT_GT(v1 + v2, 0);
    EXPECT_LT(std::abs(by_map - by_hand), 4 * std::sqrt(v1 + v2));
}

TEST(Displacement, TheBitsAreThoseOfOneThread)
{
    const HeightFile heights = random_heights(64);
    TestScene s;
    const int material = s.add_material(displacing(0.1f, s.add_picture(heights)));
    s.add_mesh(ball(1, 6, 9), material);
    s.add(Box{{2, 0, 0}, {3, 1, 1}}, material);
    const std::uint64_t many = s.compiled().fingerprint();
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(s.compiled().fingerprint(), many);
}

TEST(Displacement, EditsAreThoseOfTheSceneMadeAnew)
{
    const HeightFile heights = random_heights(16);
    TestScene s;
    const int texture = s.add_picture(heights), material = s.add_material(displacing(0.1f, texture));
    Mesh soft = ball(1, 6, 9);
    soft.movable = true;
    s.add_mesh(soft, material);
    Node node;
    node.movable = true;
    node.shapes.push_back({Sphere{{0, 0, 0}, 0.5, {}}, material, ""});
    s.d.roots.push_back(1);
    s.d.nodes.push_back(node);
    EditableScene edit(s.d);
    const auto expect_same = [&](bool anew) {
        Warnings warnings;
        const std::uint64_t edited = edit.compile(warnings).fingerprint();
        EXPECT_EQ(edited, Scene::compile(edit.description(), "", warnings).fingerprint());
        EXPECT_EQ(edit.recompiled(), anew);
        return edited;
    };
    const std::uint64_t first = expect_same(true);
    edit.set_transform(1, Transform::translate({0.25, 0.5, 0.125}));
    const std::uint64_t elsewhere = expect_same(false);
    EXPECT_NE(elsewhere, first);
    Material colored = s.d.materials[0];
    colored.base_color.value = {0.1f, 0.2f, 0.3f};
    edit.set_material(material, colored);
    expect_same(false);
    Material higher = colored;
    higher.displacement.height.value = 0.2f;
    edit.set_material(material, higher);
    const std::uint64_t high = expect_same(true);
    higher.displacement.midlevel = 0.5f;
    edit.set_material(material, higher);
    EXPECT_NE(expect_same(true), high);
    std::vector<Vec3f> positions = soft.positions;
    for (Vec3f& p : positions) p.x *= 1.5f;
    edit.set_vertices(0, positions, soft.normals);
    expect_same(true);
    higher.displacement.height.value = 0;
    edit.set_material(material, higher);
    expect_same(true);
}

TEST(Displacement, ReportsUnsupportedDisplacement)
{
    TestScene s;
    const int material = s.add_material(displacing(0.1f));
    s.add(Sphere{{0, 0, 0}, 1, Vec3d{1, 0, 0}}, material);
    Warnings warnings;
    const Scene scene = Scene::compile(s.d, "", warnings);
    ASSERT_EQ(warnings.counts().size(), 1u);
    EXPECT_NE(warnings.counts().begin()->first.find("center_end"), std::string::npos);
    EXPECT_EQ(scene.data().tables->spheres.size(), 1u);
}

}  // namespace
}  // namespace fathom
