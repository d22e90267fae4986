// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <set>

#include "compile/compiled_scenes.h"

// Tests of compiled geometry tables. Most errors in them would show in an image only as noise, or not at all where two
// errors cancel.
namespace fathom {
namespace {

/// A box has six faces with outward normals; a sphere under a nonuniform transform becomes a mesh on the ellipsoid.
TEST(GeometryTable, BoxesAndDistortedSpheres)
{
    SceneDescription d = empty_scene();
    d.nodes[0].shapes.push_back({Box{{-1, -2, -3}, {1, 2, 3}}, -1, ""});
    Node node;
    node.parent_from_node = Transform::scale({3, 1, 1});
    node.shapes.push_back({Sphere{{0, 0, 0}, 2, {}}, -1, ""});
    node.shapes.push_back({Sphere{{0, 0, 0}, -2, {}}, -1, ""});
    d.nodes.push_back(node);
    d.roots.push_back(1);
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    const auto world = [&](Vec3f p) { return Vec3d{p.x, p.y, p.z} * (1 / t.render_scale) + t.origin; };
    const auto direction = [&](Vec3f p) { return Vec3d{p.x, p.y, p.z}; };
    ASSERT_EQ(t.quads.size(), 6u);
    for (const QuadRecord& q : t.quads) {
        const Vec3d middle = world(q.corner) + (direction(q.edge_u) + direction(q.edge_v)) * (0.5 / t.render_scale);
        const Vec3d n = normalize(cross(direction(q.edge_u), direction(q.edge_v)));
        const double distance = std::abs(middle.x) + std::abs(middle.y) + std::abs(middle.z);
        EXPECT_NEAR(dot(n, middle), distance, 1e-5);
        EXPECT_NEAR(std::abs(n.x) * 1 + std::abs(n.y) * 2 + std::abs(n.z) * 3, distance, 1e-5);
    }
    ASSERT_GT(t.positions.size(), 1000u);
    for (std::size_t i = 0; i < t.triangles.size(); i += 3) {
        const bool inwards = t.shape_of_primitive[i / 3] == t.shape_of_primitive[t.triangle_count() - 1];
        const auto at = [&](std::size_t k) { return world(t.positions[t.triangles[i + k]]); };
        const Vec3d n = cross(at(1) - at(0), at(2) - at(0));
        ASSERT_EQ(dot(n, at(0)) < 0, inwards) << i;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d p = at(k);
            ASSERT_NEAR(p.x * p.x / 36 + p.y * p.y / 4 + p.z * p.z / 4, 1, 1e-5);
            // Normals follow the gradient of the ellipsoid's equation.
            const Vec3d gradient = normalize(Vec3d{p.x / 36, p.y / 4, p.z / 4}) * (inwards ? -1.0 : 1.0);
            ASSERT_NEAR(dot(direction(t.normals[t.triangles[i + k]]), gradient), 1, 1e-5);
            const Vec2f uv = t.uv0[t.triangles[i + k]];
            ASSERT_NEAR(std::cos(double(uv.y) * std::numbers::pi), p.y / 2, 1e-5);
        }
    }
}

/// Under rotation, nonuniform scale and mirroring, normals stay perpendicular to faces and tangents stay in them.
TEST(GeometryTable, NormalsStayPerpendicular)
{
    for (const double mirror : {1.0, -1.0}) {
        SceneDescription d = empty_scene();
        Mesh mesh;
        mesh.positions = {{0, 1, 0}, {1, 1, 0}, {0, 0, 1}};
        const float h = float(std::sqrt(0.5));
        mesh.normals.assign(3, {0, h, h});
        mesh.tangents.assign(3, {1, 0, 0, 1});
        mesh.indices = {0, 2, 1};
        d.meshes = {mesh};
        Node node;
        node.parent_from_node = Transform::translate({0, 0, -9}) * Transform::rotate({1, 2, 3}, 1.1) *
                                Transform::scale({mirror * 2, 0.5, 3}) * Transform::rotate({0, 1, 1}, 0.4);
        node.shapes.push_back({MeshInstance{0}, -1, ""});
        node.shapes.push_back({Rectangle{{5, 0, 0}, {1, 0, 0}, {0, 1, 0}}, -1, ""});
        d.nodes.push_back(node);
        d.roots.push_back(1);
        const Scene scene = compiled(d);
        const SceneTables& t = *scene.data().tables;
        ASSERT_EQ(t.triangle_count(), 1u);
        const auto at = [&](std::size_t k) {
            const Vec3f p = t.positions[t.triangles[k]];
            return Vec3d{p.x, p.y, p.z};
        };
        const Vec3d face = normalize(cross(at(1) - at(0), at(2) - at(0)));
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3f n = t.normals[t.triangles[k]];
            EXPECT_NEAR(dot(face, {n.x, n.y, n.z}), mirror, 1e-4);
            const Vec4f tangent = t.tangents[t.triangles[k]];
            const Vec3d along = normalize(node.parent_from_node.vector({1, 0, 0}));
            EXPECT_NEAR(dot(along, {tangent.x, tangent.y, tangent.z}), 1, 1e-5);
            EXPECT_EQ(tangent.w, mirror);
        }
    }
}

/// Moving shapes have positions relative to their instances; a mesh with several instances is stored once, with a map
/// to its object space.
TEST(GeometryTable, InstancesMapBack)
{
    SceneDescription d = empty_scene();
    Mesh mesh;
    constexpr std::uint32_t n = 40;
    for (std::uint32_t i = 0; i <= n; ++i)
        for (std::uint32_t j = 0; j <= n; ++j) mesh.positions.push_back({float(i) / n, float(j) / n, 0});
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
            mesh.indices.insert(mesh.indices.end(), {a, b, a + 1, b, b + 1, a + 1});
        }
    d.meshes.push_back(mesh);
    std::vector<Transform> places;
    for (int i = 0; i < 3; ++i) {
        Node node;
        node.parent_from_node = Transform::translate({3.0 * i, 1, -2}) * Transform::rotate({1, 2, 3}, i) *
                                Transform::scale({1, i == 1 ? -1.0 : 1.0, 2});
        places.push_back(node.parent_from_node);
        node.shapes.push_back({MeshInstance{0}, -1, ""});
        d.roots.push_back(int(d.nodes.size()));
        d.nodes.push_back(node);
    }
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    EXPECT_EQ(t.triangle_count(), n * n * 2);
    ASSERT_EQ(t.instances.size(), 3u);
    std::set<std::uint32_t> ids;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& m = t.instances[i].object_from_render;
        const Vec3d p = (places[i].point({0.3, 0.7, 0.2}) - t.origin) * t.render_scale;
        const double expected[] = {0.3, 0.7, 0.2};
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(
                double(m[4 * k]) * p.x + double(m[4 * k + 1]) * p.y + double(m[4 * k + 2]) * p.z + double(m[4 * k + 3]),
                expected[k], 1e-5);
        ids.insert(t.instances[i].object_id);
    }
    EXPECT_EQ(ids.size(), 3u);
}

/// Interpolation between neighboring poses takes the shorter rotation by the angle between them.
TEST(GeometryTable, PosesOfWhatTurns)
{
    SceneDescription d = empty_scene();
    d.cameras[0].shutter_open = 1, d.cameras[0].shutter_close = 2;
    Node node;
    for (int k = 0; k < 4; ++k)
        node.motion.push_back(
            {1 + k / 3.0, Transform::translate({double(k), 0, -5}) * Transform::rotate({0, 0, 1}, 2.5 * k)});
    node.shapes.push_back({Box{{-1, -1, -1}, {1, 1, 1}}, -1, ""});
    d.nodes.push_back(node);
    d.roots.push_back(1);
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    EXPECT_TRUE(t.moving);
    ASSERT_EQ(t.instances.size(), 1u);
    ASSERT_GE(t.instances[0].pose_count(), 4u);
    EXPECT_EQ(t.poses.front().time, 1);
    EXPECT_EQ(t.poses.back().time, 2);
    for (std::size_t k = 0; k + 1 < t.poses.size(); ++k) {
        const PoseRecord &a = t.poses[k], &b = t.poses[k + 1];
        double cosine = 0;
        for (int i = 0; i < 4; ++i) cosine += double(a.rotation[i]) * double(b.rotation[i]);
        EXPECT_GE(cosine, 0);
        const double angle = std::acos(std::min(1.0, cosine));
        EXPECT_NEAR(double(a.turns) * 2 * std::numbers::pi, angle, 1e-4);
        EXPECT_NEAR(double(a.inverse_sine) * std::sin(angle), 1, 1e-3);
        EXPECT_LT(a.time, b.time);
    }
}

/// Two triangles that form a parallelogram become a quad; triangles that need their vertices stay triangles.
TEST(GeometryTable, TrianglesAreJoinedWhereTheyMakeParallelograms)
{
    SceneDescription d = empty_scene();
    Mesh mesh;
    mesh.positions = {{0, 0, -5}, {2, 0, -5}, {3, 1, -5}, {1, 1, -5}, {9, 9, -5}};
    mesh.indices = {0, 1, 2, 0, 2, 3, 1, 4, 2};
    d.meshes = {mesh};
    d.nodes[0].shapes.push_back({MeshInstance{0}, -1, ""});
    const Scene joined = compiled(d);
    EXPECT_EQ(joined.data().tables->quads.size(), 1u);
    EXPECT_EQ(joined.data().tables->triangle_count(), 1u);
    const QuadRecord& q = joined.data().tables->quads[0];
    EXPECT_GT(q.edge_u.x * q.edge_v.y - q.edge_u.y * q.edge_v.x, 0);  // the front side is kept
}

/// Vertex normals prevent joining unless they equal the face normal, as files of boxes often have them.
TEST(GeometryTable, WeldsTrianglesWithoutNormals)
{
    const auto joined = [](std::vector<Vec3f> normals) {
        SceneDescription d = empty_scene();
        Mesh mesh;
        mesh.positions = {{0, 0, -5}, {2, 0, -5}, {3, 1, -5}, {1, 1, -5}};
        mesh.indices = {0, 1, 2, 0, 2, 3};
        mesh.normals = std::move(normals);
        d.meshes = {mesh};
        d.nodes[0].shapes.push_back({MeshInstance{0}, -1, ""});
        const Scene scene = compiled(d);
        EXPECT_EQ(scene.data().tables->triangle_count() + 2 * scene.data().tables->quads.size(), 2u);
        return scene.data().tables->quads.size() == 1;
    };
    const Vec3f front{0, 0, 1}, back{0, 0, -1}, bent{0, 0.01f, 1}, rounded{0, 1e-6f, 1};
    EXPECT_TRUE(joined({front, front, front, front}));
    EXPECT_TRUE(joined({front, rounded, front, front}));
    EXPECT_FALSE(joined({front, front, front, bent}));
    EXPECT_FALSE(joined({back, back, back, back}));
}

/// Triangles whose material depends on texture coordinates are not joined.
TEST(GeometryTable, TrianglesThatShowTheirUvAreNotJoined)
{
    const auto quads = [](const std::function<void(Material&)>& change, bool mixed = false) {
        SceneDescription d = empty_scene();
        Mesh mesh;
        mesh.positions = {{0, 0, -5}, {2, 0, -5}, {3, 1, -5}, {1, 1, -5}};
        mesh.indices = {0, 1, 2, 0, 2, 3};
        d.meshes = {mesh};
        Texture checks;
        checks.kind = TextureKind::checker_uv;
        d.textures = {checks};
        Material m, mix;
        m.kind = MaterialKind::principled;
        change(m);
        mix.kind = MaterialKind::mix, mix.mixture.material_a = mix.mixture.material_b = 0;
        d.materials = {m, mix};
        d.nodes[0].shapes.push_back({MeshInstance{0}, mixed ? 1 : 0, ""});
        return compiled(d).data().tables->quads.size();
    };
    EXPECT_EQ(quads([](Material& m) { m.coat.weight.value = 1; }), 1u);
    EXPECT_EQ(quads([](Material& m) { m.kind = MaterialKind::disney; }), 1u);
    const std::function<void(Material&)> changes[] = {
        [](Material& m) { m.base_color.texture = 0; },
        [](Material& m) { m.coat.weight.value = 1, m.coat.weight.texture = 0; },
        [](Material& m) { m.sheen.color = {{1, 1, 1}, 0}; },
        [](Material& m) { m.microfacets.anisotropy.value = 0.5f; },
        [](Material& m) { m.coat.weight.value = 1, m.coat.normal_texture = 0; },
        [](Material& m) { m.emission.radiance = {{1, 1, 1}, 0}; },
        [](Material& m) { m.kind = MaterialKind::disney, m.disney.flatness.texture = 0; },
        [](Material& m) { m.kind = MaterialKind::disney, m.microfacets.anisotropy.value = 0.5f; },
        [](Material& m) { m.kind = MaterialKind::hair; }};
    for (const auto& change : changes)
        for (const bool mixed : {false, true}) EXPECT_EQ(quads(change, mixed), 0u);
}

/// The Bezier control points of each basis are shared between neighboring segments, and each segment knows its place
/// along the curve.
TEST(GeometryTable, CurvesBecomeBezierSegments)
{
    for (const CurveBasis basis :
         {CurveBasis::linear, CurveBasis::bezier, CurveBasis::bspline, CurveBasis::catmull_rom}) {
        SceneDescription d = empty_scene();
        Curves curves;
        curves.basis = basis;
        for (int i = 0; i < 7; ++i) {
            curves.points.push_back({float(i * i % 5), float(i), -9 + float(i % 3)});
            curves.radii.push_back(0.1f * float(i + 1));
        }
        curves.counts = {7};
        d.curves = {curves};
        d.nodes[0].shapes.push_back({CurvesInstance{0}, -1, ""});
        const Scene scene = compiled(d);
        const SceneTables& t = *scene.data().tables;
        const std::size_t segments = basis == CurveBasis::linear ? 6 : basis == CurveBasis::bezier ? 2 : 4;
        ASSERT_EQ(t.curves.size(), segments);
        EXPECT_EQ(t.curves.front().u0, 0);
        EXPECT_EQ(t.curves.back().u1, 1);
        // The triangles are a point at the first key, a point at the last key, always a line, and never finite.
        const auto weights = [](CurveBasis of, double x, double(&w)[4]) {
            const double s = 1 - x;
            if (of == CurveBasis::bezier)
                w[0] = s * s * s, w[1] = 3 * s * s * x, w[2] = 3 * s * x * x, w[3] = x * x * x;
            else if (of == CurveBasis::bspline)
                w[0] = s * s * s / 6, w[1] = (3 * x * x * x - 6 * x * x + 4) / 6,
                w[2] = (3 * s * s * s - 6 * s * s + 4) / 6, w[3] = x * x * x / 6;
            else if (of == CurveBasis::catmull_rom)
                w[0] = (-x + 2 * x * x - x * x * x) / 2, w[1] = (2 - 5 * x * x + 3 * x * x * x) / 2,
                w[2] = (x + 4 * x * x - 3 * x * x * x) / 2, w[3] = (x * x * x - x * x) / 2;
            else
                w[0] = s, w[1] = x, w[2] = w[3] = 0;
        };
        const std::size_t step = basis == CurveBasis::bezier ? 3 : 1;
        for (std::size_t i = 0; i < segments; ++i) {
            EXPECT_FLOAT_EQ(t.curves[i].u0, float(i) / float(segments));
            for (double x : {0.0, 0.3, 1.0}) {
                double w[4], b[4], expected[4] = {}, got[4] = {};
                weights(basis, x, w);
                weights(basis == CurveBasis::linear ? basis : CurveBasis::bezier, x, b);
                for (std::size_t k = 0; k < (basis == CurveBasis::linear ? 2u : 4u); ++k) {
                    const Vec3f p = curves.points[i * step + k];
                    const double from[] = {p.x, p.y, p.z, curves.radii[i * step + k]};
                    const Vec4f q = t.curve_points[t.curves[i].first_point + k];
                    const double to[] = {q.x, q.y, q.z, q.w};
                    for (std::size_t c = 0; c < 4; ++c) expected[c] += w[k] * from[c], got[c] += b[k] * to[c];
                }
                for (std::size_t c = 0; c < 4; ++c)
                    EXPECT_NEAR(got[c] / t.render_scale, expected[c], 1e-5) << int(basis) << i;
            }
        }
    }
}

/// Moving control points are stored at the times of all keys while the shutter is open: every curve at every such time,
/// with the finest subdivision that any time needs.
TEST(GeometryTable, CurvesThatMoveHavePointsAtEachTime)
{
    SceneDescription d = empty_scene();
    Curves curves;
    curves.basis = CurveBasis::catmull_rom;
    for (int i = 0; i < 10; ++i) {
        curves.points.push_back({float(i % 5), 0, -9});
        curves.radii.push_back(0.1f);
    }
    curves.counts = {5, 5};
    curves.motion = {{0, curves.points, curves.radii}, {0.5, curves.points, curves.radii}};
    for (int i = 0; i < 10; ++i) curves.motion[1].points[std::size_t(i)].y += float(i * i % 7);
    d.curves = {curves};
    curves.motion[1].time = 0.75;
    d.curves.push_back(curves);
    for (int i = 0; i < 2; ++i) d.nodes[0].shapes.push_back({CurvesInstance{i}, -1, ""});
    d.cameras[0].shutter_close = 1;
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    EXPECT_EQ(t.vertex_times, (std::vector<float>{0, 0.5f, 0.75f, 1}));
    ASSERT_EQ(t.curves.size(), 8u);
    EXPECT_TRUE(t.moving);
    for (std::size_t k = 0; k < 8; ++k) {
        const std::uint32_t n = t.shapes[t.shape_of_primitive[t.first_curve() + k]].moving_vertices;
        EXPECT_EQ(n, 14u);
        EXPECT_GT(t.curves[k].pieces, 1u);
        // The first Bezier point of a segment is its second control point.
        const std::size_t point = 5 * (k % 4 / 2) + k % 2 + 1;
        const double end = k < 4 ? 0.5 : 0.75, way = double(point * point % 7);
        for (std::size_t time = 0; time < 4; ++time)
            EXPECT_FLOAT_EQ(float(t.curve_points[t.curves[k].first_point + time * n].y / t.render_scale),
                            float(way * std::min(1.0, double(t.vertex_times[time]) / end)))
                << k << ' ' << time;
    }
    // Geometry that is static during the shutter interval is placed at that time.
    d.cameras[0].shutter_open = 1;
    const Scene later = compiled(d);
    const SceneTables& still = *later.data().tables;
    EXPECT_TRUE(still.vertex_times.empty());
    EXPECT_FALSE(still.moving);
    EXPECT_EQ(still.curve_points.size(), 2 * 14u);
    EXPECT_FLOAT_EQ(float(still.curve_points[0].y / still.render_scale), 1);
}

}  // namespace
}  // namespace fathom
