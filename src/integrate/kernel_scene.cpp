// SPDX-License-Identifier: Apache-2.0
#include "kernel/lane_scene.h"

#include <algorithm>

#include "fathom/description.h"
#include "integrate/alpha.h"
#include "integrate/shadow_trial.h"
#include "lights/kinds/records.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace {

ShadowTargets shadow_targets(const LightTables& tables)
{
    ShadowTargets targets;
    // Environments and directional lights, which have no position, come last in the table.
    targets.infinite = tables.positioned_lights < tables.lights.size();
    targets.places = tables.light_places;
    // Moving lights can be visible from any point, so no surface may be left out of the occluders.
    for (const LightRecord& light : tables.lights) targets.infinite |= light.motion != 0;
    if (tables.lights.size() == 1) targets.only_primitive = tables.lights[0].primitive;
    return targets;
}

/// Flags of shape_info that tell how paths and shadow rays pass a material.
std::uint32_t pass_flags(const SceneTables& tables, const MaterialRecord& m)
{
    if (m.features.has(MaterialFeature::index_matched_boundary))
        return LaneScene::passes_shadow_rays | LaneScene::passes_without_bounce;
    if (!m.features.has(MaterialFeature::pane)) return 0;
    // A pane that bounds an index-matched medium counts no bounce: the scattering inside the medium does.
    return LaneScene::passes_shadow_rays |
           (tables.media[m.medium].is_index_matched ? LaneScene::passes_without_bounce : 0);
}

}  // namespace

LaneScene::LaneScene(std::shared_ptr<const SceneTables> t, BvhQuality level)
    : tables_owner(std::move(t)), tables(*tables_owner)
{
    is_flat = FlatScene::fits(tables) && !has_alpha() && !has_transmissive_surfaces(tables);
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
    features = find_features(tables, is_flat);
    closures = find_closures(tables);
    read_shapes();
    if (is_flat) {
        primitive_info.clear();
        for (std::uint32_t shape : tables.shape_of_primitive) primitive_info.push_back(shape_info[shape]);
        primitive_info.resize(primitive_info.size() + lookup_size);
    }
    quads.build(tables, !is_flat);
    light_media.clear();
}

void LaneScene::read_shapes()
{
    material_bucket.clear();
    for (const MaterialRecord& material : tables.materials)
        material_bucket.push_back(std::uint32_t(material.closure) << kind_shift |
                                  (std::uint32_t(material_bucket.size()) & ((1u << kind_shift) - 1)));
    shape_info.clear();
    for (const ShapeRecord& shape : tables.shapes) {
        const MaterialRecord& material = tables.materials[shape.material];
        shape_info.push_back(material_bucket[shape.material] |
                             (material.features.has(MaterialFeature::emits) ? emits : 0u) |
                             (material.mixture != no_index ? is_mixture : 0u) | pass_flags(tables, material));
    }
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
