// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "base/enum_set.h"
#include "kernel/kernel.h"
#include "math/lanes.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// A property of a scene that turns on code or data which other scenes do without.
enum class Feature : std::uint32_t {
    motion,                ///< Something moves: rays have times.
    large_meshes,          ///< Vertices exceed the caches close to a core: those of hits are prefetched.
    textures,              ///< Some texture exists: paths are sorted by material, and hits have world positions.
    texture_coordinates,   ///< Textures, hair or tangents: hits have texture coordinates.
    tangents,              ///< MaterialFeature::needs_tangent: hits have a tangent.
    bump_maps,             ///< MaterialFeature::bumped: bump maps tilt shading normals.
    map_tangents,          ///< MaterialFeature::map_tangents: tangents follow the texture coordinates of normal maps.
    surface_derivatives,   ///< bump_maps or map_tangents: hits have Surface::derivatives.
    mixtures,              ///< Mixtures: the material of each hit is chosen before paths are sorted.
    one_sided,             ///< MaterialFeature::one_sided: the throughput of paths that hit such a back becomes 0.
    camera_pass_through,   ///< Surfaces that camera rays pass: CameraPassThrough replaces their hits.
    transmission,          ///< Some closure transmits: Russian roulette cancels refraction's scaling of radiance.
    exit_offsets,          ///< Hair or transmissive_shadows: see PathPool::exit_offset.
    attenuation,           ///< Some medium absorbs or scatters: it attenuates path segments and shadow rays.
    scattering_media,      ///< Some medium scatters: paths may scatter before they hit a surface.
    textured_media,        ///< Media with textures: paths carry the coefficients at their point of entry.
    open_media,            ///< Index-matched media or boundaries: paths and shadow rays pass boundaries undeflected.
    transmissive_shadows,  ///< open_media or thin panes: shadow rays are traced through such surfaces.
    media_stacks,          ///< attenuation, open_media or several solids: paths have a stack of media.
    environment,           ///< The environment emits: rays that leave the scene add its radiance.
    textured_lights,       ///< LightRecord::material: emission varies over the surface of lights.
    moving_lights,         ///< LightRecord::motion: lights are sampled where they are at the time of the path.
    curve_lights,          ///< Curve segments emit: they are sampled along their length.
    light_pictures,        ///< LightRecordKind::pictured: images scale the intensity of lights.
    only_quads,            ///< Only static quads with small closures: QuadTracer renders the scene.
    only_plain_quads       ///< only_quads, and each quad is plain (QuadColumns): QuadTracer needs no closures.
};
using Features = EnumSet<Feature>;

/// Finds the features of a scene. is_flat: it is traced as a flat list, which treats panes and open boundaries as
/// ordinary surfaces.
Features find_features(const SceneTables& tables, bool is_flat);
/// Whether shadow rays pass some surface: see Feature::transmissive_shadows.
bool has_transmissive_surfaces(const SceneTables& tables);
/// Kinds of the closures that scatter, in mixtures too.
EnumSet<ClosureKind> find_closures(const SceneTables& tables);

/// An optional column of PathPool that lives on to the next surface.
enum class PathColumn : std::uint32_t {
    time,
    eta_scale,
    media,
    indirect_left,
    nee_probability,
    number,
    walk_steps,
    walk_coefficients,     ///< walk_extinction and walk_albedo
    light_sampling_state,  ///< bsdf_pdf and exit_offset: surfaces that a path passes undeflected keep them
    light_tracing,         ///< connection and scatter_pdf: weights against light tracing
    gathered               ///< caustics are gathered from photons
};
using PathColumns = EnumSet<PathColumn>;

/// Optional columns that paths need. records: whether the job records paths.
inline PathColumns path_columns(const Features& features, const KernelSettings& settings, bool records)
{
    PathColumns columns;
    columns.add(PathColumn::time, features.has(Feature::motion));
    columns.add(PathColumn::eta_scale, features.has(Feature::transmission));
    columns.add(PathColumn::media, features.has(Feature::media_stacks));
    columns.add(PathColumn::indirect_left, settings.clamp_indirect > 0);
    columns.add(PathColumn::nee_probability, settings.skips_light_samples());
    columns.add(PathColumn::number, records);
    columns.add(PathColumn::walk_steps, features.has(Feature::scattering_media) || features.has(Feature::open_media));
    columns.add(PathColumn::walk_coefficients, features.has(Feature::textured_media));
    columns.add(PathColumn::light_sampling_state, features.has(Feature::transmissive_shadows));
    columns.add(PathColumn::light_tracing, settings.light_paths > 0);
    columns.add(PathColumn::gathered, settings.caustics != nullptr);
    return columns;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
