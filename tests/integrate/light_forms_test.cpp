// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "floor.h"

// Tests of the illumination of a floor point by each kind of light, against its formula, at several places.
namespace fathom {
namespace {

using namespace test;

const Vec3d floor_points[] = {{0, 0, 0}, {0.7, 0, -0.3}, {-1.5, 0, 0.4}, {3, 0, 2}};

TEST(LightForms, Point)
{
    const Vec3d at{0.3, 1.6, -0.2};
    Floor floor;
    floor.add_objects = [&](SceneBuilder& b) {
        Light light;
        light.intensity = {5, 5, 5};
        b.light(light, Transform::translate(at));
    };
    for (const Vec3d& p : floor_points) {
        const Vec3d to = at - p;
        floor.expect(p.x, p.z, 5 * to.y / std::pow(length(to), 3));
    }
}

/// A perfectly smooth plastic shows no specular reflection of a point light, because no ray hits it: only the diffuse
/// base is lit.
TEST(LightForms, PointsAreInvisibleInMirrors)
{
    SceneBuilder b;
    Material m;
    m.kind = MaterialKind::plastic;
    m.roughness.value = 0;
    m.base_color.value = {0, 0, 0};
    b.add(Rectangle{{-4, 0, -4}, {0, 0, 8}, {8, 0, 0}}, b.material(m));
    b.point_light({5, 5, 5}, {0, 2, 0});
    b.camera({0, 3, 0.5}, {0, 0, 0});
    const Mean mean = mean_of(render_film(b.scene, small_image_settings(), 16));
    for (const double value : mean.value) EXPECT_EQ(value, 0);
    b.scene.materials[0].roughness.value = 0.2f;
    EXPECT_GT(mean_of(render_film(b.scene, small_image_settings(), 16)).value[0], 0.01);
}

void expect_spot(SpotFalloff falloff)
{
    const Vec3d at{0.3, 1.6, -0.2}, along = normalize(Vec3d{-0.5, -1, 0.1});
    const double inner = 0.3, outer = 0.75;
    Floor floor;
    floor.add_objects = [&](SceneBuilder& b) {
        Light light;
        light.kind = LightKind::spot;
        light.intensity = {5, 5, 5};
        light.inner_angle = inner, light.outer_angle = outer;
        light.falloff = falloff;
        b.light(light, Transform::translate(at) * rotate_to(along));
    };
    int full = 0, falling = 0, none = 0;
    for (double x : {-2.5, -1.5, -1.0, -0.5, 0.0, 0.25, 0.5, 1.5}) {
        const Vec3d to = at - Vec3d{x, 0, 0};
        const double c = dot(along, normalize(to) * -1.0);
        const double share = std::clamp((c - std::cos(outer)) / (std::cos(inner) - std::cos(outer)), 0.0, 1.0);
        const double by_solid_angle = std::clamp((outer - std::acos(std::min(c, 1.0))) / (outer - inner), 0.0, 1.0);
        const double factor = falloff == SpotFalloff::square   ? share * share
                              : falloff == SpotFalloff::smooth ? share * share * (3 - 2 * share)
                                                               : by_solid_angle;
        floor.expect(x, 0, 5 * factor * to.y / std::pow(length(to), 3), 3e-3);
        (share == 1 ? full : share == 0 ? none : falling)++;
    }
    EXPECT_GE(full, 1);
    EXPECT_GE(falling, 2);
    EXPECT_GE(none, 1);
}

TEST(SpotForms, Square)
{
    expect_spot(SpotFalloff::square);
}
TEST(SpotForms, Smooth)
{
    expect_spot(SpotFalloff::smooth);
}
TEST(SpotForms, Linear)
{
    expect_spot(SpotFalloff::linear);
}

TEST(LightForms, DirectionalAndItsDisk)
{
    for (const Vec3d& along : {Vec3d{0, -1, 0}, {1, -1, 0.5}, {-0.3, -0.6, 1}})
        // A disk entirely above the horizon gives the irradiance of its center; its radiance is scaled accordingly.
        for (double angle : {0.0, 0.1, 0.7}) {
            Floor floor;
            floor.add_objects = [&](SceneBuilder& b) {
                Light sun;
                sun.kind = LightKind::directional;
                sun.intensity = {5, 5, 5};
                sun.angle = angle;
                b.light(sun, Transform::translate({1, 2, 3}) * rotate_to(along));
            };
            floor.samples = 256;
            floor.expect(0.2, -0.1, -5 * normalize(along).y);
        }
}

/// Irradiance of a uniform polygon entirely above the floor: Lambert's sum over its edges.
double polygon(const std::vector<Vec3d>& corners, Vec3d p)
{
    Vec3d sum;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d a = normalize(corners[i] - p), b = normalize(corners[(i + 1) % corners.size()] - p);
        sum = sum + normalize(cross(a, b)) * std::acos(std::clamp(dot(a, b), -1.0, 1.0));
    }
    return std::abs(sum.y) / 2;
}

TEST(LightForms, RectanglesAndParallelograms)
{
    struct Lamp {
        Vec3d corner, u, v;
    };
    for (const Lamp& lamp : {Lamp{{-0.5, 1.2, -0.5}, {1, 0, 0}, {0, 0, 1.5}},     // a light parallel to the floor
                             {{1.2, 0.1, -0.5}, {0, 0.9, 0}, {0, 0, 1.5}},        // an upright light
                             {{-0.4, 0.8, 0.5}, {0.9, 0.4, 0}, {-0.2, 0.45, 1}},  // a slanted light
                             {{-0.5, 1.2, -0.5}, {1, 0, 0.4}, {0.3, 0.2, 1.5}}})  // edges that are not perpendicular
        for (const Vec3d& p : floor_points)
            for (const bool light_sampling : {true, false}) {
                if (!light_sampling && p.x != 0) continue;
                Floor floor;
                floor.light_sampling = light_sampling;
                floor.samples = light_sampling ? 256 : 8192;
                floor.add_objects = [&](SceneBuilder& b) {
                    b.add(Rectangle{lamp.corner, lamp.u, lamp.v}, b.diffuse(0, {3, 3, 3}, true));
                };
                floor.expect(p.x, p.z,
                             3 * polygon({lamp.corner, lamp.corner + lamp.u, lamp.corner + lamp.u + lamp.v,
                                          lamp.corner + lamp.v},
                                         p),
                             2e-3);
            }
}

TEST(LightForms, Triangles)
{
    // Its front faces down; one of the points is behind it.
    const std::vector<Vec3d> corners = {{-0.5, 1.2, -0.5}, {0.9, 0.7, 0.1}, {-0.2, 0.9, 1.3}};
    for (const bool one_sided : {false, true})
        for (const Vec3d& p : floor_points) {
            Floor floor;
            floor.samples = 256;
            floor.add_objects = [&](SceneBuilder& b) {
                Mesh mesh;
                for (const Vec3d& c : corners) mesh.positions.push_back({float(c.x), float(c.y), float(c.z)});
                mesh.indices = {0, 1, 2};  // its normal points down
                b.scene.meshes.push_back(mesh);
                b.add(MeshInstance{0}, b.diffuse(0, {3, 3, 3}, !one_sided));
            };
            const Vec3d n = cross(corners[1] - corners[0], corners[2] - corners[0]);
            const bool in_front = dot(n, p - corners[0]) > 0;
            floor.expect(p.x, p.z, in_front || !one_sided ? 3 * polygon(corners, p) : 0, 2e-3);
        }
}

/// Triangles of one mesh with very different sizes and slants: MIS uses the density of the triangle that was hit.
TEST(LightForms, TrianglesOfOneMesh)
{
    const std::vector<Vec3d> corners[] = {{{-0.5, 0.9, -0.5}, {0.9, 0.7, 0.1}, {-0.2, 0.9, 1.3}},
                                          {{1.2, 0.1, -0.8}, {1.2, 0.9, 0.6}, {1.1, 0.1, 0.8}},
                                          {{-1.2, 0.3, 0}, {-1.1, 0.35, 0.1}, {-1.2, 0.5, 0.2}}};
    for (const Vec3d& p : {floor_points[0], floor_points[1]})
        for (const bool light_sampling : {true, false}) {
            Floor floor;
            floor.light_sampling = light_sampling;
            floor.samples = light_sampling ? 1024 : 8192;
            double expected = 0;
            for (const auto& triangle : corners) expected += 3 * polygon(triangle, p);
            floor.add_objects = [&](SceneBuilder& b) {
                Mesh mesh;
                for (const auto& triangle : corners)
                    for (const Vec3d& c : triangle) {
                        mesh.indices.push_back(std::uint32_t(mesh.positions.size()));
                        mesh.positions.push_back({float(c.x), float(c.y), float(c.z)});
                    }
                b.scene.meshes.push_back(mesh);
                b.add(MeshInstance{0}, b.diffuse(0, {3, 3, 3}, true));
            };
            floor.expect(p.x, p.z, expected, 2e-3);
        }
}

/// A triangle parallel to the floor, off its axis (polygon form of Howell, B-13). Two instances, one mirrored and
/// scaled, are separate lights; a hit finds its light by instance.
TEST(LightForms, CopiesOfOneMesh)
{
    const Transform places[] = {
        Transform::translate({-0.6, 0.6, 0}) * Transform::scale({4, 1, 4}),
        Transform::translate({0.4, 0.3, 0.3}) * Transform::rotate({1, 2, 0.5}, 0.4) * Transform::scale({-0.2, 1, 0.1})};
    const Vec3d corners[] = {{-0.5, 0, -0.4}, {0.5, 0, -0.3}, {0, 0, 0.5}};
    for (const bool light_sampling : {true, false}) {
        Floor floor;
        floor.light_sampling = light_sampling;
        floor.samples = light_sampling ? 256 : 8192;
        floor.add_objects = [&](SceneBuilder& b) {
            Mesh mesh;
            for (const Vec3d& c : corners) mesh.positions.push_back({float(c.x), float(c.y), float(c.z)});
            mesh.indices = {0, 1, 2};
            b.scene.meshes.push_back(mesh);
            const int lamp = b.diffuse(0, {5, 5, 5}, true);
            for (const Transform& place : places) {
                Node node;
                node.parent_from_node = place;
                node.shapes.push_back({MeshInstance{0}, lamp, ""});
                b.scene.roots.push_back(int(b.scene.nodes.size()));
                b.scene.nodes.push_back(node);
            }
        };
        double expected = 0;
        for (const Transform& place : places)
            expected +=
                5 * polygon({place.point(corners[0]), place.point(corners[1]), place.point(corners[2])}, {0.1, 0, 0.2});
        floor.expect(0.1, 0.2, expected, light_sampling ? 2e-3 : 1e-2);
    }
}

TEST(LightForms, Disk)
{
    const double h = 1.1, r = 0.8;
    for (const bool light_sampling : {true, false}) {
        Floor floor;
        floor.light_sampling = light_sampling;
        floor.samples = light_sampling ? 1024 : 8192;
        floor.add_objects = [&](SceneBuilder& b) { b.add(Disk{{0, h, 0}, {0, -2, 0}, r}, b.diffuse(0, {3, 3, 3})); };
        for (double a : {0.0, 0.5, 1.5}) {
            if (!light_sampling && a > 0) continue;
            const double s = r * r + a * a + h * h;
            floor.expect(
                0.6 * a, 0.8 * a,
                3 * std::numbers::pi / 2 * (1 + (r * r - a * a - h * h) / std::sqrt(s * s - 4 * r * r * a * a)), 2e-3);
        }
    }
}

TEST(LightForms, Sphere)
{
    const Vec3d center{0.2, 1.3, 0.1};
    const double r = 0.7;
    for (const bool light_sampling : {true, false}) {
        Floor floor;
        floor.light_sampling = light_sampling;
        floor.samples = light_sampling ? 256 : 8192;
        floor.add_objects = [&](SceneBuilder& b) { b.add(Sphere{center, r, {}}, b.diffuse(0, {3, 3, 3})); };
        for (const Vec3d& p : floor_points) {
            if (!light_sampling && p.x != 0) continue;
            const Vec3d to = center - p;
            floor.expect(p.x, p.z, 3 * std::numbers::pi * r * r * to.y / std::pow(length(to), 3), 2e-3);
        }
    }
}

/// All kinds of lights, of different strengths, add up.
TEST(LightForms, AllKindsTogether)
{
    Floor floor;
    floor.samples = 8192;
    Light point, sun;
    point.intensity = {4, 4, 4};
    sun.kind = LightKind::directional;
    sun.intensity = {0.5f, 0.5f, 0.5f};
    floor.add_objects = [&](SceneBuilder& b) {
        b.light(point, Transform::translate({1, 2, 0}));
        b.light(sun, rotate_to({0, -1, 1}));
        b.add(Rectangle{{-1, 3, -0.5}, {1, 0, 0}, {0, 0, 1}}, b.diffuse(0, {8, 8, 8}, true));
        b.add(Sphere{{-1.5, 1.5, -1}, 0.2, {}}, b.diffuse(0, {30, 30, 30}));
    };
    const Vec3d p{0.1, 0, 0.2}, to = Vec3d{1, 2, 0} - p, ball = Vec3d{-1.5, 1.5, -1} - p;
    floor.expect(p.x, p.z,
                 4 * to.y / std::pow(length(to), 3) + 0.5 * std::sqrt(0.5) +
                     8 * polygon({{-1, 3, -0.5}, {0, 3, -0.5}, {0, 3, 0.5}, {-1, 3, 0.5}}, p) +
                     30 * std::numbers::pi * 0.04 * ball.y / std::pow(length(ball), 3),
                 2e-3);
}

/// The back of a light is dark; a mirroring transform mirrors its front as well.
TEST(LightForms, SidesOfLamps)
{
    for (const bool mirrored : {false, true})
        for (const bool upside_down : {false, true})
            for (int kind = 0; kind < 4; ++kind) {
                Floor floor;
                floor.samples = 256;
                floor.add_objects = [&](SceneBuilder& b) {
                    const int lamp = b.diffuse(0, {3, 3, 3});
                    const double up = upside_down ? 1 : -1;
                    Node node;
                    // The node mirrors along x, which maps the shape onto itself.
                    node.parent_from_node =
                        Transform::translate({0, 1, 0}) * Transform::scale({mirrored ? -1.0 : 1.0, 1, 1});
                    Shape shape;
                    shape.material = lamp;
                    if (kind == 0)
                        shape.geometry = Rectangle{{-0.5, 0, -0.5},
                                                   {up < 0 ? 1. : 0., 0, up < 0 ? 0. : 1.},
                                                   {up < 0 ? 0. : 1., 0, up < 0 ? 1. : 0.}};
                    if (kind == 1) shape.geometry = Disk{{0, 0, 0}, {0, up, 0}, 0.5};
                    if (kind == 2 || kind == 3) {
                        Mesh mesh;
                        mesh.positions = {{-0.5f, 0, -0.5f}, {0.5f, 0, -0.5f}, {0, 0, 0.5f}};
                        // The fourth vertex is off the plane, so the triangles are not joined.
                        mesh.indices =
                            up < 0 ? std::vector<std::uint32_t>{0, 1, 2} : std::vector<std::uint32_t>{0, 2, 1};
                        // Vertex normals do not determine the front side.
                        if (kind == 3) mesh.normals.assign(3, {0, 1, 0});
                        shape.geometry = MeshInstance{int(b.scene.meshes.size())};
                        b.scene.meshes.push_back(mesh);
                    }
                    node.shapes.push_back(shape);
                    b.scene.roots.push_back(int(b.scene.nodes.size()));
                    b.scene.nodes.push_back(node);
                };
                for (int way = 0; way < 4; ++way) {
                    const double e = floor.irradiance(0.1, 0.1, way).value[0];
                    if (upside_down)
                        EXPECT_EQ(e, 0) << kind << mirrored << " " << Floor::ways[way];
                    else
                        EXPECT_GT(e, 0.3) << kind << mirrored << " " << Floor::ways[way];
                }
            }
}

TEST(LightForms, ConstantAndGradientEnvironments)
{
    Floor floor;
    floor.samples = 1024;
    Environment sky;
    sky.kind = EnvironmentKind::constant;
    sky.color = {0.7f, 0.7f, 0.7f};
    floor.add_objects = [&](SceneBuilder& b) { b.scene.environment = sky; };
    floor.expect(0.3, 0.1, 0.7 * std::numbers::pi);
    // Gradient: mix by (1 + cos) / 2 of the angle to its up direction. The cosine-weighted mean over the hemisphere is
    // 2/3 of the cosine between both up directions.
    sky.kind = EnvironmentKind::gradient;
    sky.bottom = {1, 1, 1}, sky.top = {3, 3, 3};
    for (double angle : {0.0, 0.5, std::numbers::pi / 2, 2.5, std::numbers::pi}) {
        sky.world_from_environment = Transform::rotate({0, 0.2, 1}, angle);
        const double up = sky.world_from_environment.vector({0, 1, 0}).y;
        floor.expect(0.3, 0.1, std::numbers::pi * (1 + 2 * (0.5 + 0.5 * up * 2 / 3)));
    }
}

/// Direction of image coordinates by the format's documentation: the center looks along +x, the top along +y.
Vec3d direction_of(double u, double v)
{
    const double phi = 2 * std::numbers::pi * (u - 0.5), theta = std::numbers::pi * v;
    return {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
}

class ImageEnvironment : public testing::Test {
protected:
    static constexpr int width = 16, height = 8;
    ImageEnvironment()
    {
        file_ = std::filesystem::temp_directory_path() /
                (std::string("fathom-sky-") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".exr");
    }
    ~ImageEnvironment() override { std::filesystem::remove(file_); }

    /// One texel of 1, 2 and 3 times `bright` by channel, on a background of `gray`. first: replaces the first values.
    void write(int x, int y, float bright, float gray, const std::vector<float>& first = {})
    {
        Image image;
        image.width = width, image.height = height;
        image.layers.push_back({"", {"R", "G", "B"}, std::vector<float>(std::size_t(width * height * 3), gray)});
        for (int c = 0; c < 3; ++c)
            image.layers[0].pixels[std::size_t(3 * (y * width + x) + c)] += bright * float(c + 1);
        std::copy(first.begin(), first.end(), image.layers[0].pixels.begin());
        write_image(file_, image, {});
        x_ = x, y_ = y, bright_ = double(bright), grey_ = double(gray);
    }
    /// Bilinear weight of the bright texel, a tent that reaches its neighbors' centers. Rows beyond the first and last
    /// repeat them.
    double tent(double u, double v) const
    {
        const double dx = std::abs(std::remainder(u * width - 0.5 - x_, double(width)));
        const double row = std::clamp(v * height - 0.5, 0.0, height - 1.0), dy = std::abs(row - y_);
        return std::max(0.0, 1 - dx) * std::max(0.0, 1 - dy);
    }
    void use(SceneBuilder& b, const Transform& turn, Color color = {1, 1, 1}) const
    {
        b.scene.images.push_back({"sky", file_, {}});
        b.scene.environment.kind = EnvironmentKind::image;
        b.scene.environment.image = 0;
        b.scene.environment.color = color;
        b.scene.environment.world_from_environment = turn;
    }

    std::filesystem::path file_;
    int x_ = 0, y_ = 0;
    double bright_ = 0, grey_ = 0;
};

TEST_F(ImageEnvironment, AppearsInItsDirection)
{
    write(5, 2, 8, 0.25f);
    for (const Transform& turn : {Transform(), Transform::rotate({0.5, 1, -0.3}, 1.1)}) {
        for (const auto& [column, row] : {std::pair{5, 2}, {6, 2}, {5, 3}, {10, 2}, {5, 5}}) {
            SceneBuilder b;
            use(b, turn, {1, 0.5f, 2});
            b.add(Sphere{{0, 0, 0}, 1e-3, {}}, b.diffuse(0.5f));
            const Vec3d to = turn.vector(direction_of((column + 0.5) / width, (row + 0.5) / height));
            // A field of view of 0.001 degrees is a single direction.
            b.camera(to, to * 2, 1e-3);
            const Mean m = mean_of(render_film(b.scene, small_image_settings(4, 4), 4));
            const double factor[] = {1, 0.5, 2};
            for (int c = 0; c < 3; ++c) {
                const double expected = factor[c] * (0.25 + (column == 5 && row == 2 ? 8 * (c + 1) : 0));
                EXPECT_NEAR(m.value[c], expected, 2e-3 * expected) << column << " " << row << " " << c;
            }
        }
    }
}

/// Irradiance of the floor agrees with numerical integration of the image over the sky.
TEST_F(ImageEnvironment, LightsTheFloor)
{
    for (const auto& [x, y] : {std::pair{5, 2}, {0, 1}, {15, 3}, {8, 0}}) {
        write(x, y, 20, 0.1f);
        for (const Transform& turn : {Transform(), Transform::rotate({0.5, 1, -0.3}, 0.6)})
            for (const bool light_sampling : {true, false}) {
                double expected = grey_ * std::numbers::pi;
                constexpr int steps = 400;
                for (int i = 0; i < 2 * steps; ++i)
                    for (int j = 0; j < steps; ++j) {
                        const double u = (i + 0.5) / (2 * steps), v = (j + 0.5) / steps;
                        const double cosine = turn.vector(direction_of(u, v)).y;
                        if (cosine > 0)
                            expected += bright_ * tent(u, v) * cosine * std::sin(std::numbers::pi * v) * 2 *
                                        std::numbers::pi * std::numbers::pi / (2.0 * steps * steps);
                    }
                Floor floor;
                floor.light_sampling = light_sampling;
                floor.samples = light_sampling ? 1024 : 8192;
                floor.add_objects = [&](SceneBuilder& b) { use(b, turn, {1, 0.5f, 2}); };
                for (int way = 0; way < 4; ++way) {
                    const Mean m = floor.irradiance(0.3, 0.1, way);
                    const double factor[] = {1, 0.5, 2};
                    for (int c = 0; c < 3; ++c) {
                        const double e =
                            factor[c] * (grey_ * std::numbers::pi + (expected - grey_ * std::numbers::pi) * (c + 1));
                        EXPECT_NEAR(m.value[c], e, 4 * m.error[c] + 3e-3 * e)
                            << x << " " << y << " " << light_sampling << " " << Floor::ways[way] << " channel " << c;
                    }
                }
            }
    }
}

/// A sky seen through a pane and inside fog illuminates equally with NEE and without.
TEST_F(ImageEnvironment, LightsThroughTransparentSurfaces)
{
    write(5, 2, 20, 0.1f);
    Material pane;
    pane.kind = MaterialKind::glass;
    pane.ior = 1.5f;
    pane.interior.thin = true;
    Material fog = pane;
    fog.interior.thin = false;
    fog.ior = 1;
    fog.interior.attenuation_distance = 1;
    fog.interior.attenuation_color = {0.7f, 0.7f, 0.7f};
    fog.interior.scatter = {0.25f, 0.25f, 0.25f};
    for (const Material& m : {pane, fog}) {
        SceneBuilder b;
        use(b, {}, {1, 0.5f, 2});
        b.add(Rectangle{{-2, -1, -2}, {0, 0, 4}, {4, 0, 0}}, b.diffuse(0.6f));
        b.add(Box{{-1.5, -1, -1.5}, {1.5, 1, 1.5}}, b.material(m));
        b.camera({0, 0, 6}, {0, -0.3, 0}, 35);
        RenderSettings settings = small_image_settings(16, 16);
        const Mean sampled = mean_of(render_film(b.scene, settings, 1024));
        settings.light_sampling = false;
        settings.seed = 7;
        const Mean by_chance = mean_of(render_film(b.scene, settings, 16384));
        for (int c = 0; c < 3; ++c) {
            const double error = std::hypot(sampled.error[c], by_chance.error[c]);
            EXPECT_NEAR(sampled.value[c], by_chance.value[c], 4 * error) << m.interior.thin << " channel " << c;
            EXPECT_LT(error, 0.01 * by_chance.value[c]) << "the test is too noisy to detect a difference";
        }
    }
}

/// NaN in a texel would spoil the cumulative tables, so it becomes black.
TEST_F(ImageEnvironment, ValuesThatAreNoNumbersAreBlack)
{
    write(5, 2, 20, 0.1f);
    SceneBuilder good, bad;
    use(good, {});
    good.add(Rectangle{{-50, 0, 50}, {100, 0, 0}, {0, 0, -100}}, good.diffuse(0.5f));
    good.camera({0, 1, 0.1}, {0, 0, 0});
    bad = good;
    const Mean before = mean_of(render_film(good.scene, small_image_settings(4, 4), 256));
    write(5, 2, 20, 0.1f,
          {std::numeric_limits<float>::infinity(), 0.1f, 0.1f, std::numeric_limits<float>::quiet_NaN()});
    Warnings warnings;
    const RenderJob job(Scene::compile(bad.scene, "", warnings), small_image_settings(4, 4));
    Film film(job);
    render(job, {0, 256}, film);
    const Mean after = mean_of(film);
    EXPECT_NEAR(after.value[0], before.value[0], 0.05 * before.value[0]);
    const std::string message = file_.string() + ": values that are not finite are replaced by 0";
    const std::map<std::string, std::size_t> expected{{message, 2}};
    EXPECT_EQ(warnings.counts(), expected);
}

/// Importance sampling by luminance leaves almost no noise for a small bright sun in a dark sky.
TEST_F(ImageEnvironment, IsSampledWhereItIsBright)
{
    write(5, 1, 1000, 0.001f);
    Floor floor;
    floor.samples = 256;
    floor.add_objects = [&](SceneBuilder& b) { use(b, {}); };
    for (int way = 0; way < 4; ++way) {
        const Mean m = floor.irradiance(0, 0, way);
        // The bound holds for 16,384 samples with a relative variance of about 1 each.
        EXPECT_LT(m.error[0] / m.value[0], 0.015) << Floor::ways[way];
    }
}

/// A separate background is visible but does not illuminate; the environment illuminates but is not visible.
TEST(LightForms, Background)
{
    Floor floor;
    floor.add_objects = [&](SceneBuilder& b) {
        b.scene.environment.kind = EnvironmentKind::constant;
        b.scene.environment.color = {0.5f, 0.5f, 0.5f};
    };
    SceneBuilder b;
    b.add(Rectangle{{-50, 0, 50}, {100, 0, 0}, {0, 0, -100}}, b.diffuse(1));
    floor.add_objects(b);
    b.camera({0, 1, 0}, {0, 0, 0}, 10);
    RenderSettings settings = small_image_settings(8, 8);
    settings.background = Color{7, 8, 9};
    expect_mean(render_film(b.scene, settings, 256), 0.5);
    b.scene.cameras[0].look_at = {0, 3, 0};
    const Mean m = mean_of(render_film(b.scene, settings, 4));
    for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(float(m.value[c]), float(7 + c));
}

}  // namespace
}  // namespace fathom
