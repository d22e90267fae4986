#include "integrate/scene.h"

#include <algorithm>

#include "fathom/description.h"
#include "integrate/alpha.h"

namespace fathom {

inline namespace FATHOM_LANES {

namespace {

ShadowTargets shadow_targets(const LightTables& tables)
{
    ShadowTargets targets;
    targets.infinite = tables.environment.light != no_index;
    for (const LightRecord& light : tables.lights) {
        targets.places.push_back({light.position[0], light.position[1], light.position[2]});
        targets.infinite |= light.kind == std::uint32_t(LightRecordKind::directional);
    }
    if (tables.lights.size() == 1) targets.only_primitive = tables.lights[0].primitive;
    return targets;
}

/// How many solids with an inside stand in the scene, as far as it matters.
std::size_t count_solids(const SceneTables& tables)
{
    const auto is_solid = [&](const ShapeRecord& shape) { return tables.materials[shape.material].medium != 0; };
    std::size_t count = 0;
    for (const ShapeRecord& shape : tables.shapes)
        count += is_solid(shape) && !(shape.flags & ShapeRecord::only_instanced);
    for (const InstanceRecord& instance : tables.instances) count += is_solid(tables.shapes[instance.shape]);
    return count;
}

}  // namespace

LaneScene::LaneScene(std::shared_ptr<const SceneTables> t, TreeBuild level)
    : tables_owner(std::move(t)), tables(*tables_owner)
{
    const bool has_alpha = std::any_of(tables.shapes.begin(), tables.shapes.end(),
                                       [](const ShapeRecord& s) { return s.flags & ShapeRecord::alpha_tested; });
    is_flat = FlatScene::fits(tables) && !has_alpha;
    if (is_flat) {
        flat.build(tables, shadow_targets(tables));
    } else {
        bvh.build(tables, level);
        if (has_alpha) bvh.set_alpha_test(&alpha_passes, &tables);
    }
    for (const ShapeRecord& shape : tables.shapes) {
        const MaterialRecord& material = tables.materials[shape.material];
        refracts |= Closures::transmits(MaterialKind(material.kind));
        normal_mapped |= (material.flags & MaterialRecord::normal_mapped) != 0;
        for (float a : tables.media[material.medium].absorption) has_absorption |= a > 0;
        const std::uint32_t kind = Closures::contains(MaterialKind(material.kind)) ? material.kind : 0;
        if (kind != 0) kinds |= 1u << kind;
        shape_info.push_back(kind << kind_shift | (shape.material & ((1u << kind_shift) - 1)) |
                             (material.flags & MaterialRecord::emits ? emits : 0u));
    }
    tracks_media = has_absorption || count_solids(tables) > 1;
    textured = !tables.textures.empty();
    varied_lights = std::any_of(tables.lights.begin(), tables.lights.end(),
                                [](const LightRecord& light) { return light.material != no_index; });
    only_diffuse_quads = is_flat && !tables.moving && !textured && tables.triangles.empty() && tables.spheres.empty() &&
                         tables.disks.empty();
    for (const ShapeRecord& shape : tables.shapes) {
        const MaterialRecord& m = tables.materials[shape.material];
        only_diffuse_quads &= !Closures::contains(MaterialKind(m.kind)) ||
                              (MaterialKind(m.kind) == MaterialKind::diffuse && m.roughness == 0);
    }
    if (is_flat) {
        for (std::uint32_t shape : tables.shape_of_primitive) primitive_info.push_back(shape_info[shape]);
        primitive_info.resize(primitive_info.size() + lookup_size);
    }
    quads.build(tables, !is_flat);
    sees_environment = EnvironmentKind(tables.environment.kind) != EnvironmentKind::none;
    filters[0].make_gaussian();
    filters[1].make_blackman_harris();
}

std::size_t LaneScene::memory_bytes() const
{
    return shape_info.size() * 4 + primitive_info.size() * 4 + quads.memory_bytes() +
           (is_flat ? 0 : bvh.memory_bytes());
}

}  // namespace FATHOM_LANES

std::unique_ptr<KernelScene> make_kernel_scene(std::shared_ptr<const SceneTables> tables, TreeBuild level)
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
