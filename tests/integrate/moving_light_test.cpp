// SPDX-License-Identifier: Apache-2.0
#include "floor.h"

// Lights that move during the shutter interval: irradiance of a floor point is the mean over time of static lights,
// integrated numerically over small cells of their surfaces.
namespace fathom {
namespace {

using namespace test;

/// A small surface element given by two edges; its front is the side of their cross product.
struct Cell {
    Vec3d p, du, dv;
};
using Cells = std::vector<Cell>;

Cells triangle_cells(Vec3d a, Vec3d b, Vec3d c)
{
    constexpr int n = 24;
    Cells cells;
    const Vec3d u = (b - a) * (1.0 / n), v = (c - a) * (1.0 / n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; i + j < n; ++j) {
            cells.push_back({a + u * (i + 1.0 / 3) + v * (j + 1.0 / 3), u * 0.5, v});
            if (i + j < n - 1) cells.push_back({a + u * (i + 2.0 / 3) + v * (j + 2.0 / 3), u * 0.5, v});
        }
    return cells;
}

Cells rectangle_cells(const Rectangle& r)
{
    constexpr int n = 24;
    Cells cells;
    const Vec3d u = r.edge_u * (1.0 / n), v = r.edge_v * (1.0 / n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) cells.push_back({r.corner + u * (i + 0.5) + v * (j + 0.5), u, v});
    return cells;
}

/// Cells of a disk that faces down.
Cells disk_cells(Vec3d center, double radius)
{
    constexpr int n = 24;
    Cells cells;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < 2 * n; ++j) {
            const double r = radius * (i + 0.5) / n, a = std::numbers::pi * (j + 0.5) / n;
            const Vec3d out{std::cos(a), 0, std::sin(a)}, round{-std::sin(a), 0, std::cos(a)};
            cells.push_back({center + out * r, out * (radius / n), round * (r * std::numbers::pi / n)});
        }
    return cells;
}

Cells ball_cells(Vec3d center, double radius)
{
    constexpr int n = 40;
    Cells cells;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < 2 * n; ++j) {
            const double b = std::numbers::pi * (i + 0.5) / n, a = std::numbers::pi * (j + 0.5) / n;
            const Vec3d down{std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), -std::sin(b)};
            const Vec3d round{-std::sin(a), std::cos(a), 0}, out = cross(down, round);
            const double size = radius * std::numbers::pi / n;
            cells.push_back({center + out * radius, down * size, round * (size * std::sin(b))});
        }
    return cells;
}

/// A node's motion, given by closed formulas.
struct NodeMotionCase {
    const char* name;
    Vec3d shift;  ///< translation at time 1, from (0, 0, 0)
    double angle = 0;
    Vec3d axis{0, 0, 1};
    Vec3d scale{1, 1, 1};  ///< scale at time 1, from (1, 1, 1)

    Transform at(double t) const
    {
        const auto grown = [&](double s) { return 1 + (s - 1) * t; };
        return Transform::translate(shift * t) * Transform::rotate(axis, angle * t) *
               Transform::scale({grown(scale.x), grown(scale.y), grown(scale.z)});
    }
    std::vector<NodeKey> keys() const { return {{0, at(0)}, {1, at(1)}}; }
};
const NodeMotionCase ways[] = {
    {"goes", {1.5, 0.4, -0.3}},
    {"turns", {0, 0, 0}, 1.2, {0.3, 0.2, 1}},
    {"grows", {0.3, 0.1, 0}, 0, {0, 0, 1}, {1.8, 1.8, 1.8}},
    {"is stretched and turned", {0.5, 0.2, 0.1}, 0.8, {0, 1, 0.4}, {1.6, 1, 0.5}},
};
const NodeMotionCase rests{"rests", {0, 0, 0}};

/// Irradiance of the floor at p from cells of radiance 1.
double irradiance(const Cells& cells, const Transform& place, bool two_sided, Vec3d p)
{
    double sum = 0;
    for (const Cell& c : cells) {
        const Vec3d to = place.point(c.p) - p, n = cross(place.vector(c.du), place.vector(c.dv));
        const double facing = -dot(to, n), distance2 = dot(to, to);
        if (to.y > 0) sum += (two_sided ? std::abs(facing) : std::max(facing, 0.0)) * to.y / (distance2 * distance2);
    }
    return sum;
}

template <class CellsAt>
double mean_irradiance(const CellsAt& cells_at, const NodeMotionCase& way, bool two_sided, Vec3d p)
{
    constexpr int times = 48;
    double sum = 0;
    for (int i = 0; i < times; ++i) {
        const double t = (i + 0.5) / times;
        sum += irradiance(cells_at(t), way.at(t), two_sided, p) / times;
    }
    return sum;
}

Mesh triangle_mesh(const std::vector<Vec3d>& corners)
{
    Mesh mesh;
    for (const Vec3d& c : corners) {
        mesh.indices.push_back(std::uint32_t(mesh.positions.size()));
        mesh.positions.push_back(rounded(c));
    }
    return mesh;
}

void add_node(SceneBuilder& b, std::vector<NodeKey> motion, const Shape& shape)
{
    Node node;
    node.motion = std::move(motion);
    node.shapes.push_back(shape);
    b.scene.roots.push_back(int(b.scene.nodes.size()));
    b.scene.nodes.push_back(node);
}

const Vec3d floor_point{0.2, 0, 0.1};
const Rectangle panel{{-0.4, 0.9, -0.3}, {0.8, 0.1, 0}, {0, 0.2, 0.7}};
const std::vector<Vec3d> sail{{-0.4, 0.8, -0.3}, {0.5, 0.9, -0.2}, {0.1, 1.1, 0.5}};

/// A kind of shape: the shape of a node, and the same surface as cells for the reference integral.
struct ShapeCase {
    const char* name;
    Shape shape;
    Cells cells;
    bool is_ball = false;
};
std::vector<ShapeCase> forms(SceneBuilder* b)
{
    const int mesh = b ? int(b->scene.meshes.size()) : 0;
    if (b) b->scene.meshes.push_back(triangle_mesh(sail));
    const int points = b ? int(b->scene.points.size()) : 0;
    if (b) b->scene.points.push_back({"", {{0.2f, 1, 0.1f}}, {0.3f}});
    return {{"mesh", {MeshInstance{mesh}, -1, ""}, triangle_cells(sail[0], sail[1], sail[2])},
            {"rectangle", {panel, -1, ""}, rectangle_cells(panel)},
            {"disk", {Disk{{0.1, 1, 0}, {0, -1, 0}, 0.4}, -1, ""}, disk_cells({0.1, 1, 0}, 0.4)},
            {"sphere", {Sphere{{0.1, 1, 0}, 0.3, {}}, -1, ""}, ball_cells({0.1, 1, 0}, 0.3), true},
            {"points", {PointsInstance{points}, -1, ""}, ball_cells({0.2f, 1, 0.1f}, 0.3f), true}};
}

TEST(MovingLights, SendWhatTheyDoFromWhereTheyAre)
{
    const std::size_t count = forms(nullptr).size();
    for (const NodeMotionCase& way : ways)
        for (std::size_t kind = 0; kind < count; ++kind)
            for (const bool two_sided : {false, true}) {
                const ShapeCase form = forms(nullptr)[kind];
                SCOPED_TRACE(testing::Message()
                             << form.name << " that " << way.name << (two_sided ? ", two-sided" : ""));
                Floor floor;
                floor.samples = 512;
                floor.shutter_close = 1;
                floor.add_objects = [&](SceneBuilder& b) {
                    Shape shape = forms(&b)[kind].shape;
                    shape.material = b.diffuse(0, {3, 3, 3}, two_sided);
                    add_node(b, way.keys(), shape);
                };
                // The inside of a sphere is not visible.
                const double expected =
                    mean_irradiance([&](double) { return form.cells; }, way, two_sided && !form.is_ball, floor_point);
                floor.expect(floor_point.x, floor_point.z, 3 * expected, 4e-3);
            }
}

/// Vertices that move independently between keys, in world space and in moving nodes.
TEST(MovingLights, VerticesThatMove)
{
    const std::vector<Vec3d> keys[] = {sail,
                                       {{-0.6, 1.0, -0.3}, {0.5, 0.7, -0.4}, {0.3, 1.3, 0.5}},
                                       {{0.2, 0.8, -0.3}, {0.7, 0.9, -0.5}, {0.5, 0.6, 0.3}}};
    const double times[] = {0, 0.4, 1};
    const auto cells_at = [&](double t) {
        const int k = t < times[1] ? 0 : 1;
        const double f = (t - times[k]) / (times[k + 1] - times[k]);
        Vec3d c[3];
        for (std::size_t i = 0; i < 3; ++i) c[i] = keys[k][i] * (1 - f) + keys[k + 1][i] * f;
        return triangle_cells(c[0], c[1], c[2]);
    };
    for (const NodeMotionCase& way : {rests, ways[0], ways[3]})
        for (const bool two_sided : {false, true})
            for (const bool flipped : {false, true}) {
                SCOPED_TRACE(testing::Message() << "in a node that " << way.name << two_sided << flipped);
                Floor floor;
                floor.samples = 512;
                floor.shutter_close = 1;
                floor.add_objects = [&](SceneBuilder& b) {
                    Mesh mesh = triangle_mesh(sail);
                    for (int k = 0; k < 3; ++k) mesh.motion.push_back({times[k], triangle_mesh(keys[k]).positions, {}});
                    if (flipped) {
                        // A mesh mirrored in x inside a node that mirrors it back: faces that point down still do.
                        for (MeshKey& key : mesh.motion)
                            for (Vec3f& p : key.positions) p.x = -p.x;
                        mesh.indices = {0, 2, 1};
                    }
                    b.scene.meshes.push_back(mesh);
                    add_node(b, way.keys(), {MeshInstance{0}, b.diffuse(0, {3, 3, 3}, two_sided), ""});
                    if (!flipped) return;
                    Node& node = b.scene.nodes.back();
                    const Transform mirror = Transform::scale({-1, 1, 1});
                    for (NodeKey& key : node.motion) key.parent_from_node = key.parent_from_node * mirror;
                };
                floor.expect(floor_point.x, floor_point.z, 3 * mean_irradiance(cells_at, way, two_sided, floor_point),
                             4e-3);
            }
}

/// The light is too small for BSDF samples to hit it often, so without NEE the noise is many times higher.
TEST(MovingLights, HaveLessNoiseThanWhatIsFoundByChance)
{
    const std::size_t count = forms(nullptr).size();
    for (std::size_t kind = 0; kind <= count; ++kind)
        for (int way = 1; way < 4; ++way) {
            double error[2] = {}, value[2] = {};
            for (const bool light_sampling : {true, false}) {
                Floor floor;
                floor.samples = 256;
                floor.shutter_close = 1;
                floor.light_sampling = light_sampling;
                floor.add_objects = [&](SceneBuilder& b) {
                    const int material = b.diffuse(0, {3, 3, 3}, true);
                    const Transform small = Transform::translate({0.3, 0.9, 0}) * Transform::scale({0.2, 0.2, 0.2});
                    if (kind == count) {
                        Mesh mesh = triangle_mesh({small.point(sail[0]), small.point(sail[1]), small.point(sail[2])});
                        mesh.motion = {{0, mesh.positions, {}}, {1, mesh.positions, {}}};
                        for (Vec3f& p : mesh.motion[1].positions) p.x += 1;
                        b.scene.meshes.push_back(mesh);
                        return add_node(b, {}, {MeshInstance{0}, material, ""});
                    }
                    Shape shape = forms(&b)[kind].shape;
                    shape.material = material;
                    std::vector<NodeKey> keys = ways[0].keys();
                    for (NodeKey& key : keys) key.parent_from_node = key.parent_from_node * small;
                    add_node(b, keys, shape);
                };
                const Mean m = floor.irradiance(floor_point.x, floor_point.z, way);
                error[light_sampling] = m.error[0], value[light_sampling] = m.value[0];
            }
            EXPECT_NEAR(value[0], value[1], 4.5 * std::hypot(error[0], error[1]));
            // Compares variances. Of 16,384 samples without NEE a few hundred hit the light.
            EXPECT_LT(std::pow(error[1], 2), std::pow(error[0], 2) / 10) << kind << " " << Floor::ways[way];
        }
}

/// A panel that faces up at first and down at the end, beside a static light: selection probabilities account for the
/// whole shutter interval.
TEST(MovingLights, TurnTowardsTheFloor)
{
    const NodeMotionCase way{"turns over", {0, 2, 0}, 2.8, {1, 0, 0}};
    const Rectangle up{{-0.2, 1, 0.2}, {0.4, 0, 0}, {0, 0, -0.4}};
    Floor floor;
    floor.samples = 1024;
    floor.shutter_close = 1;
    floor.add_objects = [&](SceneBuilder& b) {
        b.add(Sphere{{1, 1, 0}, 0.2, {}}, b.diffuse(0, {1, 1, 1}));
        add_node(b, way.keys(), {up, b.diffuse(0, {3, 3, 3}), ""});
    };
    constexpr int times = 2000;
    double expected = irradiance(ball_cells({1, 1, 0}, 0.2), {}, false, floor_point);
    for (int i = 0; i < times; ++i)
        expected += 3 * irradiance(rectangle_cells(up), way.at((i + 0.5) / times), false, floor_point) / times;
    floor.expect(floor_point.x, floor_point.z, expected, 4e-3);
    // BSDF samples also hit the panel, with 16 times the variance.
    const Mean m = floor.irradiance(floor_point.x, floor_point.z, 2);
    EXPECT_LT(m.error[0], 0.012 * m.value[0]);
}

/// An image from dark at the bottom left to bright at the top right.
ImageFile gradient_image()
{
    ImageFile file{"rising.ppm", {}, {}};
    for (const char c : std::string("P6\n2 2\n255\n")) file.bytes.push_back(std::byte(c));
    for (const int gray : {100, 250, 0, 150})
        for (int c = 0; c < 3; ++c) file.bytes.push_back(std::byte(gray));
    return file;
}
/// Value of the image at coordinates from -1 to 1, right and up.
double gradient_value(double right, double up, double along)
{
    if (!(along > 0) || std::abs(right) > 1 || std::abs(up) > 1) return 0;
    const double x = std::clamp(right + 0.5, 0.0, 1.0), y = std::clamp(up + 0.5, 0.0, 1.0);
    return (150 * x + 100 * y) / 255;
}

/// Point, spot, projector and beam lights follow their moving node.
TEST(MovingLights, PointsSpotsProjectorsAndBeams)
{
    for (const NodeMotionCase& way : ways)
        for (const LightKind kind : {LightKind::point, LightKind::spot, LightKind::projector, LightKind::beam}) {
            const bool spot = kind == LightKind::spot, projector = kind == LightKind::projector,
                       beam = kind == LightKind::beam;
            SCOPED_TRACE(way.name);
            const Transform rest = Transform::translate({0.2, 1.1, 0}) * rotate_to({0.1, -1, 0.2});
            Floor floor;
            floor.samples = 512;
            floor.shutter_close = 1;
            floor.add_objects = [&](SceneBuilder& b) {
                Light light;
                light.kind = kind;
                if (projector) light.picture = {0, ColorSpace::linear, false}, light.fov = 1.6;
                light.intensity = {2, 2, 2};
                light.inner_angle = 0.2, light.outer_angle = 0.7;
                light.width = 0.9, light.height = 0.6;
                if (projector) b.scene.images.push_back(gradient_image());
                b.light(light, rest);
                // The light's parent moves, and its origin differs from the light's.
                Node arm;
                arm.motion = way.keys();
                arm.children = {b.scene.roots.back()};
                b.scene.roots.back() = int(b.scene.nodes.size());
                b.scene.nodes.push_back(arm);
            };
            double expected = 0;
            constexpr int times = 2000;
            for (int i = 0; i < times; ++i) {
                const Transform now = way.at((i + 0.5) / times) * rest;
                const Vec3d to = now.point({0, 0, 0}) - floor_point;
                const double c = -dot(normalize(now.vector({0, 0, -1})), normalize(to));
                const double x = std::clamp((c - std::cos(0.7)) / (std::cos(0.2) - std::cos(0.7)), 0.0, 1.0);
                double share = spot ? x * x : 1;
                if (projector) {
                    // Orthogonal axes of the light from the node's transform.
                    const Vec3d along = normalize(now.vector({0, 0, -1})), side = now.vector({1, 0, 0});
                    const Vec3d right = normalize(side - along * dot(side, along)), top = cross(right, along);
                    const Vec3d d = to * -1.0;
                    const double turned = dot(top, now.vector({0, 1, 0})) < 0 ? -1 : 1;
                    share = gradient_value(dot(d, right) / dot(d, along) / std::tan(0.8),
                                           turned * dot(d, top) / dot(d, along) / std::tan(0.8), dot(d, along));
                }
                if (beam) {
                    // The beam runs along the normal of its area, from the foot of the perpendicular.
                    const Vec3d u = now.vector({0.45, 0, 0}), v = now.vector({0, 0.3, 0});
                    Vec3d n = normalize(cross(u, v));
                    if (dot(n, now.vector({0, 0, -1})) < 0) n = -n;
                    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), all = uu * vv - uv * uv,
                                 right = (dot(-to, u) * vv - dot(-to, v) * uv) / all,
                                 up = (dot(-to, v) * uu - dot(-to, u) * uv) / all;
                    const bool inside = std::max(std::abs(right), std::abs(up)) < 1 && dot(-to, n) > 0;
                    expected += inside ? 2 * std::max(0.0, -n.y) / times : 0;
                    continue;
                }
                expected += 2 * share * to.y / std::pow(length(to), 3) / times;
            }
            floor.expect(floor_point.x, floor_point.z, expected, 4e-3);
        }
}

/// A spot that points up at first and to the floor at the end, beside a static light: selection probabilities account
/// for the whole shutter interval.
TEST(MovingLights, SpotsTurnTowardsTheFloor)
{
    const NodeMotionCase way{"turns over", {0, 2, 0}, 2.8, {1, 0, 0}};
    const Vec3d start{0.2, 1, 0}, in_the_end = floor_point - way.at(1).point(start);
    const Transform rest =
        Transform::translate(start) * rotate_to(Transform::rotate({1, 0, 0}, -2.8).vector(in_the_end));
    Floor floor;
    floor.samples = 1024;
    floor.shutter_close = 1;
    floor.add_objects = [&](SceneBuilder& b) {
        b.add(Sphere{{1, 1, 0}, 0.2, {}}, b.diffuse(0, {1, 1, 1}));
        Light light;
        light.kind = LightKind::spot;
        light.intensity = {2, 2, 2};
        light.inner_angle = 0.2, light.outer_angle = 0.6;
        b.light(light, rest);
        Node arm;
        arm.motion = way.keys();
        arm.children = {b.scene.roots.back()};
        b.scene.roots.back() = int(b.scene.nodes.size());
        b.scene.nodes.push_back(arm);
    };
    constexpr int times = 4000;
    const double by_ball = irradiance(ball_cells({1, 1, 0}, 0.2), {}, false, floor_point);
    double by_spot = 0;
    for (int i = 0; i < times; ++i) {
        const Transform now = way.at((i + 0.5) / times) * rest;
        const Vec3d to = now.point({0, 0, 0}) - floor_point;
        const double c = -dot(normalize(now.vector({0, 0, -1})), normalize(to));
        const double x = std::clamp((c - std::cos(0.6)) / (std::cos(0.2) - std::cos(0.6)), 0.0, 1.0);
        by_spot += 2 * x * x * to.y / std::pow(length(to), 3) / times;
    }
    EXPECT_GT(by_spot, 0.2 * by_ball);
    floor.expect(floor_point.x, floor_point.z, by_ball + by_spot, 4e-3);
}

}  // namespace
}  // namespace fathom
