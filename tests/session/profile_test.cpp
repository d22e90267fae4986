// SPDX-License-Identifier: Apache-2.0
#include "fathom/profile.h"

#include <atomic>
#include <numeric>

#include "fathom/error.h"
#include "integrate/light_tracing_scenes.h"
#include "support/error_message.h"

namespace fathom {
namespace {

using namespace test;

RenderProfile profile_of(const SceneDescription& scene, const RenderSettings& settings, int set_samples = 4)
{
    Warnings warnings;
    return profile_render(RenderJob(Scene::compile(scene, "", warnings), settings), scene_objects(scene), set_samples)
        .value();
}

std::vector<const std::vector<ProfileRow>*> tables(const RenderProfile& p)
{
    return {&p.lights, &p.materials, &p.objects, &p.paths, &p.depths};
}

const ProfileRow* find(const std::vector<ProfileRow>& rows, ProfileCause cause, int index)
{
    for (const ProfileRow& row : rows)
        if (row.cause == cause && row.index == index) return &row;
    return nullptr;
}
const ProfileRow* find_path(const RenderProfile& p, const std::string& path, bool is_sampled)
{
    for (const ProfileRow& row : p.paths)
        if (row.path == path && row.is_sampled == is_sampled) return &row;
    return nullptr;
}

/// A room with everything that contributions come from: lamps with and without a surface, an open medium, solid glass
/// with an absorbing inside, subsurface scattering, a pane, a mixture, and the environment.
SceneDescription full_room(bool as_tree)
{
    Room b;
    b.with_rough_objects().with_smooth_objects().with_lamp().with(lamps()[0].second);
    Material fog;
    fog.kind = MaterialKind::glass;
    fog.ior = 1;
    fog.interior.scatter = {1, 1, 1}, fog.interior.attenuation_distance = 0.5f;
    b.add(Sphere{{0, 1.2, 0}, 0.3, {}}, b.material(fog));
    Material pane = dielectric();
    pane.interior.thin = true;
    b.add(Rectangle{{-0.5, 0.5, 0.8}, {1, 0, 0}, {0, 1, 0}}, b.material(pane));
    Material mix;
    mix.kind = MaterialKind::mix;
    mix.mixture.material_a = 0, mix.mixture.material_b = 1;
    b.add(Sphere{{0, 0.2, 0.5}, 0.2, {}}, b.material(mix));
    b.scene.environment = uniform_sky({0.1f, 0.2f, 0.3f});
    if (as_tree) b.as_tree();
    return b.scene;
}

/// The contributions add up to the image: that of plain renders with the seeds of the sets.
void expect_light_of_images(const SceneDescription& scene, RenderSettings settings)
{
    const int samples = 4;
    const RenderProfile p = profile_of(scene, settings, samples);
    Warnings warnings;
    const Scene compiled = Scene::compile(scene, "", warnings);
    std::vector<double> mean(p.image.size());
    for (int set = 0; set < profile_sets; ++set, ++settings.seed) {
        const RenderJob job(compiled, settings);
        Film film(job);
        render(job, {0, samples}, film);
        const Image image = film.beauty(false);
        for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += double(image.layers[0].pixels[i]) / profile_sets;
    }
    for (std::size_t i = 0; i < mean.size(); ++i) ASSERT_NEAR(double(p.image[i]), mean[i], 1e-5 * (1 + mean[i])) << i;
    double noise_of_combinations = 0;
    for (const ProfileRow& row : p.combinations) noise_of_combinations += row.noise;
    EXPECT_NEAR(noise_of_combinations, 1, 1e-6);
    for (const auto* table : tables(p)) {
        double noise = 0, light = 0, time = 0;
        std::uint64_t rays = 0;
        for (const ProfileRow& row : *table) noise += row.noise, light += row.light, time += row.time, rays += row.rays;
        EXPECT_NEAR(noise, 1, 1e-6);
        EXPECT_NEAR(light, 1, 1e-6);
        EXPECT_NEAR(time, 1, 1e-6);
        EXPECT_EQ(rays, p.rays);
    }
}

TEST(Profile, LightOfCausesAddsUpToTheImage)
{
    const RenderSettings settings = small_image_settings(24, 24);
    expect_light_of_images(full_room(false), settings);
    expect_light_of_images(full_room(true), settings);
    RenderSettings clamped = settings;
    clamped.clamp_indirect = 0.5f;
    clamped.max_depth = 3;
    expect_light_of_images(full_room(true), clamped);
}

/// Rays are those that the renderer counts.
TEST(Profile, CountsTheRaysOfTheRender)
{
    const RenderSettings settings = small_image_settings(24, 24);
    for (const bool as_tree : {false, true}) {
        const SceneDescription scene = full_room(as_tree);
        const RenderProfile p = profile_of(scene, settings, 2);
        Warnings warnings;
        const Scene compiled = Scene::compile(scene, "", warnings);
        RenderCosts costs;
        for (std::uint32_t set = 0; set < std::uint32_t(profile_sets); ++set) {
            RenderSettings own = settings;
            own.seed += set;
            const RenderJob job(compiled, own);
            Film film(job);
            render(job, {0, 2}, film, nullptr, [&](const Progress& now, const Film&) { costs += now.costs; });
        }
        std::uint64_t shadow_rays = 0;
        for (const ProfileRow& row : p.depths) shadow_rays += row.shadow_rays;
        EXPECT_EQ(p.rays, costs.all_rays());
        EXPECT_EQ(shadow_rays, costs.rays[std::size_t(RayKind::shadow)]);
    }
}

TEST(Profile, IsTheSameForAnyNumberOfThreads)
{
    RenderSettings settings = small_image_settings(70, 40);
    settings.threads = 1;
    const RenderProfile one = profile_of(full_room(true), settings, 1);
    settings.threads = 3;
    const RenderProfile three = profile_of(full_room(true), settings, 1);
    EXPECT_EQ(one.error, three.error);
    EXPECT_EQ(one.image, three.image);
    EXPECT_EQ(one.pixel_error, three.pixel_error);
    for (std::size_t t = 0; t < 5; ++t) {
        const auto &a = *tables(one)[t], &b = *tables(three)[t];
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t i = 0; i < a.size(); ++i) {
            EXPECT_EQ(a[i].path, b[i].path);
            EXPECT_EQ(a[i].index, b[i].index);
            EXPECT_EQ(a[i].noise, b[i].noise);
            EXPECT_EQ(a[i].noise_error, b[i].noise_error);
            EXPECT_EQ(a[i].light, b[i].light);
            EXPECT_EQ(a[i].rays, b[i].rays);
        }
    }
}

/// Under two point lights of equal light, chosen one at a time, the variance is known: with probabilities of 1/2 each,
/// a sample is 2 a or 2 b, and the covariance of a light's part with the whole is a (a - b) and b (b - a) plus a b.
TEST(Profile, SharesOfTwoLightsAreExact)
{
    SceneBuilder b;
    b.add(Rectangle{{-50, 0, 50}, {100, 0, 0}, {0, 0, -100}}, b.diffuse(0.5f));
    b.add(Sphere{{40, -3, 0}, 0.02, {}}, b.diffuse(0.5f));
    // Lights at one place with intensities of 3 : 1, selected uniformly: samples are 6 or 2 halves.
    b.point_light({3, 3, 3}, {0, 1, 0});
    b.point_light({1, 1, 1}, {0, 1, 0});
    b.camera({0, 0.02, 0}, {0, 0, 0});
    b.scene.cameras[0].kind = CameraKind::orthographic;
    b.scene.cameras[0].height = 1e-3;
    RenderSettings settings = small_image_settings(64, 64);
    settings.light_selection = LightSelection::uniform;
    settings.max_depth = 1;
    // One sample per set: sets are independent, so the variance is that of independent samples. Parts X = 6 or 0 and
    // Y = 0 or 2 have Var(X) = 9, Var(Y) = 1, Cov(X, Y) = -3, and the whole a variance of 4.
    const RenderProfile p = profile_of(b.scene, settings, 1);
    const ProfileRow *strong = find(p.lights, ProfileCause::light, 0), *weak = find(p.lights, ProfileCause::light, 1);
    ASSERT_TRUE(strong && weak);
    EXPECT_NEAR(strong->noise, 1.5, 0.02);
    EXPECT_NEAR(weak->noise, -0.5, 0.02);
    EXPECT_NEAR(strong->light, 0.75, 0.01);
    EXPECT_GT(strong->noise_error, 0);
    EXPECT_LT(strong->noise_error, 0.02);
    EXPECT_EQ(p.lights[0].index, 0);
    ASSERT_TRUE(find_path(p, "EDL", true));
    EXPECT_NEAR(find_path(p, "EDL", true)->light, 1, 1e-6);
    EXPECT_NEAR(find(p.depths, ProfileCause::depth, 1)->light, 1, 1e-6);
    // The relative variance of a sample is 4 / 16; 8 samples have an eighth.
    EXPECT_NEAR(p.error, std::sqrt(0.25 / 8), 0.1 * std::sqrt(0.25 / 8));
}

/// A glass shade around a small lamp: the floor is lit by caustics, which rays find by chance.
TEST(Profile, NamesTheGlassShade)
{
    SeenFloor b(100, 1);
    Material glass = dielectric();
    glass.name = "shade";
    b.add(Sphere{{0, 0.9, 0}, 0.4, {}}, b.material(glass));
    b.add(Sphere{{0, 0.9, 0}, 0.1, {}}, b.material(lamp_of(100)));
    const RenderProfile p = profile_of(b.scene, small_image_settings(32, 32), 8);
    const ProfileRow& first = p.materials.front();
    ASSERT_EQ(first.cause, ProfileCause::material);
    EXPECT_EQ(b.scene.materials[std::size_t(first.index)].name, "shade");
    EXPECT_GT(first.noise, 0.9);
    EXPECT_EQ(p.paths.front().path, "EDTL");
    EXPECT_FALSE(p.paths.front().is_sampled);
    EXPECT_EQ(find_path(p, "EDTL", true), nullptr);
    const ProfileRow& cause = p.combinations.front();
    EXPECT_EQ(cause.path, "EDTL");
    EXPECT_EQ(cause.light_cause, ProfileCause::emitter);
    EXPECT_EQ(cause.place_cause, ProfileCause::material);
    EXPECT_EQ(cause.place_index, first.index);
}

TEST(Profile, KindsOfScattering)
{
    const auto has = [](const Material& m, const std::string& path, bool is_sampled) {
        SeenFloor b(100, 4);
        b.scene.nodes[0].shapes[0].material = b.material(m);
        b.add(Sphere{{0, 3, 0}, 1, {}}, b.material(lamp_of(1)));
        const RenderProfile p = profile_of(b.scene, small_image_settings(16, 16), 4);
        return find_path(p, path, is_sampled) != nullptr;
    };
    EXPECT_TRUE(has(conductor(0), "ESL", false));
    EXPECT_FALSE(has(conductor(0), "EGL", false));
    EXPECT_TRUE(has(conductor(0.3f), "EGL", true));
    EXPECT_TRUE(has(conductor(0.3f), "EGL", false));
    EXPECT_FALSE(has(conductor(0.3f), "EDL", true));
    Material diffuse;
    EXPECT_TRUE(has(diffuse, "EDL", true));
    EXPECT_FALSE(has(diffuse, "EGL", true));
    Material plastic;
    plastic.kind = MaterialKind::plastic;
    plastic.roughness.value = 0.2f;
    EXPECT_TRUE(has(plastic, "EDL", true));
    EXPECT_TRUE(has(plastic, "EGL", true));
}

/// Light in fog belongs to the material of the fog, whose inside has no object.
TEST(Profile, LightInMediaBelongsToTheirMaterial)
{
    SceneBuilder b;
    Material fog = dielectric();
    fog.ior = 1;
    fog.interior.scatter = {1, 1, 1}, fog.interior.attenuation_distance = 1;
    b.add(Sphere{{0, 0, 0}, 1, {}}, b.material(fog));
    for (int i = 0; i < 100; ++i) b.add(Sphere{{3 - 0.1 * i, -9, 0}, 0.02, {}}, b.diffuse(0.5f));
    b.point_light({3, 3, 3}, {0, 3, 0});
    b.camera({0, 0, 5}, {0, 0, 0}, 20);
    const RenderProfile p = profile_of(b.scene, small_image_settings(16, 16), 4);
    ASSERT_TRUE(find_path(p, "EVL", true));
    const ProfileRow* const row = find(p.materials, ProfileCause::material, 0);
    ASSERT_TRUE(row);
    EXPECT_NEAR(row->light, 1, 1e-6);
    EXPECT_NEAR(find(p.objects, ProfileCause::medium, -1)->light, 1, 1e-6);
    EXPECT_NEAR(find(p.lights, ProfileCause::light, 0)->light, 1, 1e-6);
}

/// Emission that rays of the floor meet behind a pane belongs to the floor; the pane keeps its work.
TEST(Profile, PanesDoNotCountAsPlaces)
{
    SeenFloor b(100, 4);
    Material pane = dielectric();
    pane.interior.thin = true;
    b.add(Rectangle{{-4, 0.2, 4}, {8, 0, 0}, {0, 0, -8}}, b.material(pane));
    b.add(Sphere{{0, 2, 0}, 0.7, {}}, b.material(lamp_of(5)));
    b.scene.cameras[0].position = {0, 0.1, 0};
    RenderSettings settings = small_image_settings(16, 16);
    settings.light_sampling = false;
    const RenderProfile p = profile_of(b.scene, settings, 16);
    const ProfileRow *floor = find(p.materials, ProfileCause::material, 0),
                     *glass = find(p.materials, ProfileCause::material, b.scene.nodes[0].shapes[101].material);
    ASSERT_TRUE(floor && glass);
    ASSERT_TRUE(find_path(p, "EDL", false));
    // The rest is light that the pane reflects back to the floor.
    EXPECT_GT(find_path(p, "EDL", false)->light, 0.9);
    EXPECT_GT(floor->light, 0.9);
    EXPECT_GT(glass->rays, 0u);
}

/// Light on a mixture belongs to the material that was chosen.
TEST(Profile, MixturesCountAsTheirConstituents)
{
    SeenFloor b(0, 4);
    Material mix;
    mix.kind = MaterialKind::mix;
    mix.mixture.material_a = b.diffuse(0.3f), mix.mixture.material_b = b.diffuse(0.6f);
    b.scene.nodes[0].shapes[0].material = b.material(mix);
    b.point_light({3, 3, 3}, {0, 3, 0});
    const RenderProfile p = profile_of(b.scene, small_image_settings(16, 16), 8);
    const ProfileRow *dark = find(p.materials, ProfileCause::material, mix.mixture.material_a),
                     *bright = find(p.materials, ProfileCause::material, mix.mixture.material_b);
    ASSERT_TRUE(dark && bright);
    EXPECT_NEAR(dark->light, 1.0 / 3, 0.01);
    EXPECT_NEAR(bright->light, 2.0 / 3, 0.01);
}

/// Lights are numbered by kind in the compiled scene, and as in the description in the profile.
TEST(Profile, LightsHaveTheirIndexInTheDescription)
{
    SeenFloor b(1, 4);
    Light sun, bulb;
    sun.kind = LightKind::directional, sun.intensity = {2, 2, 2};
    bulb.intensity = {1, 1, 1};
    b.light(sun, rotate_to({0, -1, 0}));
    b.light(bulb, Transform::translate({0, 1, 0}));
    b.light(bulb, Transform::translate({0, 1, 0}));
    b.scene.environment.kind = EnvironmentKind::sky;
    b.scene.environment.color = {0.1f, 0.1f, 0.1f};
    b.scene.lights[2].intensity = {3, 3, 3};
    const RenderProfile p = profile_of(b.scene, small_image_settings(16, 16), 16);
    const ProfileRow *far = find(p.lights, ProfileCause::light, 0), *weak = find(p.lights, ProfileCause::light, 1),
                     *strong = find(p.lights, ProfileCause::light, 2),
                     *sky = find(p.lights, ProfileCause::environment, -1);
    ASSERT_TRUE(far && weak && strong && sky);
    EXPECT_NEAR(strong->light / weak->light, 3, 0.3);
    EXPECT_GT(far->light, 0);
    EXPECT_GT(sky->light, 0);
    EXPECT_GT(sky->shadow_rays, 0u);
    EXPECT_EQ(p.lights.size(), 5u);
}

TEST(Profile, ChecksSamplesAndCancels)
{
    const SceneDescription scene = Room().with_lamp().scene;
    Warnings warnings;
    const RenderJob job(Scene::compile(scene, "", warnings), small_image_settings(8, 8));
    EXPECT_EQ(error_message([&] { profile_render(job, {}, 0); }), "a profile has 1 to 128 samples per set, not 0");
    EXPECT_EQ(error_message([&] { profile_render(job, {}, 129); }), "a profile has 1 to 128 samples per set, not 129");
    const std::atomic<bool> cancel = true;
    EXPECT_FALSE(profile_render(job, scene_objects(scene), 1, &cancel));
}

/// Scenes of quads, whose own loop keeps no records, are profiled by the general loop.
TEST(Profile, ProfilesScenesOfQuads)
{
    SceneDescription scene = Room().with_lamp().scene;
    RenderSettings settings = small_image_settings(16, 16);
    settings.crop = Crop{2, 3, 12, 9};
    const RenderProfile p = profile_of(scene, settings);
    EXPECT_EQ(p.width, 10);
    EXPECT_EQ(p.height, 6);
    EXPECT_GT(p.error, 0);
    ASSERT_FALSE(p.lights.empty());
    EXPECT_TRUE(find(p.lights, ProfileCause::emitter, 0));
}

}  // namespace
}  // namespace fathom
