// SPDX-License-Identifier: Apache-2.0
/// Tests that RenderSettings::guiding changes sampling but not the expected image.
#include <numeric>

#include "picture_helpers.h"
#include "support/film_contents.h"

namespace fathom {
namespace {

using namespace test;

void add_room(SceneBuilder& b, int walls)
{
    b.add(Rectangle{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}}, walls);
    b.add(Rectangle{{-2, 3, -2}, {4, 0, 0}, {0, 0, 4}}, walls);
    b.add(Rectangle{{-2, 0, -2}, {4, 0, 0}, {0, 3, 0}}, walls);
    b.add(Rectangle{{2, 0, 2}, {-4, 0, 0}, {0, 3, 0}}, walls);
    b.add(Rectangle{{-2, 0, 2}, {0, 0, -4}, {0, 3, 0}}, walls);
    b.add(Rectangle{{2, 0, -2}, {0, 0, 4}, {0, 3, 0}}, walls);
}

/// Two chambers joined by a gap of the given width: the light is in one, the camera in the other with a sphere of the
/// material.
SceneDescription two_chambers(const Material& material, const Material& walls, double gap = 0.6)
{
    SceneBuilder b;
    const int wall = b.material(walls);
    add_room(b, wall);
    b.add(Rectangle{{0, 0, -2}, {0, 0, 4 - gap}, {0, 3, 0}}, wall);
    b.add(Rectangle{{-1.5, 2.9, -1}, {1, 0, 0}, {0, 0, 1}}, b.diffuse(0, {20, 20, 20}));
    b.add(Sphere{{1, 0.6, 0.2}, 0.6, {}}, b.material(material));
    b.camera({1.9, 1.5, -1.8}, {0.6, 0.9, 0.6}, 70);
    return b.scene;
}

Material gray(float albedo)
{
    Material m;
    m.base_color.value = {albedo, albedo, albedo};
    return m;
}

Material of_kind(MaterialKind kind, float roughness, float metallic = 0)
{
    Material m = gray(0.8f);
    m.kind = kind;
    m.roughness.value = roughness;
    m.metallic.value = metallic;
    return m;
}

RenderSettings guided(RenderSettings settings = small_image_settings())
{
    settings.guiding = true;
    return settings;
}

/// Expects that the means of two images differ by less than 4.5 standard errors of the difference.
void expect_same_mean(const Film& film, const Film& other, const std::string& what)
{
    const Mean a = mean_of(film), b = mean_of(other);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(a.value[c], b.value[c], 4.5 * std::hypot(a.error[c], b.error[c])) << what << ", channel " << c;
    // The test would detect a difference of 2 %.
    EXPECT_LT(std::hypot(a.error[0], b.error[0]), 0.02 / 4.5 * b.value[0]) << what;
}

/// Expects that guiding is active: the sums differ from those without it.
void expect_in_use(const SceneDescription& scene, const RenderSettings& settings, const std::string& what)
{
    RenderSettings plain = settings;
    plain.guiding = false;
    EXPECT_NE(test::words_of(render_film(scene, settings, 2)), test::words_of(render_film(scene, plain, 2))) << what;
}

RenderCosts costs_of(const SceneDescription& description, const RenderSettings& settings, std::uint64_t samples)
{
    Warnings warnings;
    const RenderJob job(Scene::compile(description, "", warnings), settings);
    Film film(job);
    RenderCosts costs;
    render(job, {0, samples}, film, nullptr, [&](const Progress& p, const Film&) { costs = p.costs; });
    return costs;
}

/// Fraction of path vertices at which NEE samples a light.
double nee_fraction(const SceneDescription& description, const RenderSettings& settings)
{
    const RenderCosts costs = costs_of(description, settings, 64);
    return double(costs.light_samples) / double(costs.vertices);
}

TEST(Guiding, ChangesTheNoiseOnly)
{
    Material coated = of_kind(MaterialKind::principled, 0.6f);
    coated.coat.weight.value = 1;
    struct Case {
        const char* what;
        Material material;
    };
    for (const Case& c : {Case{"diffuse", gray(0.8f)},
                          {"glossy", of_kind(MaterialKind::principled, 0.2f)},
                          {"rough metal", of_kind(MaterialKind::principled, 0.5f, 1)},
                          {"layers", coated},
                          {"glass", of_kind(MaterialKind::glass, 0)},
                          {"mirror", of_kind(MaterialKind::metal, 0)}}) {
        const SceneDescription scene = two_chambers(c.material, gray(0.7f), 1);
        expect_in_use(scene, guided(), c.what);
        expect_same_mean(render_film(scene, guided(), 1024), render_film(scene, small_image_settings(), 2048), c.what);
    }
}

TEST(Guiding, ChangesTheNoiseOnlyWhereLightsAreFoundByChance)
{
    const SceneDescription scene = two_chambers(gray(0.8f), gray(0.7f), 2);
    RenderSettings settings = small_image_settings();
    settings.light_sampling = false;
    expect_in_use(scene, guided(settings), "by chance");
    expect_same_mean(render_film(scene, guided(settings), 4096), render_film(scene, small_image_settings(), 2048),
                     "by chance");
}

/// Between glossy walls guiding gets a lower weight, and roulette uses the walls' reflectance.
TEST(Guiding, ChangesTheNoiseOnlyBetweenGlossyWalls)
{
    const SceneDescription scene = two_chambers(gray(0.8f), of_kind(MaterialKind::principled, 0.4f, 0.25f), 1);
    expect_in_use(scene, guided(), "glossy walls");
    expect_same_mean(render_film(scene, guided(), 2048), render_film(scene, small_image_settings(), 4096),
                     "glossy walls");
}

/// Two rooms joined by a hole of the given width in the ceiling. The square light, of the given edge, is in the upper
/// room, the camera in the lower.
///
/// The light is visible almost everywhere above and hardly anywhere below. Guiding cells of both rooms are neighbors
/// across the thin ceiling along y, the axis of the second random number of the position jitter.
SceneBuilder two_floors(const Material& walls, double hole, double lamp)
{
    SceneBuilder b;
    const int wall = b.material(walls);
    add_room(b, wall);
    b.add(Rectangle{{-2, 1.5, 2}, {4 - hole, 0, 0}, {0, 0, -4}}, wall);
    b.add(Rectangle{{-1.9, 2.9, -lamp / 2}, {lamp, 0, 0}, {0, 0, lamp}}, b.diffuse(0, {20, 20, 20}));
    b.add(Sphere{{-0.4, 0.5, 0.2}, 0.5, {}}, wall);
    b.camera({1.8, 1.2, -1.8}, {-0.8, 0.6, 0.8}, 70);
    return b;
}

/// NEE with a probability is unbiased: the remaining samples are weighted up, and MIS with BSDF samples that hit lights
/// is complete.
TEST(Guiding, SamplesLightsByChanceWhereTheyRarelyArrive)
{
    const SceneDescription scene = two_floors(gray(0.8f), 0.3, 1.8).scene;
    EXPECT_LT(nee_fraction(scene, guided()), 0.45);
    EXPECT_EQ(nee_fraction(scene, small_image_settings()), 1);
    expect_same_mean(render_film(scene, guided(), 4096), render_film(scene, small_image_settings(), 4096), "upstairs");
}

/// Probabilistic NEE stays unbiased if shadow rays pass a thin pane and fog, where NEE is used as well.
TEST(Guiding, SamplesLightsByChanceInFog)
{
    SceneBuilder b = two_floors(gray(0.85f), 1, 1);
    Material pane, fog;
    pane.kind = fog.kind = MaterialKind::glass;
    pane.interior.thin = true;
    b.add(Rectangle{{1, 1.5, 2}, {1, 0, 0}, {0, 0, -4}}, b.material(pane));
    fog.ior = 1;
    fog.interior.attenuation_distance = 1;
    fog.interior.attenuation_color = {0.85f, 0.85f, 0.85f};
    fog.interior.scatter = {0.15f, 0.15f, 0.15f};
    b.add(Box{{-1.9, 0.1, -1.9}, {1.7, 1.4, 1.9}}, b.material(fog));
    EXPECT_LT(nee_fraction(b.scene, guided()), 0.45);
    expect_same_mean(render_film(b.scene, guided(), 768), render_film(b.scene, small_image_settings(), 1536), "fog");
}

/// If learning finds NEE useful at most vertices, it is used at every surface.
TEST(Guiding, SamplesLightsEverywhereWhereTheyArrive)
{
    const SceneDescription scene = two_floors(gray(0.7f), 2, 2).scene;
    expect_in_use(scene, guided(), "wide hole");
    EXPECT_EQ(nee_fraction(scene, guided()), 1);
}

/// Fraction of light samples whose shadow ray is traced.
double shadow_ray_fraction(const SceneDescription& description, const RenderSettings& settings)
{
    const RenderCosts costs = costs_of(description, settings, 64);
    return double(costs.rays[std::size_t(RayKind::shadow)]) / double(costs.light_samples);
}

/// Shadow rays far from a light contribute little; roulette skips some of them and weights up the others.
TEST(Guiding, TracesShadowRaysThatAreWorthIt)
{
    const SceneDescription scene = two_floors(gray(0.7f), 2, 2).scene;
    EXPECT_LT(shadow_ray_fraction(scene, guided()), 0.88 * shadow_ray_fraction(scene, small_image_settings()));
    expect_same_mean(render_film(scene, guided(), 2048), render_film(scene, small_image_settings(), 4096), "lamp");
}

/// The room is open to the sky, which only unoccluded rays reach.
TEST(Guiding, ChangesTheNoiseOnlyBelowASky)
{
    SceneBuilder b;
    const int wall = b.material(gray(0.8f));
    b.add(Rectangle{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}}, wall);
    b.add(Rectangle{{-2, 3, -2}, {4, 0, 0}, {0, 0, 4}}, wall);
    b.add(Rectangle{{-2, 0, -2}, {4, 0, 0}, {0, 3, 0}}, wall);
    b.add(Rectangle{{2, 0, 2}, {-4, 0, 0}, {0, 3, 0}}, wall);
    b.add(Rectangle{{2, 0, -2}, {0, 0, 4}, {0, 3, 0}}, wall);
    for (int i = 0; i < 100; ++i) b.add(Sphere{{1.2, 0.01 * i, 0.2}, 0.3, {}}, wall);
    b.scene.environment.kind = EnvironmentKind::sky;
    b.scene.environment.to_sun = {-1, 1, 0.3};
    b.camera({1.9, 1.5, -1.8}, {0.6, 0.9, 0.6}, 70);
    expect_in_use(b.scene, guided(), "sky");
    expect_same_mean(render_film(b.scene, guided(), 2048), render_film(b.scene, small_image_settings(), 4096), "sky");
}

/// A closed room whose walls have emission 1 and albedo 1/2 has radiance 2 everywhere.
TEST(Guiding, KeepsTheRadianceOfAClosedRoom)
{
    SceneBuilder b;
    Material glowing = gray(0.5f);
    glowing.emission.radiance.value = {1, 1, 1};
    glowing.emission.two_sided = true;
    add_room(b, b.material(glowing));
    b.add(Sphere{{0, 1, 0}, 0.5, {}}, b.material(glowing));
    b.camera({1.9, 1.5, -1.8}, {0.6, 0.9, 0.6}, 70);
    expect_mean(render_film(b.scene, guided(), 256), 2, 0.001);
}

double mean_variance(const Film& film)
{
    const Image image = film.image(false, true);
    const std::vector<float>& v = image.find("variance")->pixels;
    return std::accumulate(v.begin(), v.end(), 0.0) / double(v.size());
}

TEST(Guiding, MakesLessNoiseNextDoor)
{
    const SceneDescription scene = two_chambers(gray(0.8f), gray(0.7f));
    EXPECT_LT(mean_variance(render_film(scene, guided(), 512)),
              0.4 * mean_variance(render_film(scene, small_image_settings(), 512)));
}

/// With a known expected contribution, roulette may start at any depth.
TEST(Guiding, EndsPathsThatBringLittle)
{
    const SceneDescription scene = two_chambers(gray(0.8f), gray(0.7f));
    const auto vertices = [&](const RenderSettings& s) { return double(costs_of(scene, s, 64).vertices); };
    RenderSettings patient = small_image_settings();
    patient.roulette_depth = 40;
    EXPECT_LT(vertices(guided(patient)), 0.25 * vertices(patient));
}

/// On dark surfaces roulette ends most paths.
TEST(Guiding, EndsPathsOnDarkSurfaces)
{
    const SceneDescription scene = two_chambers(gray(0.1f), gray(0.1f));
    const auto vertices = [&](const RenderSettings& s) { return double(costs_of(scene, s, 64).vertices); };
    expect_in_use(scene, guided(), "dark");
    EXPECT_LT(vertices(guided()), 0.55 * vertices(small_image_settings()));
}

TEST(Guiding, HasTheSameBitsForAnyThreadsPassesAndCrop)
{
    Warnings warnings;
    const Scene scene = Scene::compile(two_chambers(of_kind(MaterialKind::principled, 0.4f), gray(0.7f)), "", warnings);
    const auto words = [&](RenderSettings settings, const std::vector<SampleRange>& ranges) {
        const RenderJob job(scene, settings);
        Film film(job);
        for (const SampleRange& range : ranges) EXPECT_TRUE(render(job, range, film));
        return test::words_of(film);
    };
    RenderSettings settings = guided();
    const std::vector<std::uint32_t> all = words(settings, {{0, 8}});
    settings.threads = 1;
    EXPECT_EQ(all, words(settings, {{0, 8}}));
    settings.threads = 5;
    EXPECT_EQ(all, words(settings, {{5, 8}, {0, 5}}));
    settings.crop = Crop{4, 6, 20, 9};
    const std::vector<std::uint32_t> part = words(settings, {{0, 8}});
    const std::size_t per_pixel = all.size() / (32 * 24);
    for (std::size_t y = 6; y < 9; ++y)
        for (std::size_t i = (y * 32 + 4) * per_pixel; i < (y * 32 + 20) * per_pixel; ++i) ASSERT_EQ(all[i], part[i]);
}

/// A replayed single sample uses the guiding data of its image.
TEST(Guiding, ReplaysASample)
{
    Warnings warnings;
    const Scene scene = Scene::compile(two_chambers(gray(0.8f), gray(0.7f)), "", warnings);
    const RenderJob job(scene, guided());
    Film film(job);
    render(job, {7, 8}, film);
    const Image image = film.image(false, false);
    for (const auto& [x, y] : {std::pair{3, 4}, {16, 12}, {30, 20}}) {
        const Color c = render_sample(job, x, y, 7);
        const float* pixel = &image.layers[0].pixels[std::size_t(y * 32 + x) * 3];
        EXPECT_NEAR(pixel[0], c.r, 1e-6f + 1e-6f * c.r);
        EXPECT_NEAR(pixel[2], c.b, 1e-6f + 1e-6f * c.b);
    }
}

/// A scene in which NEE finds nearly all light, so that there is nothing to learn.
SceneDescription lamp_above()
{
    SceneBuilder b;
    b.add(Rectangle{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}}, b.diffuse(0.5f));
    b.add(Sphere{{0, 0.3, 0}, 0.3, {}}, b.diffuse(0.2f));
    b.add(Rectangle{{-0.5, 3, -0.5}, {1, 0, 0}, {0, 0, 1}}, b.diffuse(0, {9, 9, 9}));
    b.camera({0, 2, 5}, {0, 0, 0}, 40);
    return b.scene;
}

/// Guiding that does not pay off is disabled: the sums equal those without it.
TEST(Guiding, IsLeftOutWhereItWouldNotPay)
{
    const SceneDescription scene = lamp_above();
    EXPECT_EQ(test::words_of(render_film(scene, guided(), 8)),
              test::words_of(render_film(scene, small_image_settings(), 8)));
}

/// Time for learning is reported even if guiding is then disabled; without guiding it is 0.
TEST(Guiding, TellsTheTimeThatWasSpentOnLearning)
{
    const auto learning_s = [&](const SceneDescription& scene, RenderSettings settings) {
        settings.measure_stages = true;
        return costs_of(scene, settings, 1).seconds[std::size_t(RenderStage::learn)];
    };
    // Learning traces a quarter of a million paths, which takes at least a millisecond anywhere.
    EXPECT_GT(learning_s(two_chambers(gray(0.8f), gray(0.7f)), guided()), 0.001);
    EXPECT_GT(learning_s(lamp_above(), guided()), 0.001);
    EXPECT_EQ(learning_s(lamp_above(), small_image_settings()), 0);
}

/// No surface is hit, so there is nothing to learn from.
TEST(Guiding, SurvivesAnEmptyPicture)
{
    SceneBuilder b;
    b.add(Sphere{{0, 0, 9}, 0.3, {}}, b.diffuse(0.2f));
    b.camera({0, 0, 0}, {0, 0, -5}, 40);
    EXPECT_EQ(mean_of(render_film(b.scene, guided(), 2)).value[0], 0);
}

}  // namespace
}  // namespace fathom
