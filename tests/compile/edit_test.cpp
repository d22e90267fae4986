// SPDX-License-Identifier: Apache-2.0
#include "fathom/editable_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <random>

#include "compile/scene_data.h"
#include "fathom/error.h"
#include "support/film_contents.h"

// After any sequence of edits the scene equals the one compiled from the current description: tables are compared by
// fingerprint, images bit by bit.
namespace fathom {
namespace {

std::vector<std::uint32_t> picture(const Scene& scene, std::vector<Aov> aovs = {Aov::normal, Aov::instance_id})
{
    RenderSettings settings;
    settings.width = 24, settings.height = 18;
    settings.aovs = std::move(aovs);
    const RenderJob job(scene, settings);
    Film film(job);
    render(job, {0, 4}, film);
    return test::words_of(film);
}

/// A tetrahedron with vertex normals.
Mesh tetrahedron(double size)
{
    Mesh mesh;
    const float s = float(size);
    mesh.positions = {{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}};
    for (const Vec3f& p : mesh.positions) mesh.normals.push_back({p.x / s, p.y / s, p.z / s});
    mesh.indices = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
    return mesh;
}

int add_node(SceneDescription& d, Shape shape, const Transform& place, bool movable)
{
    Node node;
    node.parent_from_node = place;
    node.movable = movable;
    node.shapes.push_back(std::move(shape));
    d.nodes.push_back(std::move(node));
    d.roots.push_back(int(d.nodes.size()) - 1);
    return d.roots.back();
}

/// Static: a floor, spheres, meshes with enough copies to become instances. Movable: one shape of each kind, one of
/// them emissive, and a node with a light. Editable vertices: one mesh.
class Room {
public:
    SceneDescription d;
    std::vector<int> movable;
    int soft = -1, soft_node = -1, lamp = -1;

    explicit Room(bool can_change = true)
    {
        d.file = "room";
        d.cameras.emplace_back();
        d.cameras[0].position = {0, 3, 12};
        d.cameras[0].look_at = {0, 1, 0};
        d.nodes.emplace_back();
        d.nodes[0].camera = 0;
        d.roots = {0};
        for (const float g : {0.7f, 0.4f, 0.2f}) {
            Material m;
            m.base_color.value = {g, 0.5f, 1 - g};
            d.materials.push_back(m);
        }
        Material light;
        light.emission.radiance.value = {5, 4, 3};
        lamp = int(d.materials.size());
        d.materials.push_back(light);
        Material glass;
        glass.kind = MaterialKind::glass;
        d.materials.push_back(glass);
        d.meshes = {tetrahedron(0.5), tetrahedron(1), tetrahedron(0.7)};
        d.meshes[2].movable = can_change;

        add_node(d, {Rectangle{{-20, -2, 20}, {40, 0, 0}, {0, 0, -40}}, 0, ""}, {}, false);
        for (int i = 0; i < 1200; ++i)
            add_node(d, {MeshInstance{0}, i % 3, ""},
                     Transform::translate({0.8 * (i % 40) - 16, -1.5, 2 - 0.8 * (i / 40)}), false);
        for (int i = 0; i < 40; ++i)
            add_node(d, {Sphere{{0.3 * i - 6, -1, 3}, 0.1, {}}, i % 3, ""}, Transform(), false);
        const auto add = [&](auto geometry, int material, Vec3d place) {
            movable.push_back(add_node(d, {geometry, material, ""}, Transform::translate(place), can_change));
        };
        add(MeshInstance{1}, 1, {-4, 1, 0});
        add(MeshInstance{1}, lamp, {-2, 2, 0});
        add(Sphere{{0, 0, 0}, 0.8, {}}, 4, {0, 1, 0});
        add(Sphere{{0, 0, 0}, 0.3, {}}, lamp, {2, 2, 0});
        add(Rectangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, lamp, {3, 0, 0});
        add(Disk{{0, 0, 0}, {0, 0, 1}, 0.6}, lamp, {4, 2, 0});
        add(Box{{0, 0, 0}, {1, 1, 1}}, 2, {5, 0, 0});
        Light point;
        point.intensity = {20, 20, 30};
        d.lights.push_back(point);
        Node node;
        node.light = 0;
        node.movable = can_change;
        node.parent_from_node = Transform::translate({0, 6, 3});
        movable.push_back(int(d.nodes.size()));
        d.roots.push_back(int(d.nodes.size()));
        d.nodes.push_back(node);
        soft = 2;
        soft_node = add_node(d, {MeshInstance{2}, 1, ""}, Transform::translate({-6, 1, 0}), false);
        d.environment.kind = EnvironmentKind::constant;
        d.environment.color = {0.1f, 0.1f, 0.2f};
    }
};

class Editing : public ::testing::Test {
protected:
    Warnings warnings;

    void expect_as_compiled(EditableScene& edit, bool anew)
    {
        const Scene fresh = Scene::compile(edit.description(), "", warnings);
        const Scene edited = edit.compile(warnings);
        EXPECT_EQ(edit.recompiled(), anew);
        EXPECT_EQ(edited.fingerprint(), fresh.fingerprint());
        EXPECT_EQ(picture(edited), picture(fresh));
        EXPECT_EQ(edited.statistics().triangles, fresh.statistics().triangles);
        EXPECT_EQ(edited.statistics().lights, fresh.statistics().lights);
    }
};

Transform random_place(std::mt19937& random)
{
    std::uniform_real_distribution<double> number(-1, 1);
    const Transform turned = Transform::rotate({number(random), number(random), 1.5}, 3 * number(random));
    const double size = std::exp(0.5 * number(random));
    return Transform::translate({6 * number(random), 2 + 2 * number(random), 2 * number(random)}) * turned *
           Transform::scale({size, size, random() % 4 == 0 ? -size : size});
}

TEST_F(Editing, FirstSceneIsTheCompiledOne)
{
    EditableScene edit(Room().d);
    expect_as_compiled(edit, true);
    expect_as_compiled(edit, false);
}

/// The fingerprint includes the positions of shapes that are not lights.
TEST_F(Editing, FingerprintTellsWhereThingsAre)
{
    const Room room;
    EditableScene edit(room.d);
    const std::uint64_t before = edit.compile(warnings).fingerprint();
    edit.set_transform(room.movable[0], Transform::translate({0, 3, 0}));
    EXPECT_NE(edit.compile(warnings).fingerprint(), before);
}

TEST_F(Editing, PlacesChange)
{
    const Room room;
    EditableScene edit(room.d);
    edit.compile(warnings);
    const auto before = picture(edit.compile(warnings));
    const std::uint64_t fingerprint = edit.compile(warnings).fingerprint();
    std::mt19937 random(1);
    for (int step = 0; step < 6; ++step) {
        SCOPED_TRACE(step);
        for (const int node : room.movable)
            if (step < 2 || random() % 2) edit.set_transform(node, random_place(random));
        expect_as_compiled(edit, false);
    }
    EXPECT_NE(picture(edit.compile(warnings)), before);
    EXPECT_NE(edit.compile(warnings).fingerprint(), fingerprint);
    // This moves all nodes back to their first transforms.
    for (const int node : room.movable) edit.set_transform(node, room.d.nodes[std::size_t(node)].parent_from_node);
    EXPECT_EQ(picture(edit.compile(warnings)), before);
}

/// A shape can be removed and added again.
TEST_F(Editing, WhatVanishesComesBack)
{
    Room room;
    for (const int node : room.movable) room.d.nodes[std::size_t(node)].parent_from_node = Transform::scale({0, 0, 0});
    EditableScene edit(room.d);
    expect_as_compiled(edit, true);
    std::mt19937 random(2);
    for (const int node : room.movable) edit.set_transform(node, random_place(random));
    expect_as_compiled(edit, false);
    edit.set_transform(room.movable[1], Transform::scale({0, 0, 0}));
    expect_as_compiled(edit, false);
}

TEST_F(Editing, VerticesChange)
{
    const Room room;
    EditableScene edit(room.d);
    edit.compile(warnings);
    // After enough edits the storage of earlier versions of the mesh must be compacted.
    for (int step = 1; step <= 2000; ++step) {
        Mesh mesh = tetrahedron(0.7);
        for (Vec3f& p : mesh.positions) p.x *= 1 + 0.001f * float(step);
        mesh.normals[0] = {1, float(step), 2};
        edit.set_vertices(room.soft, mesh.positions, mesh.normals);
        if (step % 500 == 0)
            expect_as_compiled(edit, false);
        else
            edit.compile(warnings);
    }
}

TEST_F(Editing, MotionAndShutterChange)
{
    Room room;
    Mesh& soft = room.d.meshes[std::size_t(room.soft)];
    for (int k = 0; k < 2; ++k) {
        MeshKey key{double(k), soft.positions, soft.normals};
        for (Vec3f& p : key.positions) p.y += float(k);
        soft.motion.push_back(key);
    }
    const auto keys = [](double angle) {
        std::vector<NodeKey> motion;
        for (int k = 0; k < 3; ++k)
            motion.push_back(
                {0.5 * k, Transform::translate({double(k), 1, 0}) * Transform::rotate({0, 1, 1}, angle * k)});
        return motion;
    };
    room.d.nodes[std::size_t(room.movable[0])].motion = keys(0.5);
    room.d.cameras[0].shutter_close = 0.25;
    EditableScene edit(room.d);
    expect_as_compiled(edit, true);
    for (int frame = 1; frame < 4; ++frame) {
        SCOPED_TRACE(frame);
        edit.set_shutter(0.25 * frame, 0.25 * frame + 0.25);
        expect_as_compiled(edit, false);
        edit.set_motion(room.movable[2], keys(0.3 * frame));
        expect_as_compiled(edit, false);
    }
    for (MeshKey& key : soft.motion)
        for (Vec3f& p : key.positions) p.z -= 1;
    edit.set_vertex_motion(room.soft, soft.motion);
    expect_as_compiled(edit, false);
}

/// If an edit changes the times of all keys, moving geometry that is not editable is resampled at the new times.
TEST_F(Editing, KeysAtOtherTimesBesideOthers)
{
    for (const bool curves : {false, true}) {
        Room room;
        const auto add = [&](auto geometry) {
            Node node;
            node.shapes.push_back({geometry, -1, ""});
            room.d.roots.push_back(int(room.d.nodes.size()));
            room.d.nodes.push_back(node);
        };
        if (curves) {
            room.d.curves.push_back({"", CurveBasis::linear, false, {{0, 0, 0}, {0, 1, 0}}, {0.1f, 0.1f}, {2}, {}});
            Curves& c = room.d.curves.back();
            c.motion = {{0, c.points, c.radii}, {0.25, c.points, {0.3f, 0.2f}}, {1, {{1, 0, 0}, {1, 2, 0}}, c.radii}};
            add(CurvesInstance{int(room.d.curves.size()) - 1});
        } else {
            Mesh mesh = tetrahedron(0.7);
            for (const double time : {0.0, 0.25, 1.0}) {
                mesh.motion.push_back({time, mesh.positions, mesh.normals});
                for (Vec3f& p : mesh.motion.back().positions) p.x += float(time * time);
            }
            room.d.meshes.push_back(mesh);
            add(MeshInstance{int(room.d.meshes.size()) - 1});
        }
        Mesh& soft = room.d.meshes[std::size_t(room.soft)];
        const auto keys = [&](double middle) {
            std::vector<MeshKey> motion;
            for (const double time : {0.0, middle, 1.0}) {
                motion.push_back({time, soft.positions, soft.normals});
                for (Vec3f& p : motion.back().positions) p.y += float(time * time);
            }
            return motion;
        };
        soft.motion = keys(0.5);
        room.d.cameras[0].shutter_close = 1;
        EditableScene edit(room.d);
        expect_as_compiled(edit, true);
        edit.set_vertex_motion(room.soft, keys(0.75));
        expect_as_compiled(edit, true);
        // If an edit changes keys but not their times, only the edited mesh is rebuilt.
        std::vector<MeshKey> other = keys(0.75);
        for (Vec3f& p : other[1].positions) p.z += 1;
        edit.set_vertex_motion(room.soft, other);
        expect_as_compiled(edit, false);
        edit.set_shutter(0, 0.5);
        expect_as_compiled(edit, true);
    }
}

/// If the shutter opens for an instant, nothing moves: another instant shows other poses, also of geometry that is not
/// editable.
TEST_F(Editing, MomentsOfWhatIsNotMovable)
{
    for (const bool node_moves : {false, true}) {
        SCOPED_TRACE(node_moves);
        Room room;
        Mesh mesh = tetrahedron(0.7);
        Node node;
        node.shapes.push_back({MeshInstance{int(room.d.meshes.size())}, -1, ""});
        if (node_moves) {
            node.motion = {{0, Transform()}, {1, Transform::translate({0, 1, 0})}};
        } else {
            mesh.motion = {{0, mesh.positions, mesh.normals}, {1, mesh.positions, mesh.normals}};
            for (Vec3f& p : mesh.motion.back().positions) p.y += 1;
        }
        room.d.meshes.push_back(mesh);
        room.d.roots.push_back(int(room.d.nodes.size()));
        room.d.nodes.push_back(node);
        EditableScene edit(room.d);
        expect_as_compiled(edit, true);
        edit.set_shutter(1, 1);
        expect_as_compiled(edit, true);
    }
}

TEST_F(Editing, MaterialsLightsAndSkyChange)
{
    const Room room;
    EditableScene edit(room.d);
    edit.compile(warnings);
    Material m = room.d.materials[1];
    m.base_color.value = {0.1f, 0.8f, 0.1f};
    m.kind = MaterialKind::metal;
    edit.set_material(1, m);
    expect_as_compiled(edit, false);
    m.emission.radiance.value = {1, 2, 3};
    edit.set_material(1, m);
    expect_as_compiled(edit, false);
    Material off = room.d.materials[std::size_t(room.lamp)];
    off.emission.radiance.value = {0, 0, 0};
    edit.set_material(room.lamp, off);
    expect_as_compiled(edit, false);
    Light light = room.d.lights[0];
    light.kind = LightKind::directional;
    edit.set_light(0, light);
    expect_as_compiled(edit, false);
    Environment sky = room.d.environment;
    sky.color = {1, 0.5f, 0.5f};
    edit.set_environment(sky);
    expect_as_compiled(edit, false);
    for (const EnvironmentKind kind : {EnvironmentKind::gradient, EnvironmentKind::studio, EnvironmentKind::none}) {
        sky.kind = kind;
        edit.set_environment(sky);
        expect_as_compiled(edit, false);
    }
}

/// Edits of nodes that were not declared movable compile the whole scene. Edits that change the scene's size or move
/// the camera compile it anew where needed: the bits are always those of a fresh compilation.
TEST_F(Editing, PosesAreExact)
{
    Room room;
    // A light whose selection probability depends on the size of the scene.
    Light sun;
    sun.kind = LightKind::directional;
    room.d.lights.push_back(sun);
    room.d.nodes[std::size_t(room.soft_node)].light = 1;
    room.d.meshes[std::size_t(room.soft)].uvs[0].assign(4, {0, 0});
    EditableScene edit(room.d);
    edit.compile(warnings);
    const auto expect_exact = [&](const AnimationPose& pose, bool anew) {
        edit.set_pose(pose);
        const Scene fresh = Scene::compile(edit.description(), "", warnings);
        const Scene edited = edit.compile_bit_exact(warnings);
        EXPECT_EQ(edit.recompiled(), anew);
        EXPECT_EQ(edited.fingerprint(), fresh.fingerprint());
        EXPECT_EQ(picture(edited), picture(fresh));
    };
    AnimationPose pose;
    pose.nodes = {{room.movable[0], Transform::translate({-3, 1, 0})}};
    pose.meshes.resize(1);
    pose.meshes[0].mesh = room.soft;
    pose.meshes[0].positions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    pose.meshes[0].normals.assign(4, {0, 0, 1});
    pose.numbers = {{AnimatedProperty::base_color, 1, {0.9f, 0.1f, 0.2f, 1}},
                    {AnimatedProperty::intensity, 0, {5, 0, 9, 0}}};
    expect_exact(pose, false);
    // A slightly larger scene keeps the scale of render space but has another radius.
    pose.nodes[0].second = Transform::translate({-3, 1, -26});
    expect_exact(pose, false);
    pose.nodes[0].second = Transform::translate({-300, 1, 0});
    expect_exact(pose, true);
    expect_exact(pose, false);
    pose.nodes.emplace_back(0, Transform::translate({0.5, 0, 0}));
    expect_exact(pose, true);
    // A pose may also change texture coordinates.
    pose.meshes[0].uvs[0] = {{0, 0}, {1, 0}, {0, 1}, {0.5f, 2}};
    expect_exact(pose, true);
    pose.meshes[0].uvs[0].clear();
    // A node's contents are removed and restored.
    const Node seen = edit.description().nodes[std::size_t(room.movable[0])];
    pose.contents = {{room.movable[0], Node{}}};
    expect_exact(pose, true);
    expect_exact(pose, false);
    pose.contents[0].second = seen;
    expect_exact(pose, true);
}

TEST_F(Editing, OtherChangesCompileAll)
{
    const Room room(false);
    EditableScene edit(room.d);
    edit.compile(warnings);
    edit.set_transform(room.movable[0], Transform::translate({0, 3, 0}));
    expect_as_compiled(edit, true);
    edit.set_vertices(room.soft, tetrahedron(0.9).positions, tetrahedron(0.9).normals);
    expect_as_compiled(edit, true);
    edit.edit_description().nodes[std::size_t(room.movable[1])].shapes.push_back({Sphere{{0, 3, 0}, 0.5, {}}, 0, ""});
    expect_as_compiled(edit, true);
    Material m = room.d.materials[0];
    m.opacity.mode = AlphaMode::blend;
    m.opacity.alpha.value = 0.5f;
    edit.set_material(0, m);
    expect_as_compiled(edit, true);
}

/// A compiled scene that is still in use is never modified by later edits.
TEST_F(Editing, ScenesInUseStayAsTheyAre)
{
    const Room room;
    EditableScene edit(room.d);
    const Scene first = edit.compile(warnings);
    const std::uint64_t fingerprint = first.fingerprint();
    const auto before = picture(first);
    edit.set_transform(room.movable[0], Transform::translate({0, 3, 0}));
    expect_as_compiled(edit, true);
    EXPECT_EQ(first.fingerprint(), fingerprint);
    EXPECT_EQ(picture(first), before);
}

TEST_F(Editing, WhatIsWrongIsRefusedByName)
{
    const Room room;
    EditableScene edit(room.d);
    edit.compile(warnings);
    const int node = room.movable[0];
    EXPECT_THROW(edit.set_transform(99999, {}), std::out_of_range);
    EXPECT_THROW(edit.set_transform(-1, {}), std::out_of_range);
    const auto refusal = [&] {
        try {
            edit.compile(warnings);
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    edit.set_transform(node, Transform::translate({std::numeric_limits<double>::quiet_NaN(), 0, 0}));
    EXPECT_NE(refusal().find("nodes[" + std::to_string(node) + "]"), std::string::npos);
    edit.set_transform(node, Transform::translate({1e22, 0, 0}));
    EXPECT_NE(refusal().find("nodes[" + std::to_string(node) + "]"), std::string::npos);
    edit.set_transform(node, Transform::translate({1, 0, 0}));
    expect_as_compiled(edit, true);
    edit.set_vertices(room.soft, tetrahedron(1).positions, {});
    expect_as_compiled(edit, true);
    edit.set_vertices(room.soft, tetrahedron(1).positions, std::vector<Vec3f>(2));
    EXPECT_NE(refusal().find("meshes[2].normals"), std::string::npos);
}

}  // namespace
}  // namespace fathom
