// SPDX-License-Identifier: Apache-2.0
// Light tracing: light that mirrors and glass send onto a floor, in closed form, and images that path tracing alone
// renders, too.
#include <atomic>
#include <functional>

#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

using std::numbers::pi;

Material conductor(float roughness, float albedo = 1)
{
    Material m;
    m.kind = MaterialKind::metal;
    m.base_color.value = {albedo, albedo, albedo};
    m.roughness.value = roughness;
    return m;
}
Material dielectric(float roughness = 0)
{
    Material m;
    m.kind = MaterialKind::glass;
    m.ior = 1.5f;
    m.roughness.value = roughness;
    return m;
}

RenderSettings traced(int width = 8, int height = 8)
{
    RenderSettings s = small_image_settings(width, height);
    s.light_paths = 1;
    return s;
}

/// Fresnel reflectance of glass of index 1.5 from outside.
double glass_reflectance(double cosine)
{
    const double inside = std::sqrt(1 - (1 - cosine * cosine) / 2.25);
    const double s = (cosine - 1.5 * inside) / (cosine + 1.5 * inside),
                 p = (inside - 1.5 * cosine) / (inside + 1.5 * cosine);
    return (s * s + p * p) / 2;
}

/// A floor of reflectance 1/2 of which an orthographic camera sees the square |x|, |z| < 1/2 from above.
struct SeenFloor : SceneBuilder {
    explicit SeenFloor(int spheres = 0, double half = 4)
    {
        add(Rectangle{{-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half}}, diffuse(0.5f));
        // Spheres below the floor select how rays are traced: by a list, or by a BVH.
        for (int i = 0; i < spheres; ++i) add(Sphere{{half * (1 - 0.02 * i), -half, 0}, 0.02, {}}, diffuse(0.5f));
        camera({0, 0.4, 0}, {0, 0, 0});
        scene.cameras[0].kind = CameraKind::orthographic;
        scene.cameras[0].height = 1;
    }
};

/// Mean irradiance of the square, from its value at points.
double mean_irradiance(const std::function<double(double, double)>& at)
{
    constexpr int n = 100;
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) sum += at((i + 0.5) / n - 0.5, (j + 0.5) / n - 0.5);
    return sum / (n * n);
}

/// Lamps without extent and a mirror at x = 1, which shows each of them again: the floor gets the light of both.
class MirroredLamps : public testing::TestWithParam<int> {
protected:
    /// Irradiance by a lamp of intensity 1 at p, times a factor by direction.
    static double by_point(Vec3d p, double x, double z, const std::function<double(Vec3d)>& factor)
    {
        const Vec3d to = Vec3d{x, 0, z} - p;
        return -to.y / std::pow(length(to), 3) * factor(normalize(to));
    }
    void expect(const Light& light, const Transform& place, double expected, std::uint64_t samples = 256)
    {
        SeenFloor b(GetParam());
        b.add(Rectangle{{1, 0, -4}, {0, 0, 8}, {0, 8, 0}}, b.material(conductor(0)));
        b.light(light, place);
        expect_mean(render_film(b.scene, traced(), samples), expected * 0.5 / pi, 0.003);
    }
};
INSTANTIATE_TEST_SUITE_P(Scenes, MirroredLamps, testing::Values(0, 1, 100), [](const auto& info) {
    return info.param == 0 ? "quads" : info.param == 1 ? "list" : "tree";
});

TEST_P(MirroredLamps, Point)
{
    const auto one = [](Vec3d) { return 1.0; };
    const double expected = mean_irradiance(
        [&](double x, double z) { return by_point({0.2, 1, 0.1}, x, z, one) + by_point({1.8, 1, 0.1}, x, z, one); });
    expect(Light{}, Transform::translate({0.2, 1, 0.1}), expected, 1024);
}

TEST_P(MirroredLamps, Spot)
{
    Light light;
    light.kind = LightKind::spot;
    light.inner_angle = 0.2, light.outer_angle = 0.9;
    const Vec3d axis = normalize(Vec3d{0.7, -1, 0});
    const double inner = std::cos(0.2), outer = std::cos(0.9);
    const auto cone = [&](Vec3d d) {
        const double f = std::clamp((dot(d, axis) - outer) / (inner - outer), 0.0, 1.0);
        return f * f;
    };
    const double expected = mean_irradiance([&](double x, double z) {
        return by_point({0.2, 1, 0.1}, x, z, cone) +
               by_point({1.8, 1, 0.1}, x, z, [&](Vec3d d) { return cone({-d.x, d.y, d.z}); });
    });
    expect(light, Transform::translate({0.2, 1, 0.1}) * rotate_to(axis), expected, 512);
}

TEST_P(MirroredLamps, DirectionalFromBothSides)
{
    Light light;
    light.kind = LightKind::directional;
    for (const double angle : {0.0, 0.02}) {
        light.angle = angle;
        // Light that falls toward the mirror arrives at the whole square twice.
        const Vec3d d = normalize(Vec3d{1, -1, 0.2});
        expect(light, rotate_to(d), -2 * d.y, 1024);
    }
}

TEST_P(MirroredLamps, Beam)
{
    Light light;
    light.kind = LightKind::beam;
    light.width = 0.3, light.height = 0.2;
    // All of the beam arrives at the square, by way of the mirror.
    const Vec3d d = normalize(Vec3d{1, -1, 0});
    expect(light, Transform::translate(Vec3d{1, 1, 0} - d * 0.5) * rotate_to(d), 0.06);
}

/// The sun through a thick pane, without the light that comes back from the floor or is reflected within the pane.
TEST(LightTracing, SunThroughAPane)
{
    for (const int spheres : {1, 100})
        for (const double angle : {0.0, 0.6}) {
            SeenFloor b(spheres, 0.6);
            b.add(Box{{-1.2, 0.5, -1.2}, {1.2, 0.6, 1.2}}, b.material(dielectric()));
            Light sun;
            sun.kind = LightKind::directional;
            b.light(sun, rotate_to({std::sin(angle), -std::cos(angle), 0}));
            RenderSettings settings = traced();
            settings.max_depth = 3;
            const double passed = std::pow(1 - glass_reflectance(std::cos(angle)), 2);
            expect_mean(render_film(b.scene, settings, 1024), std::cos(angle) * passed * 0.5 / pi, 0.01);
        }
}

/// A closed room with a lamp, as path tracing and light tracing see it.
struct Room : SceneBuilder {
    Room()
    {
        const int white = diffuse(0.7f), red = diffuse(0.4f);
        add(Rectangle{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}}, white);
        add(Rectangle{{-1, 2, -1}, {2, 0, 0}, {0, 0, 2}}, white);
        add(Rectangle{{-1, 0, -1}, {2, 0, 0}, {0, 2, 0}}, white);
        add(Rectangle{{-1, 0, 1}, {0, 0, -2}, {0, 2, 0}}, red);
        add(Rectangle{{1, 0, -1}, {0, 0, 2}, {0, 2, 0}}, red);
        camera({0, 1, 3.5}, {0, 1, 0}, 40);
    }
    /// Objects whose scattering light samples can follow.
    Room& with_rough_objects()
    {
        add(Sphere{{-0.45, 0.35, -0.3}, 0.35, {}}, material(conductor(0.4f, 0.8f)));
        add(Sphere{{0.45, 0.35, 0.2}, 0.35, {}}, material(dielectric(0.5f)));
        return *this;
    }
    Room& with_smooth_objects()
    {
        add(Sphere{{-0.45, 0.35, -0.3}, 0.35, {}}, material(conductor(0)));
        add(Sphere{{0.45, 0.35, 0.2}, 0.35, {}}, material(dielectric()));
        return *this;
    }
    Room& with_lamp(float radiance = 10)
    {
        Material m;
        m.kind = MaterialKind::none;
        m.emission.radiance.value = {radiance, radiance, radiance};
        add(Rectangle{{-0.4, 1.99, -0.4}, {0.8, 0, 0}, {0, 0, 0.8}}, material(m));
        return *this;
    }
    Room& with(const Light& l, Vec3d p = {0.1, 1.7, 0.1}, Vec3d d = {0.1, -1, -0.1})
    {
        light(l, Transform::translate(p) * rotate_to(d));
        return *this;
    }
    Room& as_tree()
    {
        for (int i = 0; i < 100; ++i) add(Sphere{{3 - 0.1 * i, -3, 0}, 0.02, {}}, 0);
        return *this;
    }
};

/// Means of the image's blocks of pixels and their variances, for one channel.
struct Block {
    double mean = 0, variance = 0;
};
std::vector<Block> blocks_of(const Film& film, int across)
{
    const Image image = film.image(false, true);
    const auto &pixels = image.layers[0].pixels, &variance = image.find("variance")->pixels;
    std::vector<Block> blocks(std::size_t(across * across));
    const double scale = double(across * across) / (image.width * image.height);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            Block& b = blocks[std::size_t(y * across / image.height * across + x * across / image.width)];
            const std::size_t i = 3 * (std::size_t(y) * std::size_t(image.width) + std::size_t(x)) + 1;
            b.mean += double(pixels[i]) * scale;
            b.variance += double(variance[i]) * scale * scale;
        }
    return blocks;
}

/// Blocks of both images agree within five standard errors.
void expect_same(const SceneDescription& scene, RenderSettings settings, std::uint64_t samples = 256)
{
    constexpr int across = 3;
    settings.light_paths = 0;
    const std::vector<Block> plain = blocks_of(render_film(scene, settings, 4 * samples), across);
    settings.light_paths = 1;
    ++settings.seed;
    const std::vector<Block> both = blocks_of(render_film(scene, settings, samples), across);
    double brightness = 0;
    for (const Block& b : plain) brightness += b.mean / double(plain.size());
    ASSERT_GT(brightness, 0);
    for (std::size_t i = 0; i < plain.size(); ++i)
        EXPECT_NEAR(both[i].mean, plain[i].mean,
                    5 * std::sqrt(both[i].variance + plain[i].variance) + 0.002 * brightness)
            << "block " << i;
}

std::vector<std::pair<const char*, Light>> lamps()
{
    std::vector<std::pair<const char*, Light>> all;
    const auto lamp = [&](const char* name, LightKind kind, float intensity) -> Light& {
        all.push_back({name, {}});
        all.back().second.kind = kind;
        all.back().second.intensity = {intensity, intensity, intensity};
        return all.back().second;
    };
    lamp("point", LightKind::point, 1);
    lamp("spot", LightKind::spot, 3);
    lamp("wide spot", LightKind::spot, 3).outer_angle = 1.3;
    lamp("linear spot", LightKind::spot, 3).falloff = SpotFalloff::linear;
    lamp("beam", LightKind::beam, 4);
    lamp("round beam", LightKind::beam, 4).round = true;
    lamp("tube", LightKind::tube, 4).radius = 0.1;
    return all;
}

TEST(LightTracing, LampsWithoutSurfaceLightTheSame)
{
    for (const auto& [name, light] : lamps()) {
        SCOPED_TRACE(name);
        expect_same(Room().with_rough_objects().with(light).scene, small_image_settings(18, 18), 512);
    }
}

TEST(LightTracing, LightFromInfinityIsTheSame)
{
    for (const bool has_size : {false, true}) {
        SceneBuilder b;
        b.add(Rectangle{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}}, b.diffuse(0.6f));
        b.add(Sphere{{0, 0.6, 0}, 0.5, {}}, b.material(conductor(0.4f)));
        b.add(Box{{0.7, 0, -0.5}, {1.2, 0.8, 0}}, b.diffuse(0.8f));
        b.camera({0, 1.5, 4}, {0, 0.5, 0});
        Light sun;
        sun.kind = LightKind::directional;
        sun.angle = has_size ? 0.2 : 0;
        b.light(sun, rotate_to({0.5, -1, -0.4}));
        if (has_size) {
            b.scene.environment.kind = EnvironmentKind::sky;
            b.scene.environment.to_sun = {0.3, 0.8, 0.3};
            b.scene.environment.sun_disk = false;
            b.scene.environment.color = {0.05f, 0.05f, 0.05f};
        }
        expect_same(b.scene, small_image_settings(18, 18), 512);
    }
}

TEST(LightTracing, SurfacesOfLampsLightTheSame)
{
    Material m;
    m.kind = MaterialKind::none;
    for (const bool two_sided : {false, true}) {
        m.emission.two_sided = two_sided;
        m.emission.radiance.value = {20, 20, 20};
        const Vec3d down{0.2, -1, 0.1};
        const std::vector<std::function<void(Room&, int)>> shapes{
            [](Room& r, int i) { r.add(Rectangle{{-0.2, 1.6, -0.2}, {0.4, 0, 0}, {0, 0.1, 0.4}}, i); },
            [&](Room& r, int i) { r.add(Disk{{0.1, 1.6, 0}, down, 0.25}, i); },
            [](Room& r, int i) { r.add(Sphere{{0.1, 1.5, 0}, 0.15, {}}, i); },
            [](Room& r, int i) {
                Mesh mesh;
                mesh.positions = {{-0.3f, 1.6f, -0.2f}, {0.3f, 1.7f, -0.2f}, {0, 1.6f, 0.3f}};
                mesh.indices = {0, 1, 2};
                r.scene.meshes.push_back(mesh);
                r.add(MeshInstance{0}, i);
            }};
        for (const auto& add : shapes) {
            SCOPED_TRACE(testing::Message() << "shape " << &add - shapes.data() << (two_sided ? ", two-sided" : ""));
            Room room;
            add(room.with_smooth_objects(), room.material(m));
            expect_same(room.scene, small_image_settings(18, 18));
            expect_same(room.as_tree().scene, small_image_settings(18, 18), 64);
        }
    }
}

TEST(LightTracing, CamerasSeeTheSame)
{
    Room room;
    Light spot;
    spot.kind = LightKind::spot;
    spot.intensity = {5, 5, 5};
    room.with_rough_objects().with(spot);
    Camera& camera = room.scene.cameras[0];
    const auto expect = [&](const char* name) {
        SCOPED_TRACE(name);
        expect_same(room.scene, small_image_settings(24, 18), 512);
    };
    camera.shift_x = 0.2, camera.shift_y = -0.1;
    expect("shifted");
    camera.aperture = 0.5, camera.focus_distance = 3;
    expect("lens");
    camera.kind = CameraKind::orthographic;
    camera.aperture = 0, camera.height = 1.6;
    expect("orthographic");
    camera.shift_x = camera.shift_y = 0;
    camera.position = {0, 1.1, 0.6};
    camera.kind = CameraKind::spherical;
    expect("spherical");
    camera.kind = CameraKind::equal_area;
    expect("equal area");
}

/// Filters spread what light tracing finds as they spread camera rays: the edges of a beam, pixel by pixel.
TEST(LightTracing, FiltersBlurEdgesTheSame)
{
    SeenFloor b;
    Light beam;
    beam.kind = LightKind::beam;
    beam.width = beam.height = 0.43;
    b.light(beam, Transform::translate({0.03, 0.3, 0.01}) * rotate_to({0, -1, 0}));
    RenderSettings settings = small_image_settings(12, 12);
    for (const Filter filter : {Filter::box, Filter::gaussian, Filter::blackman_harris, Filter::tent})
        for (const double radius : {0.0, 1.4}) {
            SCOPED_TRACE(testing::Message() << "filter " << int(filter) << ", radius " << radius);
            settings.filter = filter, settings.filter_radius = radius;
            settings.light_paths = 0;
            const Image plain = render_film(b.scene, settings, 4096).image(false, true);
            settings.light_paths = 1;
            const Image both = render_film(b.scene, settings, 512).image(false, true);
            const auto &told = plain.find("variance")->pixels, &own = both.find("variance")->pixels;
            for (std::size_t i = 0; i < told.size(); i += 3)
                EXPECT_NEAR(both.layers[0].pixels[i], plain.layers[0].pixels[i], 5 * std::sqrt(told[i] + own[i]) + 1e-4)
                    << "pixel " << i / 3;
        }
}

/// Meshes with smooth normals: shading normals differ from geometric ones, and are bent at silhouettes.
TEST(LightTracing, SmoothNormalsAreTheSame)
{
    Mesh ball = octahedron_mesh(2, [](Vec3d sign, std::uint32_t i, std::uint32_t j) {
        const Vec3d p = normalize(Vec3d{double(i), double(j), 2.0 - i - j});
        return rounded({0.5 * sign.x * p.x, 0.55 + 0.5 * sign.y * p.y, 0.5 * sign.z * p.z});
    });
    const auto out = [](const Vec3f& p) { return normalize(Vec3d{p.x, p.y - 0.55, p.z}); };
    for (const Vec3f& p : ball.positions) ball.normals.push_back(rounded(out(p)));
    // Faces are turned outwards.
    for (std::size_t i = 0; i < ball.indices.size(); i += 3) {
        const auto at = [&](std::size_t k) {
            const Vec3f& p = ball.positions[ball.indices[i + k]];
            return Vec3d{p.x, p.y, p.z};
        };
        if (dot(cross(at(1) - at(0), at(2) - at(0)), out(ball.positions[ball.indices[i]])) < 0)
            std::swap(ball.indices[i + 1], ball.indices[i + 2]);
    }
    for (const Material& m : {Material{}, conductor(0.3f), conductor(0), dielectric(0.4f), dielectric()}) {
        SCOPED_TRACE(testing::Message() << material_kind_name(m.kind) << ", roughness " << m.roughness.value);
        Room room;
        room.scene.meshes.push_back(ball);
        const int number = room.material(m);
        room.scene.nodes[0].shapes.push_back({MeshInstance{0}, number, ""});
        Material lamp;
        lamp.kind = MaterialKind::none;
        lamp.emission.radiance.value = {20, 20, 20};
        room.add(Rectangle{{-0.4, 1.99, -0.4}, {0.8, 0, 0}, {0, 0, 0.8}}, room.material(lamp));
        expect_same(room.scene, small_image_settings(18, 18), 512);
    }
}

/// Light samples and light paths pass thin panes without a bend. These panes reflect hardly anything: what panes
/// reflect of lamps without size is found by light paths only.
TEST(LightTracing, PanesPassTheSame)
{
    Material pane = dielectric();
    pane.ior = 1.02f;
    pane.interior.thin = true;
    for (std::size_t lamp : {0u, 1u, 4u, 6u}) {
        SCOPED_TRACE(lamps()[lamp].first);
        Room room;
        room.with_rough_objects().with(lamps()[lamp].second);
        const int number = room.material(pane);
        room.add(Rectangle{{-0.9, 1.2, 0.9}, {1.8, 0, 0}, {0, 0.1, -1.8}}, number);
        room.add(Rectangle{{-0.9, 0.1, 0.95}, {1.8, 0, 0}, {0, 1.8, 0}}, number);
        expect_same(room.scene, small_image_settings(18, 18), 512);
    }
}

TEST(LightTracing, FiltersAndCropsAreTheSame)
{
    const SceneDescription scene = Room().with_rough_objects().with(lamps()[1].second).scene;
    RenderSettings settings = small_image_settings(15, 12);
    for (const Filter filter : {Filter::box, Filter::gaussian, Filter::blackman_harris, Filter::tent})
        for (const double radius : {0.0, 1.3}) {
            SCOPED_TRACE(testing::Message() << "filter " << int(filter) << ", radius " << radius);
            settings.filter = filter, settings.filter_radius = radius;
            expect_same(scene, settings, 256);
        }
    // A crop has the bits of the whole image.
    settings.light_paths = 1;
    const Image whole = render_film(scene, settings, 4).image(false, false);
    settings.crop = Crop{3, 2, 11, 9};
    const Image part = render_film(scene, settings, 4).image(false, false);
    for (int y = 2; y < 9; ++y)
        for (int x = 3; x < 11; ++x)
            for (int c = 0; c < 3; ++c) {
                const std::size_t i = 3 * std::size_t(y * 15 + x) + std::size_t(c);
                EXPECT_EQ(part.layers[0].pixels[i], whole.layers[0].pixels[i]) << x << " " << y;
            }
    EXPECT_EQ(part.layers[0].pixels[0], 0);
}

TEST(LightTracing, LimitsOfDepthAreTheSame)
{
    for (const int depth : {1, 2, 3}) {
        SCOPED_TRACE(depth);
        RenderSettings settings = small_image_settings(18, 18);
        settings.max_depth = depth;
        expect_same(Room().with_rough_objects().with(lamps()[1].second).scene, settings, 512);
        expect_same(Room().with_smooth_objects().with_lamp().scene, settings, 256);
    }
}

TEST(LightTracing, MaterialsLookTheSame)
{
    const auto expect = [](const char* name, const Material& m, const std::function<void(Room&)>& change = {}) {
        SCOPED_TRACE(name);
        Room room;
        const int number = room.material(m);
        room.add(Sphere{{-0.4, 0.5, -0.3}, 0.5, {}}, number);
        room.add(Box{{0.3, 0, -0.2}, {0.8, 0.7, 0.4}}, number);
        if (change) change(room);
        room.with_lamp();
        expect_same(room.scene, small_image_settings(18, 18), 256);
    };
    Material m;
    m.kind = MaterialKind::plastic;
    expect("plastic", m);
    m.kind = MaterialKind::diffuse;
    m.roughness.value = 0.8f;
    expect("rough diffuse", m);
    m = {};
    m.kind = MaterialKind::principled;
    m.roughness.value = 0.3f;
    m.coat.weight.value = 1;
    m.sheen.color.value = {0.5f, 0.5f, 0.5f};
    expect("coat and sheen", m);
    m.coat = {};
    m.transmission.weight.value = 1;
    expect("rough transmission", m);
    m.roughness.value = 0;
    m.transmission.dispersion = 2;
    expect("dispersion", m);
    m = {};
    m.kind = MaterialKind::disney;
    m.roughness.value = 0.4f;
    m.metallic.value = 0.5f;
    expect("disney", m);
    m = dielectric();
    m.interior.attenuation_color = {0.3f, 0.5f, 0.9f};
    m.interior.attenuation_distance = 0.5;
    expect("absorbing glass", m);
    m.interior.scatter = {1, 1, 1};
    expect("cloudy glass", m);
    m = dielectric();
    m.interior.thin = true;
    expect("pane", m);
    m = {};
    m.visibility.black_back = true;
    expect("black backs", m, [](Room& room) {
        room.add(Rectangle{{-0.5, 1, 0}, {1, 0, 0}, {0, 0.5, 0.3}}, 2);
        room.add(Rectangle{{0.5, 1.2, -0.5}, {-1, 0, 0}, {0, 0.5, 0.3}}, 2);
    });
    m = {};
    m.kind = MaterialKind::mix;
    expect("mixture", m, [](Room& room) {
        Material& mixture = room.scene.materials[2];
        mixture.mixture.factor.value = 0.4f;
        mixture.mixture.material_a = 0;
        mixture.mixture.material_b = room.material(conductor(0));
    });
}

TEST(LightTracing, CamerasPassHiddenSurfaces)
{
    for (const bool hidden : {false, true}) {
        SCOPED_TRACE(hidden ? "hidden" : "culled");
        Room room;
        Material wall;
        wall.kind = MaterialKind::diffuse;
        wall.visibility.hidden_from_camera = hidden;
        wall.visibility.camera_backface_culling = !hidden;
        // A wall between the camera and the room, whose back the camera sees.
        room.add(Rectangle{{-1, 0, 1}, {0, 2, 0}, {2, 0, 0}}, room.material(wall));
        // A ball that lights the room but is not seen, or only its inside.
        room.add(Sphere{{0, 0.4, 0.5}, hidden ? 0.3 : -0.3, {}}, room.material(wall));
        room.with_rough_objects().with(lamps()[1].second);
        expect_same(room.scene, small_image_settings(18, 18), 512);
        expect_same(room.as_tree().scene, small_image_settings(18, 18), 128);
    }
}

TEST(LightTracing, MotionIsTheSame)
{
    Room room;
    room.with_rough_objects();
    room.add(Sphere{{0, 0.5, 0.5}, 0.2, Vec3d{0.3, 0.6, 0}}, room.material(conductor(0.4f)));
    Material lamp;
    lamp.kind = MaterialKind::none;
    lamp.emission.radiance.value = {20, 20, 20};
    room.add(Sphere{{-0.3, 1.6, 0}, 0.1, Vec3d{0.6, 0, 0}}, room.material(lamp));
    room.scene.cameras[0].shutter_close = 1;
    expect_same(room.scene, small_image_settings(18, 18), 512);
}

/// Lamps inside solids: light paths start in the medium around them.
TEST(LightTracing, LampsInsideMedia)
{
    Room room;
    Material m = dielectric();
    m.interior.attenuation_color = {0.2f, 0.2f, 0.2f};
    m.interior.attenuation_distance = 0.3;
    room.add(Sphere{{0, 1, 0}, 0.5, {}}, room.material(m));
    Material lamp;
    lamp.kind = MaterialKind::none;
    lamp.emission.radiance.value = {60, 60, 60};
    room.add(Sphere{{0, 1, 0}, 0.2, {}}, room.material(lamp));
    expect_same(room.scene, small_image_settings(18, 18), 512);
}

TEST(LightTracing, LessNoiseWhereItFindsCaustics)
{
    Room room;
    Material lamp;
    lamp.kind = MaterialKind::none;
    lamp.emission.radiance.value = {2000, 2000, 2000};
    room.add(Sphere{{0.3, 1.7, 0.2}, 0.03, {}}, room.material(lamp));
    room.add(Sphere{{0.3, 0.8, 0.2}, 0.4, {}}, room.material(dielectric()));
    // The camera sees the caustic on the floor, below the ball.
    room.scene.cameras[0] = {};
    room.camera({0.3, 0.35, 0.2}, {0.3, 0, 0.2});
    room.scene.nodes[0].camera = 1;
    room.scene.cameras[1].kind = CameraKind::orthographic;
    room.scene.cameras[1].height = 0.4;
    RenderSettings settings = small_image_settings(16, 16);
    const auto noise = [&] {
        double sum = 0;
        const Film film = render_film(room.scene, settings, 256);
        for (const Block& b : blocks_of(film, 1)) sum += b.variance;
        return sum;
    };
    const double without = noise();
    settings.light_paths = 1;
    EXPECT_LT(noise(), 0.3 * without);
}

/// The variance layer predicts how much images of different seeds differ.
TEST(LightTracing, VarianceIsThatOfSeeds)
{
    const SceneDescription scene = Room().with_smooth_objects().with(lamps()[1].second).scene;
    RenderSettings settings = traced(12, 12);
    constexpr int seeds = 40;
    std::vector<double> sums(144), squares(144), told(144);
    for (int s = 0; s < seeds; ++s) {
        settings.seed = std::uint32_t(s);
        const Image image = render_film(scene, settings, 16).image(false, true);
        for (std::size_t i = 0; i < sums.size(); ++i) {
            const double value = image.layers[0].pixels[3 * i];
            sums[i] += value, squares[i] += value * value;
            told[i] += double(image.find("variance")->pixels[3 * i]);
        }
    }
    double actual = 0, expected = 0;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        actual += (squares[i] - sums[i] * sums[i] / seeds) / (seeds - 1);
        expected += told[i] / seeds;
    }
    // Stratified samples vary less than told.
    EXPECT_LT(actual, 1.2 * expected);
    EXPECT_GT(actual, 0.2 * expected);
}

LightTracingTrial trial_of(const SceneDescription& description, RenderSettings settings)
{
    Warnings warnings;
    return try_light_tracing(RenderJob(Scene::compile(description, "", warnings), settings)).value();
}

/// A floor below a ball of glass and a small lamp; the camera sees the caustic only.
SceneDescription caustic_of_lamp(double radius)
{
    SeenFloor b(100, 1);
    b.add(Sphere{{0, 0.9, 0}, 0.4, {}}, b.material(dielectric()));
    Material lamp;
    lamp.kind = MaterialKind::none;
    const float radiance = float(1 / (radius * radius));
    lamp.emission.radiance.value = {radiance, radiance, radiance};
    b.add(Sphere{{0.1, 2, 0.1}, radius, {}}, b.material(lamp));
    return b.scene;
}

TEST(LightTracing, TrialUsesItForCaustics)
{
    const RenderSettings settings = small_image_settings(60, 60);
    // A lamp without size lights the whole picture through the ball.
    const LightTracingTrial spot = trial_of(Room().with_smooth_objects().with(lamps()[1].second).scene, settings);
    EXPECT_GT(spot.light_paths, 0);
    EXPECT_GT(spot.missing_light, 0.01);
    const LightTracingTrial small = trial_of(caustic_of_lamp(0.03), settings);
    EXPECT_GT(small.light_paths, 0);
    EXPECT_GT(small.gain, 10);
    EXPECT_EQ(small.missing_light, 0);
    // Nothing is gained where light samples find everything.
    const LightTracingTrial room = trial_of(Room().with_rough_objects().with_lamp().scene, settings);
    EXPECT_EQ(room.light_paths, 0);
    EXPECT_EQ(room.gain, 1);
    RenderSettings without = settings;
    without.light_sampling = false;
    EXPECT_EQ(trial_of(caustic_of_lamp(0.03), without).light_paths, 0);
}

/// The gain that a trial tells is that of images: variance times rays.
TEST(LightTracing, TrialTellsTheGain)
{
    for (const double radius : {0.05, 0.1}) {
        const SceneDescription scene = caustic_of_lamp(radius);
        RenderSettings settings = small_image_settings(60, 60);
        const LightTracingTrial trial = trial_of(scene, settings);
        ASSERT_GT(trial.light_paths, 0);
        settings.light_paths = 1;
        const Image bright = render_film(scene, settings, 256).image(false, false);
        const auto noise = [&](double light_paths) {
            settings.light_paths = light_paths;
            const Image image = render_film(scene, settings, 256).image(false, true);
            double sum = 0;
            for (std::size_t i = 0; i < bright.layers[0].pixels.size(); ++i) {
                const double pixel = bright.layers[0].pixels[i];
                sum += double(image.find("variance")->pixels[i]) / (pixel * pixel + 1e-4);
            }
            return sum;
        };
        const double fewer = noise(0) / noise(trial.light_paths);
        // The trial divides the ratio of variances by that of times, at most four times as long per light path and
        // pixel.
        EXPECT_LT(trial.gain, 2 * fewer) << radius << " " << fewer;
        EXPECT_GT(trial.gain, fewer / (2 * (1 + 4 * trial.light_paths))) << radius;
    }
}

TEST(LightTracing, TrialDoesNotDependOnThreads)
{
    RenderSettings settings = small_image_settings(60, 40);
    settings.threads = 1;
    const LightTracingTrial one = trial_of(caustic_of_lamp(0.1), settings);
    settings.threads = 3;
    const LightTracingTrial three = trial_of(caustic_of_lamp(0.1), settings);
    EXPECT_EQ(one.gain, three.gain);
    EXPECT_EQ(one.light_paths, three.light_paths);
    std::atomic<bool> cancel = true;
    Warnings warnings;
    EXPECT_FALSE(try_light_tracing(RenderJob(Scene::compile(caustic_of_lamp(0.1), "", warnings), settings), &cancel));
}

TEST(LightTracing, BitsDoNotDependOnThreadsAndParts)
{
    Warnings warnings;
    const SceneDescription description = Room().with_smooth_objects().with(lamps()[1].second).scene;
    const Scene scene = Scene::compile(description, "", warnings);
    RenderSettings settings = traced(20, 15);
    const auto part = [&](int threads, SampleRange range) {
        settings.threads = threads;
        const RenderJob job(scene, settings);
        Film film(job);
        EXPECT_TRUE(render(job, range, film));
        return film;
    };
    const Image whole = part(1, {0, 12}).image(false, true);
    const Image threaded = part(3, {0, 12}).image(false, true);
    Film merged = part(2, {5, 12});
    merged.merge(part(1, {0, 5}));
    const Image joined = merged.image(false, true);
    for (std::size_t l = 0; l < whole.layers.size(); ++l) {
        EXPECT_EQ(whole.layers[l].pixels, threaded.layers[l].pixels);
        EXPECT_EQ(whole.layers[l].pixels, joined.layers[l].pixels);
    }
}

}  // namespace
}  // namespace fathom
