// SPDX-License-Identifier: Apache-2.0
// Tests of light tracing against images that path tracing alone renders.
#include <functional>

#include "light_tracing_scenes.h"

namespace fathom {
namespace {

using namespace test;

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

/// A medium around the camera scatters paths before they meet any surface.
TEST(LightTracing, CameraInFog)
{
    Room b;
    b.with_smooth_objects().with_lamp();
    Material fog;
    fog.kind = MaterialKind::glass;
    fog.ior = 1;
    fog.interior.attenuation_distance = 2;
    fog.interior.attenuation_color = {0.5f, 0.5f, 0.5f};
    fog.interior.scatter = {0.3f, 0.3f, 0.3f};
    b.add(Box{{-3, -1, -3}, {3, 3, 5}}, b.material(fog));
    expect_same(b.scene, small_image_settings(18, 18), 512);
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

/// Pixels of both images agree within five standard errors.
void expect_same_pixels(const SceneDescription& scene, RenderSettings settings)
{
    settings.light_paths = 0;
    const Image plain = render_film(scene, settings, 4096).image(false, true);
    settings.light_paths = 1;
    const Image both = render_film(scene, settings, 512).image(false, true);
    const auto &told = plain.find("variance")->pixels, &own = both.find("variance")->pixels;
    for (std::size_t i = 0; i < told.size(); i += 3)
        EXPECT_NEAR(both.layers[0].pixels[i], plain.layers[0].pixels[i], 5 * std::sqrt(told[i] + own[i]) + 1e-4)
            << "pixel " << i / 3;
}

/// A beam with sharp edges on a floor.
SeenFloor lit_by_beam()
{
    SeenFloor b;
    Light beam;
    beam.kind = LightKind::beam;
    beam.width = beam.height = 0.43;
    b.light(beam, Transform::translate({0.03, 0.3, 0.01}) * rotate_to({0, -1, 0}));
    return b;
}

/// Filters spread what light tracing finds as they spread camera rays.
TEST(LightTracing, FiltersBlurEdgesTheSame)
{
    RenderSettings settings = small_image_settings(12, 12);
    for (const Filter filter : {Filter::box, Filter::gaussian, Filter::blackman_harris, Filter::tent})
        for (const double radius : {0.0, 1.4}) {
            SCOPED_TRACE(testing::Message() << "filter " << int(filter) << ", radius " << radius);
            settings.filter = filter, settings.filter_radius = radius;
            expect_same_pixels(lit_by_beam().scene, settings);
        }
}

TEST(LightTracing, LensesBlurEdgesTheSame)
{
    SeenFloor b = lit_by_beam();
    Camera& camera = b.scene.cameras[0];
    camera.kind = CameraKind::perspective;
    camera.position = {0.1, 0.8, 0.05};
    camera.aperture = 0.2;
    for (const double focus : {0.5, 0.8, 1.6}) {
        SCOPED_TRACE(focus);
        camera.focus_distance = focus;
        expect_same_pixels(b.scene, small_image_settings(16, 12));
    }
}

/// Adds a mirror at x = 0.8 whose shading normals are tilted upwards from its geometric normal, (-1, 0, 0).
void add_tilted_mirror(SceneBuilder& b, double degrees, const Material& material)
{
    Mesh mirror;
    mirror.positions = {{0.8f, 0, -1}, {0.8f, 0, 1}, {0.8f, 2, 1}, {0.8f, 2, -1}};
    const double a = degrees * std::numbers::pi / 180;
    mirror.normals.assign(4, rounded({-std::cos(a), std::sin(a), 0}));
    mirror.indices = {0, 1, 2, 0, 2, 3};
    b.scene.meshes.push_back(mirror);
    b.add(MeshInstance{0}, b.material(material));
}
TEST(LightTracing, TiltedNormalsAreTheSame)
{
    for (const double tilt : {-50., -20., 20., 50.})
        for (const float roughness : {0.f, 0.3f}) {
            SCOPED_TRACE(testing::Message() << tilt << " degrees, roughness " << roughness);
            SeenFloor b(100, 1);
            add_tilted_mirror(b, tilt, conductor(roughness));
            b.add(Sphere{{-0.2, 0.9, 0}, 0.12, {}}, b.material(lamp_of(10)));
            expect_same(b.scene, small_image_settings(9, 9), 2048);
        }
}

/// Seen from the floor, tilted normals mirror light to below the surface, so they are bent. What they then show is a
/// lamp above the mirror, which lights the visible floor by way of the mirror only.
TEST(LightTracing, BentNormalsAreTheSame)
{
    for (const double tilt : {35., 50.}) {
        SCOPED_TRACE(tilt);
        SeenFloor b(100, 1);
        add_tilted_mirror(b, tilt, conductor(0));
        b.add(Rectangle{{0.72, 2.1, -3}, {-6, 0, 0}, {0, 0, 6}}, b.diffuse(0));
        b.add(Sphere{{0.76, 2.5, 0}, 0.15, {}}, b.material(lamp_of(100)));
        expect_same(b.scene, small_image_settings(9, 9), 2048);
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
        const Material lamp = lamp_of(20);
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
    const Material lamp = lamp_of(20);
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
    const Material lamp = lamp_of(60);
    room.add(Sphere{{0, 1, 0}, 0.2, {}}, room.material(lamp));
    expect_same(room.scene, small_image_settings(18, 18), 512);
}

TEST(LightTracing, LessNoiseWhereItFindsCaustics)
{
    Room room;
    const Material lamp = lamp_of(2000);
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

/// A small ball of glass far from its light, so that light paths are aimed at it, looks the same with light paths and
/// without: lamps with a size, whose caustics path tracing finds, too.
TEST(LightTracing, AimedPathsBringTheSame)
{
    for (const int spheres : {0, 100})
        for (const bool has_sun : {false, true}) {
            SeenFloor b(spheres, 3);
            b.add(Sphere{{0.1, 0.2, 0.1}, 0.15, {}}, b.material(dielectric(0.2f)));
            Light sun;
            sun.kind = LightKind::directional;
            sun.angle = 0.5;
            if (has_sun)
                b.light(sun, rotate_to({0.3, -1, 0.2}));
            else
                b.add(Sphere{{0.8, 1.6, 0.5}, 0.3, {}}, b.material(lamp_of(10)));
            expect_same(b.scene, small_image_settings(12, 12), 2048);
        }
}

}  // namespace
}  // namespace fathom
