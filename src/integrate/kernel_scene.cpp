// SPDX-License-Identifier: Apache-2.0
#include "kernel/lane_scene.h"

#include <algorithm>

#include "fathom/description.h"
#include "integrate/alpha.h"
#include "integrate/shadow_trial.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace {

ShadowTargets shadow_targets(const LightTables& tables)
{
    ShadowTargets targets;
    targets.infinite = tables.environment.light != no_index;
    for (const LightRecord& light : tables.lights) {
        targets.places.push_back({light.position[0], light.position[1], light.position[2]});
        if (light.kind == std::uint32_t(LightRecordKind::beam))
            for (const float i : {-1.f, 1.f})
                for (const float j : {-1.f, 1.f}) {
                    const auto corner = [&](int k) {
                        return light.position[k] + i * light.edge_u[k] + j * light.edge_v[k];
                    };
                    targets.places.push_back({corner(0), corner(1), corner(2)});
                }
        // Moving lights can be seen from anywhere, so no surface may be left out.
        targets.infinite |= light.kind == std::uint32_t(LightRecordKind::directional) || light.motion != 0;
    }
    // LightRecord::primitive of a pictured light is the index of its image.
    if (tables.lights.size() == 1 && tables.lights[0].kind != std::uint32_t(LightRecordKind::pictured))
        targets.only_primitive = tables.lights[0].primitive;
    return targets;
}

/// Number of solids that have a medium, counting instances.
std::size_t count_solids(const SceneTables& tables)
{
    const auto is_solid = [&](const ShapeRecord& shape) { return tables.materials[shape.material].medium != 0; };
    std::size_t count = 0;
    for (const ShapeRecord& shape : tables.shapes)
        count += is_solid(shape) && !(shape.flags & ShapeRecord::only_instanced);
    for (const InstanceRecord& instance : tables.instances) count += is_solid(tables.shapes[instance.shape]);
    return count;
}

/// Whether some shape's material satisfies f. Constituents of mixtures are not tested.
template <class F>
bool has_material(const SceneTables& tables, F&& f)
{
    return std::any_of(tables.shapes.begin(), tables.shapes.end(),
                       [&](const ShapeRecord& shape) { return f(tables.materials[shape.material]); });
}

bool has_open_media(const SceneTables& tables)
{
    return has_material(tables, [&](const MaterialRecord& m) {
        return (m.flags & MaterialRecord::index_matched_boundary) || tables.media[m.medium].is_index_matched;
    });
}

bool has_panes(const SceneTables& tables)
{
    return has_material(tables, [](const MaterialRecord& m) { return (m.flags & MaterialRecord::pane) != 0; });
}

/// Flags of shape_info that tell how paths and shadow rays pass a material.
std::uint32_t pass_flags(const SceneTables& tables, const MaterialRecord& m)
{
    if (m.flags & MaterialRecord::index_matched_boundary)
        return LaneScene::passes_shadow_rays | LaneScene::passes_without_bounce;
    if (!(m.flags & MaterialRecord::pane)) return 0;
    // A pane that bounds an index-matched medium counts no bounce: the scattering inside the medium does.
    return LaneScene::passes_shadow_rays |
           (tables.media[m.medium].is_index_matched ? LaneScene::passes_without_bounce : 0);
}

}  // namespace

LaneScene::LaneScene(std::shared_ptr<const SceneTables> t, BvhQuality level)
    : tables_owner(std::move(t)), tables(*tables_owner)
{
    is_flat = FlatScene::fits(tables) && !has_alpha() && !has_open_media(tables) && !has_panes(tables);
    if (!is_flat) bvh.build(tables, level);
    filters[0].make_gaussian();
    filters[1].make_blackman_harris();
    filters[2].make_tent();
    read_tables();
    order_by_trial_shadow_rays(*this);
}

void LaneScene::update(const std::vector<std::uint32_t>& shapes)
{
    if (!is_flat) bvh.update(shapes);
    read_tables();
}

bool LaneScene::has_alpha() const
{
    return std::any_of(tables.shapes.begin(), tables.shapes.end(),
                       [](const ShapeRecord& s) { return s.flags & ShapeRecord::alpha_tested; });
}

/// Sets everything except the BVH.
void LaneScene::read_tables()
{
    if (is_flat)
        flat.build(tables, shadow_targets(tables));
    else
        bvh.set_alpha_test(has_alpha() ? &alpha_passes : nullptr, &tables);
    read_shapes();
    // Edits may add open media and panes; the flat list treats them as ordinary surfaces.
    open_media = !is_flat && has_open_media(tables);
    transmissive_shadows = open_media || (!is_flat && has_panes(tables));
    tracks_media = has_absorption || open_media || count_solids(tables) > 1;
    has_exit_offset = has_fibers || transmissive_shadows;
    only_quads &= !tracks_media;
    constexpr std::size_t much = 1 << 17;  // vertices
    is_large = tables.positions.size() > much;
    textured = !tables.textures.empty();
    needs_uv = textured || has_fibers || wants_tangents;
    varied_lights = std::any_of(tables.lights.begin(), tables.lights.end(),
                                [](const LightRecord& light) { return light.material != no_index; });
    moving_lights = std::any_of(tables.lights.begin(), tables.lights.end(),
                                [](const LightRecord& light) { return light.motion != 0; });
    curve_lights = std::any_of(tables.lights.begin(), tables.lights.end(), [](const LightRecord& light) {
        return light.kind == std::uint32_t(LightRecordKind::curve);
    });
    pictured_lights = !tables.light_pictures.empty();
    if (is_flat) {
        primitive_info.clear();
        for (std::uint32_t shape : tables.shape_of_primitive) primitive_info.push_back(shape_info[shape]);
        primitive_info.resize(primitive_info.size() + lookup_size);
    }
    quads.build(tables, !is_flat);
    needs_environment_radiance = EnvironmentKind(tables.environment.kind) != EnvironmentKind::none;
}

void LaneScene::read_shapes()
{
    kinds = 0;
    refracts = has_fibers = wants_tangents = camera_passes_surfaces = has_absorption = scatters_inside =
        textured_media = has_mixtures = one_sided = has_bumps = has_map_tangents = wants_uv_slopes = false;
    material_bucket.clear();
    for (const MaterialRecord& material : tables.materials)
        material_bucket.push_back(std::uint32_t(material.closure) << kind_shift |
                                  (std::uint32_t(material_bucket.size()) & ((1u << kind_shift) - 1)));
    shape_info.clear();
    only_plain_quads = true;
    only_quads =
        is_flat && !tables.moving && tables.triangles.empty() && tables.spheres.empty() && tables.disks.empty();
    for (const ShapeRecord& shape : tables.shapes) {
        const MaterialRecord& material = tables.materials[shape.material];
        read_material(material);
        shape_info.push_back(material_bucket[shape.material] | (material.flags & MaterialRecord::emits ? emits : 0u) |
                             (material.mixture != no_index ? is_mixture : 0u) | pass_flags(tables, material));
    }
}

/// Sets the scene's flags that depend on one of its materials.
void LaneScene::read_material(const MaterialRecord& material)
{
    camera_passes_surfaces |=
        (material.flags & (MaterialRecord::single_sided | MaterialRecord::hidden_from_camera)) != 0;
    only_quads &= !camera_passes_surfaces;
    if (material.mixture != no_index) {
        has_mixtures = true;
        only_quads = false;
        const MixtureRecord& mixture = tables.mixtures[material.mixture];
        read_material(tables.materials[mixture.first]);
        read_material(tables.materials[mixture.second]);
        return;
    }
    refracts |= Closures::transmits(material.closure);
    has_fibers |= material.closure == ClosureKind::hair;
    wants_tangents |= (material.flags & MaterialRecord::needs_tangent) != 0;
    has_bumps |= (material.flags & MaterialRecord::bumped) != 0;
    has_map_tangents |= (material.flags & MaterialRecord::map_tangents) != 0;
    wants_uv_slopes |= has_bumps || has_map_tangents;
    for (const std::uint32_t number : {material.medium, material.subsurface_medium}) {
        const MediumRecord& medium = tables.media[number];
        for (float sigma : medium.extinction) has_absorption |= sigma > 0;
        for (float sigma : medium.scattering) scatters_inside |= sigma > 0;
        textured_media |= medium.is_textured != 0;
    }
    const bool scatters = material.closure != ClosureKind::none;
    if (scatters) kinds |= 1u << std::uint32_t(material.closure);
    one_sided |= (material.flags & MaterialRecord::one_sided) != 0;
    only_quads &=
        !one_sided && material.emission_texture == no_index && (!scatters || Closures::is_small(material.closure));
    only_plain_quads &= QuadColumns::is_plain(material);
}

std::size_t LaneScene::memory_bytes() const
{
    return shape_info.size() * 4 + primitive_info.size() * 4 + quads.memory_bytes() +
           (is_flat ? 0 : bvh.memory_bytes());
}

}  // namespace FATHOM_LANES

std::unique_ptr<KernelScene> make_kernel_scene(std::shared_ptr<const SceneTables> tables, BvhQuality level)
{
    return std::make_unique<LaneScene>(std::move(tables), level);
}

int kernel_lanes()
{
    return lanes;
}
const char* kernel_name()
{
    return lanes_name;
}

}  // namespace fathom
