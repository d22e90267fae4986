// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

constexpr int width = 32, height = 24;

/// A scene with an orthographic camera at z = 10 whose shutter is open from 0 to 1 s. It sees black objects on a white
/// background: 8 m from left to right, 6 m from bottom to top.
struct Shadows : SceneBuilder {
    Shadows(double open = 0, double close = 1)
    {
        scene.environment.kind = EnvironmentKind::constant;
        camera({0, 0, 10}, {0, 0, 0});
        Camera& c = scene.cameras[0];
        c.kind = CameraKind::orthographic;
        c.height = 6;
        c.shutter_open = open;
        c.shutter_close = close;
    }
    int black()
    {
        Material m;
        m.kind = MaterialKind::none;
        return material(m);
    }
    Node& moving_node(std::vector<NodeKey> keys)
    {
        scene.roots.push_back(int(scene.nodes.size()));
        scene.nodes.emplace_back().motion = std::move(keys);
        return scene.nodes.back();
    }

    /// A pixel's expected value is the fraction of (x, y, time) that is uncovered.
    template <class Covered>
    void expect_shadow(const Covered& covered, std::uint64_t samples = 256)
    {
        const Film film = render_film(scene, small_image_settings(width, height), samples);
        const Image image = film.image(false, false);
        constexpr int cells = 8, times = 64;
        double worst = 0;
        for (int py = 0; py < height; ++py)
            for (int px = 0; px < width; ++px) {
                int hits = 0;
                for (int i = 0; i < cells * cells * times; ++i) {
                    const double x = (px + (i % cells + 0.5) / cells) / width * 8 - 4;
                    const double y = 3 - (py + (i / cells % cells + 0.5) / cells) / height * 6;
                    hits += covered(x, y, (i / cells / cells + 0.5) / times);
                }
                const double expected = 1 - double(hits) / (cells * cells * times);
                const double got = image.layers[0].pixels[std::size_t(3 * (py * width + px))];
                // Samples are stratified in space and time: the tolerance is five times their error.
                const double tolerance = 0.02 + 5 * std::sqrt(expected * (1 - expected) / double(samples));
                worst = std::max(worst, std::abs(got - expected) / tolerance);
            }
        EXPECT_LT(worst, 1);
    }
};

const Rectangle bar{{-0.5, -2, 0}, {1, 0, 0}, {0, 4, 0}};
bool in_bar(double x, double y)
{
    return std::abs(x) < 0.5 && std::abs(y) < 2;
}

TEST(MotionImages, a_node_goes_straight)
{
    Shadows s;
    s.moving_node({{0, Transform::translate({-2, 0, 0})}, {1, Transform::translate({2, 1, 0})}})
        .shapes.push_back({bar, s.black(), ""});
    s.expect_shadow([](double x, double y, double t) { return in_bar(x + 2 - 4 * t, y - t); });
}

TEST(MotionImages, a_node_turns_steadily)
{
    Shadows s;
    s.moving_node({{0, {}}, {1, Transform::rotate({0, 0, 1}, 2)}}).shapes.push_back({bar, s.black(), ""});
    s.expect_shadow([](double x, double y, double t) {
        const double c = std::cos(2 * t), si = std::sin(2 * t);
        return in_bar(c * x + si * y, c * y - si * x);
    });
}

/// A child offset from its parent's origin moves on an arc while it also rotates itself.
TEST(MotionImages, moving_nodes_within_moving_nodes)
{
    Shadows s;
    Node arm;
    arm.parent_from_node = Transform::translate({2, 0, 0});
    arm.children = {3};
    Node hand;
    hand.motion = {{0, {}}, {1, Transform::rotate({0, 0, 1}, -1)}};
    hand.shapes.push_back({Rectangle{{-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0}}, s.black(), ""});
    Node& shoulder = s.moving_node({{0, {}}, {1, Transform::rotate({0, 0, 1}, 1.5)}});
    shoulder.children = {2};
    s.scene.nodes.push_back(arm);
    s.scene.nodes.push_back(hand);
    s.expect_shadow([](double x, double y, double t) {
        const double c = std::cos(1.5 * t), si = std::sin(1.5 * t);
        const double ax = c * x + si * y - 2, ay = c * y - si * x;
        const double d = std::cos(-t), e = std::sin(-t);
        return std::max(std::abs(d * ax + e * ay), std::abs(d * ay - e * ax)) < 0.5;
    });
}

TEST(MotionImages, keys_within_and_beyond_the_shutter)
{
    Shadows s(1, 2);
    s.moving_node({{0, Transform::translate({-4, 0, 0})},
                   {1.5, Transform::translate({0.5, 0, 0})},
                   {1.75, Transform::translate({0.5, 1, 0})},
                   {4, Transform::translate({0.5, 1, 0})}})
        .shapes.push_back({bar, s.black(), ""});
    s.expect_shadow([](double x, double y, double t) {
        const double at = t < 0.5 ? -1 + 3 * t : 0.5;
        return in_bar(x - at, y - std::clamp((t - 0.5) * 4, 0.0, 1.0));
    });
}

TEST(MotionImages, a_closed_shutter_shows_one_moment)
{
    Shadows s(0.5, 0.5);
    s.moving_node({{0, Transform::translate({-2, 0, 0})}, {1, Transform::translate({4, 0, 0})}})
        .shapes.push_back({bar, s.black(), ""});
    s.expect_shadow([](double x, double y, double) { return in_bar(x - 1, y); });
}

Mesh bar_mesh()
{
    Mesh mesh;
    mesh.positions = {{-0.5f, -2, 0}, {0.5f, -2, 0}, {0.5f, 2, 0}, {-0.5f, 2, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

MeshKey bar_key(double time, float x, float top)
{
    MeshKey key{time, bar_mesh().positions, {}};
    for (Vec3f& p : key.positions) p.x += x, p.y = p.y > 0 ? top : p.y;
    return key;
}

TEST(MotionImages, vertices)
{
    Shadows s;
    Mesh mesh = bar_mesh();
    mesh.motion = {bar_key(0, -2, 2), bar_key(0.5, -1, 0), bar_key(2, 2, 0)};
    s.scene.meshes.push_back(mesh);
    s.add(MeshInstance{0}, s.black());
    s.expect_shadow([](double x, double y, double t) {
        const double at = t < 0.5 ? -2 + 2 * t : -1 + 2 * (t - 0.5), top = t < 0.5 ? 2 - 4 * t : 0;
        return std::abs(x - at) < 0.5 && y > -2 && y < top;
    });
}

TEST(MotionImages, vertices_within_a_moving_node)
{
    Shadows s;
    Mesh mesh = bar_mesh();
    mesh.motion = {bar_key(0, 0, 2), bar_key(1, 0, 0)};
    s.scene.meshes.push_back(mesh);
    s.moving_node({{0, Transform::translate({-2, 0, 0})}, {1, Transform::translate({2, 0, 0})}})
        .shapes.push_back({MeshInstance{0}, s.black(), ""});
    s.expect_shadow(
        [](double x, double y, double t) { return std::abs(x + 2 - 4 * t) < 0.5 && y > -2 && y < 2 - 2 * t; });
}

/// A rod from (x, -2) to (x, top) with a changing radius, as lines and as a cubic curve along them.
Curves rod(CurveBasis basis, bool ribbons)
{
    Curves curves;
    curves.basis = basis;
    curves.ribbons = ribbons;
    const int n = basis == CurveBasis::linear ? 2 : 4;
    const auto key = [&](double time, float x, float top, float radius) {
        CurvesKey k{time, {}, std::vector<float>(std::size_t(n), radius)};
        for (int i = 0; i < n; ++i) k.points.push_back({x, -2 + (top + 2) * float(i) / float(n - 1), 0});
        return k;
    };
    // The rest position differs from all keys, so using it would be detected.
    curves.points = key(0, 3, 3, 1).points, curves.radii = key(0, 3, 3, 1).radii;
    curves.counts = {std::uint32_t(n)};
    curves.motion = {key(0, -2, 2, 0.2f), key(0.5, -1, 0, 0.6f), key(2, 2, 0, 0.6f)};
    return curves;
}

TEST(MotionImages, points_of_curves)
{
    for (const CurveBasis basis : {CurveBasis::linear, CurveBasis::bezier})
        for (const bool ribbons : {false, true})
            for (const bool carried : {false, true}) {
                Shadows s;
                s.scene.curves.push_back(rod(basis, ribbons));
                if (carried)
                    s.moving_node({{0, Transform::translate({1, 0, 0})}, {1, Transform::translate({-1, 1, 0})}})
                        .shapes.push_back({CurvesInstance{0}, s.black(), ""});
                else
                    s.add(CurvesInstance{0}, s.black());
                SCOPED_TRACE(testing::Message() << int(basis) << ribbons << carried);
                s.expect_shadow([&](double x, double y, double t) {
                    if (carried) x -= 1 - 2 * t, y -= t;
                    const double at = t < 0.5 ? -2 + 2 * t : -1 + 2 * (t - 0.5), top = t < 0.5 ? 2 - 4 * t : 0;
                    const double radius = t < 0.5 ? 0.2 + 0.8 * t : 0.6;
                    const double beyond = y - std::clamp(y, -2.0, top);
                    return ribbons ? beyond == 0 && std::abs(x - at) < radius : std::hypot(x - at, beyond) < radius;
                });
            }
}

/// Coverage of a moving sphere: pure translation keeps a sphere in world space, a changing scale gives an ellipsoid.
TEST(MotionImages, spheres_disks_and_boxes)
{
    for (int kind = 0; kind < 4; ++kind) {
        Shadows s;
        const Transform end =
            kind == 1 ? Transform::translate({2, 0, 0}) * Transform::scale({2, 1, 1}) : Transform::translate({2, 0, 0});
        Node& node = s.moving_node({{0, Transform::translate({-2, 0, 0})}, {1, end}});
        const int black = s.black();
        if (kind < 2) node.shapes.push_back({Sphere{{0, 0, 0}, 1, {}}, black, ""});
        if (kind == 2) node.shapes.push_back({Disk{{0, 0, 0}, {0, 0, 1}, 1}, black, ""});
        if (kind == 3) node.shapes.push_back({Box{{-1, -1, -1}, {1, 1, 1}}, black, ""});
        s.expect_shadow([&](double x, double y, double t) {
            const double dx = (x + 2 - 4 * t) / (kind == 1 ? 1 + t : 1);
            return kind == 3 ? std::max(std::abs(dx), std::abs(y)) < 1 : dx * dx + y * y < 1;
        });
    }
}

/// A closed gray room that rotates and grows: its radiance is a geometric series at any time.
TEST(MotionImages, furnace)
{
    for (bool vertices : {false, true}) {
        SceneBuilder s;
        Mesh cube;
        for (int i = 0; i < 8; ++i)
            cube.positions.push_back({i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f});
        cube.indices = {0, 1, 3, 0, 3, 2, 4, 7, 5, 4, 6, 7, 0, 5, 1, 0, 4, 5,
                        2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 7, 3, 1, 5, 7};
        if (vertices) {
            cube.motion = {{0, cube.positions, {}}, {1, cube.positions, {}}};
            for (Vec3f& p : cube.motion[1].positions) p = {1.5f * p.x + 0.3f * p.y, 1.2f * p.y, p.z + 0.2f * p.x};
        }
        s.scene.meshes.push_back(cube);
        Node node;
        if (!vertices)
            node.motion = {{0, {}}, {1, Transform::rotate({1, 2, 3}, 1.5) * Transform::scale({1.5, 1.2, 1})}};
        node.shapes.push_back({MeshInstance{0}, s.diffuse(0.5f, {1, 1, 1}, true), ""});
        s.scene.roots.push_back(1);
        s.scene.nodes.push_back(node);
        s.camera({0, 0, 0}, {0.2, 0.1, -1}, 90);
        s.scene.cameras[0].shutter_close = 1;
        expect_mean(render_film(s.scene, small_image_settings(), 64), 2);
    }
}

/// Normals of moving shapes: directional illumination has the cosine of the orientation at each time.
TEST(MotionImages, normals_turn)
{
    for (int kind = 0; kind < 3; ++kind) {
        SceneBuilder s;
        s.camera({0, 0, 10}, {0, 0, 0});
        Camera& c = s.scene.cameras[0];
        c.kind = CameraKind::orthographic;
        c.height = 0.1;
        c.shutter_close = 1;
        Light sun;
        sun.kind = LightKind::directional;
        s.light(sun, Transform::translate({0, 0, 5}));
        Mesh mesh = bar_mesh();
        Node node;
        const int gray = s.diffuse(1);
        if (kind == 0) node.motion = {{0, {}}, {1, Transform::rotate({0, 1, 0}, 1)}};
        if (kind > 0) {
            mesh.motion = {{0, mesh.positions, {}}, {1, mesh.positions, {}}};
            // kind 1: the slope grows linearly from z = 0 to z = x; kind 2: only the normals change.
            if (kind == 1)
                for (Vec3f& p : mesh.motion[1].positions) p.z = p.x;
            if (kind == 2) {
                mesh.normals.assign(4, {0, 0, 1});
                mesh.motion[0].normals = mesh.normals;
                mesh.motion[1].normals.assign(4, {1, 0, 1});
            }
        }
        s.scene.meshes.push_back(mesh);
        node.shapes.push_back({MeshInstance{0}, gray, ""});
        s.scene.roots.push_back(int(s.scene.nodes.size()));
        s.scene.nodes.push_back(node);
        // The expected value is the mean of the cosine over pi. Normals have unit length at the keys and are linearly
        // interpolated between them.
        double expected = 0;
        constexpr int times = 1000;
        for (int i = 0; i < times; ++i) {
            const double t = (i + 0.5) / times, half = std::sqrt(0.5), z = 1 - t * (1 - half), x = t * half;
            expected += (kind == 0 ? std::cos(t) : kind == 1 ? 1 / std::sqrt(1 + t * t) : z / std::hypot(x, z)) / times;
        }
        expect_mean(render_film(s.scene, small_image_settings(8, 6), 1024), expected * std::numbers::inv_pi);
    }
}

/// A moving light gives the mean illumination of static lights along its path.
TEST(MotionImages, lamps)
{
    const auto build = [](std::vector<NodeKey> keys, const Transform& place) {
        SceneBuilder s;
        s.add(Rectangle{{-4, 0, 4}, {8, 0, 0}, {0, 0, -8}}, s.diffuse(0.5f));
        s.camera({0, 6, 0.1}, {0, 0, 0}, 40);
        s.scene.cameras[0].shutter_close = 1;
        Node lamp;
        lamp.motion = std::move(keys);
        lamp.parent_from_node = place;
        lamp.shapes.push_back({Rectangle{{-1, 2, -1}, {2, 0, 0}, {0, 0, 2}}, s.diffuse(0, {5, 5, 5}), ""});
        s.scene.roots.push_back(1);
        s.scene.nodes.push_back(lamp);
        RenderSettings settings = small_image_settings();
        return mean_of(render_film(s.scene, settings, 256));
    };
    constexpr int places = 16;
    double expected = 0, error = 0;
    for (int i = 0; i < places; ++i) {
        const Mean m = build({}, Transform::translate({-3 + 6 * (i + 0.5) / places, 0, 0}));
        expected += m.value[0] / places;
        error += m.error[0] / places;
    }
    const Mean m = build({{0, Transform::translate({-3, 0, 0})}, {1, Transform::translate({3, 0, 0})}}, {});
    EXPECT_NEAR(m.value[0], expected, 4 * (m.error[0] + error) + 0.002 * expected);
}

/// A light with a bright bottom face illuminates the floor with that face at every time, by NEE and by BSDF samples.
TEST(MotionImages, textured_lamps)
{
    Mean mean[2];
    for (bool light_sampling : {true, false}) {
        SceneBuilder s;
        s.add(Rectangle{{-4, 0, 4}, {8, 0, 0}, {0, 0, -8}}, s.diffuse(0.5f));
        s.camera({0, 6, 0.1}, {0, 0, 0}, 40);
        s.scene.cameras[0].shutter_close = 1;
        Texture bands;
        bands.kind = TextureKind::checker_uv;
        bands.uv_scale = {1, 4};
        s.scene.textures.push_back(bands);
        const int lamp = s.diffuse(0, {5, 5, 5});
        s.scene.materials[std::size_t(lamp)].emission.radiance.texture = 0;
        s.add(Sphere{{-3, 2, 0}, 0.8, Vec3d{3, 2, 0}}, lamp);
        RenderSettings settings = small_image_settings();
        settings.light_sampling = light_sampling;
        mean[light_sampling] = mean_of(render_film(s.scene, settings, light_sampling ? 256 : 2048));
    }
    EXPECT_NEAR(mean[1].value[0], mean[0].value[0], 4 * (mean[1].error[0] + mean[0].error[0]));
    EXPECT_GT(mean[0].value[0], 20 * mean[0].error[0]);
}

}  // namespace
}  // namespace fathom
