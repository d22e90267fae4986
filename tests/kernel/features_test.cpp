// SPDX-License-Identifier: Apache-2.0
#include "kernel/features.h"

#include <gtest/gtest.h>

#include <initializer_list>

#include "lights/kinds/records.h"

namespace fathom {
namespace {

/// A flat scene of one plain quad.
SceneTables plain_scene()
{
    SceneTables tables;
    tables.media.resize(1);
    tables.materials.resize(1);
    tables.materials[0].closure = ClosureKind::diffuse;
    tables.shapes.resize(1);
    tables.shapes[0].material = 0;
    tables.quads.resize(1);
    return tables;
}
/// A flat scene of one quad whose material has these features.
SceneTables flagged(MaterialFeatures features)
{
    SceneTables tables = plain_scene();
    tables.materials[0].features = features;
    return tables;
}
/// A flat scene of one quad with this closure.
SceneTables closed(ClosureKind kind)
{
    SceneTables tables = plain_scene();
    tables.materials[0].closure = kind;
    return tables;
}
/// A solid whose medium is filled in by `fill`.
template <class Fill>
SceneTables solid(Fill&& fill)
{
    SceneTables tables = plain_scene();
    tables.materials[0].medium = 1;
    tables.media.resize(2);
    fill(tables.media[1]);
    return tables;
}
template <class Fill>
SceneTables lit(Fill&& fill)
{
    SceneTables tables = plain_scene();
    tables.lights.resize(1);
    fill(tables.lights[0]);
    return tables;
}

/// Expects exactly these features.
void expect(const SceneTables& tables, bool is_flat, std::initializer_list<Feature> wanted)
{
    EnumSet<Feature> set;
    for (const Feature feature : wanted) set.add(feature);
    const Features found = find_features(tables, is_flat);
    for (std::uint32_t f = 0; f <= std::uint32_t(Feature::only_plain_quads); ++f)
        EXPECT_EQ(found.has(Feature(f)), set.has(Feature(f))) << "feature " << f;
}

constexpr auto quads = Feature::only_quads, plain_quads = Feature::only_plain_quads;

TEST(Features, OfSurfaces)
{
    expect(plain_scene(), true, {quads, plain_quads});
    expect(plain_scene(), false, {});
    SceneTables moving = plain_scene();
    moving.moving = true;
    expect(moving, true, {Feature::motion});
    SceneTables large = plain_scene();
    large.positions.resize((1 << 17) + 1);
    expect(large, false, {Feature::large_meshes});
    SceneTables textured = flagged(MaterialFeature::textured);
    textured.textures.resize(1);
    expect(textured, true, {Feature::textures, Feature::texture_coordinates, quads});
    expect(flagged(MaterialFeature::needs_tangent), true,
           {Feature::tangents, Feature::texture_coordinates, quads, plain_quads});
    expect(flagged(MaterialFeature::bumped), true, {Feature::bump_maps, Feature::surface_derivatives, quads});
    expect(flagged(MaterialFeature::map_tangents), false, {Feature::map_tangents, Feature::surface_derivatives});
    expect(flagged(MaterialFeature::one_sided), true, {Feature::one_sided});
    expect(flagged(MaterialFeature::single_sided), true, {Feature::camera_pass_through});
    expect(flagged(MaterialFeature::hidden_from_camera), true, {Feature::camera_pass_through});
    SceneTables disk = plain_scene();
    disk.disks.resize(1);
    expect(disk, true, {});
}

TEST(Features, OfClosures)
{
    expect(closed(ClosureKind::glass), true, {Feature::transmission, quads});
    expect(closed(ClosureKind::metal), true, {quads});
    expect(closed(ClosureKind::none), true, {quads, plain_quads});
    expect(closed(ClosureKind::layered), true, {});
    expect(closed(ClosureKind::hair), false,
           {Feature::transmission, Feature::texture_coordinates, Feature::exit_offsets});
    EXPECT_FALSE(find_closures(closed(ClosureKind::none)).has(ClosureKind::none));
}

TEST(Features, OfTheConstituentsOfMixtures)
{
    SceneTables tables = plain_scene();
    tables.materials.resize(4);
    tables.materials[0].mixture = 0, tables.materials[0].closure = ClosureKind::none;
    tables.mixtures.resize(1);
    tables.mixtures[0].first = 1, tables.mixtures[0].second = 2;
    tables.materials[1].closure = ClosureKind::glass;
    tables.materials[2].closure = ClosureKind::metal, tables.materials[2].features = MaterialFeature::bumped;
    tables.materials[3].closure = ClosureKind::hair;  // used by no shape
    expect(tables, true, {Feature::mixtures, Feature::transmission, Feature::bump_maps, Feature::surface_derivatives});
    const EnumSet<ClosureKind> closures = find_closures(tables);
    EXPECT_TRUE(closures.has(ClosureKind::glass) && closures.has(ClosureKind::metal));
    EXPECT_FALSE(closures.has(ClosureKind::hair));
}

TEST(Features, OfMedia)
{
    const auto clear = [](MediumRecord&) {};
    expect(solid(clear), true, {quads, plain_quads});
    expect(solid([](MediumRecord& m) { m.extinction = {0, 1, 0}; }), true,
           {Feature::attenuation, Feature::media_stacks});
    expect(solid([](MediumRecord& m) { m.extinction = m.scattering = {0, 0, 1}, m.is_textured = 1; }), true,
           {Feature::attenuation, Feature::scattering_media, Feature::textured_media, Feature::media_stacks});
    SceneTables subsurface = solid([](MediumRecord& m) { m.extinction = {1, 1, 1}; });
    std::swap(subsurface.materials[0].medium, subsurface.materials[0].subsurface_medium);
    expect(subsurface, false, {Feature::attenuation, Feature::media_stacks});
    SceneTables two = solid(clear);
    two.shapes.push_back(two.shapes[0]);
    expect(two, true, {Feature::media_stacks});
    two.shapes[1].flags = ShapeRecord::only_instanced;
    expect(two, false, {});
    two.instances.resize(1), two.instances[0].shape = 1;
    expect(two, false, {Feature::media_stacks});
}

/// Flat scenes treat such surfaces like ordinary ones, since edits may add them later.
TEST(Features, OfSurfacesThatShadowRaysPass)
{
    const SceneTables fog = solid([](MediumRecord& m) { m.is_index_matched = 1; });
    expect(fog, false,
           {Feature::open_media, Feature::transmissive_shadows, Feature::exit_offsets, Feature::media_stacks});
    expect(fog, true, {quads, plain_quads});
    expect(flagged(MaterialFeature::index_matched_boundary), false,
           {Feature::open_media, Feature::transmissive_shadows, Feature::exit_offsets, Feature::media_stacks});
    expect(flagged(MaterialFeature::pane), false, {Feature::transmissive_shadows, Feature::exit_offsets});
    EXPECT_TRUE(has_transmissive_surfaces(fog) && has_transmissive_surfaces(flagged(MaterialFeature::pane)));
    EXPECT_FALSE(has_transmissive_surfaces(plain_scene()));
}

TEST(Features, OfLights)
{
    expect(lit([](LightRecord& light) { light.motion = 1; }), false, {Feature::moving_lights});
    expect(lit([](LightRecord& light) { light.material = 0; }), false, {Feature::textured_lights});
    expect(lit([](LightRecord& light) { light.set(CurveLightRecord{}); }), false, {Feature::curve_lights});
    SceneTables projector = plain_scene();
    projector.light_pictures.resize(1);
    expect(projector, false, {Feature::light_pictures});
    SceneTables sky = plain_scene();
    sky.environment.kind = decltype(sky.environment.kind)(EnvironmentKind::gradient);
    expect(sky, true, {Feature::environment, quads, plain_quads});
}

/// Each optional column of the pool is needed for a reason of its own.
TEST(Features, DecideTheColumnsOfPaths)
{
    const auto columns = [](std::initializer_list<Feature> features, float clamp, bool records) {
        Features set;
        for (const Feature feature : features) set.add(feature);
        KernelSettings settings;
        settings.clamp_indirect = clamp;
        return path_columns(set, settings, records);
    };
    for (const auto& [feature, column] : {std::pair(Feature::motion, PathColumn::time),
                                          {Feature::transmission, PathColumn::eta_scale},
                                          {Feature::media_stacks, PathColumn::media},
                                          {Feature::scattering_media, PathColumn::walk_steps},
                                          {Feature::open_media, PathColumn::walk_steps},
                                          {Feature::textured_media, PathColumn::walk_coefficients},
                                          {Feature::transmissive_shadows, PathColumn::light_sampling_state}}) {
        EXPECT_TRUE(columns({feature}, 0, false).has(column)) << int(column);
        EXPECT_FALSE(columns({}, 1, true).has(column)) << int(column);
    }
    EXPECT_TRUE(columns({}, 1, false).has(PathColumn::indirect_left));
    EXPECT_FALSE(columns({}, 0, true).has(PathColumn::indirect_left));
    EXPECT_TRUE(columns({}, 0, true).has(PathColumn::number));
    EXPECT_FALSE(columns({}, 1, false).has(PathColumn::number));
    KernelSettings guided;
    GuidingTables tables;
    guided.guiding = &tables;
    EXPECT_FALSE(path_columns({}, guided, false).has(PathColumn::nee_probability));
    tables.nee_factors.push_back(1);
    EXPECT_TRUE(path_columns({}, guided, false).has(PathColumn::nee_probability));
}

}  // namespace
}  // namespace fathom
