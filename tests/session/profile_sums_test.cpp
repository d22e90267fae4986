// SPDX-License-Identifier: Apache-2.0
#include "session/profile_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace fathom {
namespace {

constexpr std::size_t sets = std::size_t(profile_sets);

/// Two lights of the description, objects of two shapes and one, and a mesh light of the second object.
struct Tables {
    SceneTables tables;
    std::vector<SceneObject> objects;

    Tables()
    {
        tables.lights.resize(4);
        tables.lights[0].primitive = 0;
        tables.described_lights = {7, 5, no_index};
        tables.shape_of_primitive = {0};
        tables.shapes.resize(1);
        tables.shapes[0].object_id = 2;
        objects.resize(2);
        objects[1].first_shape = 2;
    }
    ProfileNames names() const { return {tables, objects}; }
};

PathContribution contribution(std::uint32_t path, std::uint32_t light, std::uint32_t material, float value)
{
    PathContribution c;
    c.path = path, c.is_sampled = true, c.light = light;
    c.place = {material, 0, 1, append_event(0, PathEvent::diffuse)};
    c.value[0] = c.value[1] = c.value[2] = value;
    return c;
}

TEST(ProfileSums, WordsKeepTheFirstAndTheLastEvents)
{
    PathWord word = 0;
    for (const PathEvent event : {PathEvent::diffuse, PathEvent::mirror, PathEvent::mirror, PathEvent::refraction})
        word = append_event(word, event);
    EXPECT_EQ(word, 0x1334u);
    word = append_event(word, PathEvent::volume);
    EXPECT_EQ(word, path_word_gap | 0x1346u);
    EXPECT_EQ(append_event(word, PathEvent::glossy), path_word_gap | 0x1362u);
}

TEST(ProfileSums, NamesLightsAndPlaces)
{
    const Tables t;
    const ProfileNames names = t.names();
    using Cause = ProfileCause;
    EXPECT_EQ(names.light_key(0), (ProfileKey{Cause::emitter, 1}));
    EXPECT_EQ(names.light_key(1), (ProfileKey{Cause::light, 7}));
    EXPECT_EQ(names.light_key(2), (ProfileKey{Cause::light, 5}));
    EXPECT_EQ(names.light_key(3), (ProfileKey{Cause::environment, 0}));

    PathContribution c;
    c.emitter = 1, c.place = {4, 3, 2, 0x12};
    const ProfileNames::Keys met = names.keys_of(c);
    EXPECT_EQ(met[0], (ProfileKey{Cause::emitter, 0}));
    EXPECT_EQ(met[1], (ProfileKey{Cause::material, 4}));
    EXPECT_EQ(met[2], (ProfileKey{Cause::object, 1}));
    EXPECT_EQ(met[3], (ProfileKey{Cause::path, 0x12}));
    EXPECT_EQ(met[4], (ProfileKey{Cause::depth, 2}));
    c.emitter = no_index, c.place = {};
    const ProfileNames::Keys seen = names.keys_of(c);
    EXPECT_EQ(seen[0].cause, Cause::environment);
    EXPECT_EQ(seen[1].cause, Cause::camera);
    EXPECT_EQ(seen[2].cause, Cause::camera);
    c.place.material = 0;
    EXPECT_EQ(names.keys_of(c)[2].cause, Cause::medium);
}

/// Shares are covariances with the whole: computed here from their definition.
TEST(ProfileSums, NoiseIsTheCovarianceWithTheWhole)
{
    const Tables t;
    constexpr int samples = 2;
    constexpr std::size_t pixels = 3;
    std::mt19937 random(1);
    std::exponential_distribution<float> values(1);
    std::array<PathProfile, sets> profiles;
    double mean[pixels][2][sets] = {};
    for (std::size_t set = 0; set < sets; ++set)
        for (std::uint32_t path = 0; path < pixels * samples; ++path)
            for (std::uint32_t light = 1; light <= 2; ++light) {
                const float value = values(random) * float(light) * (path < 2 ? 1 : 0.1f);
                profiles[set].contributions.push_back(contribution(path, light, light, value));
                mean[path / samples][light - 1][set] += double(value) / samples;
            }
    const ProfileTileSums tile = sum_profile(t.names(), profiles, pixels, samples);

    double expected[2] = {}, all = 0;
    for (std::size_t p = 0; p < pixels; ++p) {
        double a[2] = {}, pixel_noise = 0;
        for (int l = 0; l < 2; ++l)
            for (const double x : mean[p][l]) a[l] += x / double(sets);
        const double whole = a[0] + a[1], weight = 1 / (whole * whole + 0.01);
        for (int l = 0; l < 2; ++l)
            for (std::size_t s = 0; s < sets; ++s) {
                const double v = (mean[p][l][s] - a[l]) * (mean[p][0][s] + mean[p][1][s] - whole) * weight /
                                 double(sets - 1) / double(sets);
                expected[l] += v, pixel_noise += v;
            }
        EXPECT_NEAR(tile.pixels[p].mean[1], whole, 1e-9);
        EXPECT_NEAR(tile.pixels[p].noise, pixel_noise, 1e-9);
        all += pixel_noise;
    }
    EXPECT_NEAR(tile.total.noise, all, 1e-9);
    const auto& lights = tile.tables[std::size_t(ProfileTable::lights)];
    EXPECT_NEAR(lights.at({ProfileCause::light, 7}).noise, expected[0], 1e-9);
    EXPECT_NEAR(lights.at({ProfileCause::light, 5}).noise, expected[1], 1e-9);
    const auto& materials = tile.tables[std::size_t(ProfileTable::materials)];
    EXPECT_NEAR(materials.at({ProfileCause::material, 2}).noise, expected[1], 1e-9);
}

/// Without a set, sums are those of the others with their own means.
TEST(ProfileSums, LeavesOutEachSet)
{
    const Tables t;
    std::array<PathProfile, sets> profiles;
    const double values[sets] = {1, 4, 2, 2, 9, 3, 1, 5};
    for (std::size_t s = 0; s < sets; ++s) profiles[s].contributions = {contribution(0, 1, 0, float(values[s]))};
    const ProfileTileSums tile = sum_profile(t.names(), profiles, 1, 1);
    double mean = 0;
    for (const double x : values) mean += x / sets;
    for (std::size_t left_out = 0; left_out < sets; ++left_out) {
        double of_others = 0, squares = 0;
        for (std::size_t s = 0; s < sets; ++s) of_others += s == left_out ? 0 : values[s] / double(sets - 1);
        for (std::size_t s = 0; s < sets; ++s)
            squares += s == left_out ? 0 : (values[s] - of_others) * (values[s] - of_others);
        const double variance = squares / double(sets - 2) / double(sets);
        EXPECT_NEAR(tile.total.without[left_out], variance / (mean * mean + 0.01), 1e-9) << left_out;
    }
}

TEST(ProfileSums, WorkBelongsToPlacesAndShadowRaysToLights)
{
    const Tables t;
    std::array<PathProfile, sets> profiles;
    PathCost camera, surface;
    camera.rays = 1, camera.nanoseconds = 3;
    surface.path = 2, surface.rays = 1, surface.shadow_rays = 1, surface.light = 2;
    surface.nanoseconds = 10, surface.shadow_nanoseconds = 4;
    surface.place = {6, 0, 1, append_event(0, PathEvent::glossy)};
    profiles[3].costs = {camera, surface};
    const ProfileTileSums tile = sum_profile(t.names(), profiles, 2, 2);
    EXPECT_EQ(tile.total.nanoseconds, 13);
    EXPECT_EQ(tile.total.rays, 3u);
    EXPECT_EQ(tile.pixels[0].nanoseconds, 3);
    EXPECT_EQ(tile.pixels[1].nanoseconds, 10);
    const auto row = [&](ProfileTable table, ProfileKey key) { return tile.tables[std::size_t(table)].at(key); };
    const ProfileSums light = row(ProfileTable::lights, {ProfileCause::light, 5}),
                      none = row(ProfileTable::lights, {ProfileCause::no_light, 0}),
                      material = row(ProfileTable::materials, {ProfileCause::material, 6}),
                      path = row(ProfileTable::paths, {ProfileCause::path, 2, true}),
                      depth = row(ProfileTable::depths, {ProfileCause::depth, 0});
    EXPECT_EQ(light.nanoseconds, 4);
    EXPECT_EQ(light.rays, 1u);
    EXPECT_EQ(light.shadow_rays, 1u);
    EXPECT_EQ(none.nanoseconds, 9);
    EXPECT_EQ(none.rays, 2u);
    EXPECT_EQ(none.shadow_rays, 0u);
    EXPECT_EQ(material.nanoseconds, 10);
    EXPECT_EQ(material.rays, 2u);
    EXPECT_EQ(path.nanoseconds, 10);
    // A mirror has no light samples.
    surface.place.word = append_event(0, PathEvent::mirror);
    EXPECT_EQ(t.names().keys_of(surface)[3], (ProfileKey{ProfileCause::path, 3}));
    EXPECT_EQ(t.names().keys_of(camera)[3], (ProfileKey{ProfileCause::path, 0}));
    EXPECT_EQ(depth.nanoseconds, 3);
}

TEST(ProfileSums, DropsInvalidLight)
{
    const Tables t;
    std::array<PathProfile, sets> profiles;
    profiles[0].contributions = {contribution(0, 1, 0, NAN), contribution(0, 2, 0, 8)};
    const ProfileTileSums tile = sum_profile(t.names(), profiles, 1, 1);
    EXPECT_DOUBLE_EQ(tile.pixels[0].mean[0], 1);
    EXPECT_EQ(tile.tables[0].count({ProfileCause::light, 7}), 0u);
}

}  // namespace
}  // namespace fathom
