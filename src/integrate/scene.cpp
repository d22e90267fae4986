#include "integrate/scene.h"

#include <algorithm>
#include <cmath>

#include "fathom/description.h"
#include "integrate/alpha.h"

namespace fathom {

inline namespace FATHOM_LANES {

LaneScene::LaneScene(std::shared_ptr<const SceneTables> t) : tables_owner(std::move(t)), tables(*tables_owner)
{
    const bool has_alpha = std::any_of(tables.shapes.begin(), tables.shapes.end(),
                                       [](const ShapeTable& s) { return s.flags & ShapeTable::alpha_tested; });
    is_flat = FlatScene::fits(tables) && !has_alpha;
    if (is_flat) {
        flat.build(tables);
    } else {
        bvh.build(tables);
        if (has_alpha) bvh.set_alpha_test(&alpha_passes, &tables);
    }
    for (const ShapeTable& shape : tables.shapes) {
        const MaterialTable& material = tables.materials[shape.material];
        kinds |= 1u << material.bsdf;
        normal_mapped |= (material.flags & MaterialTable::normal_mapped) != 0;
        for (float a : material.absorption) has_absorption |= a > 0;
        shape_info.push_back(shape.material | material.bsdf << kind_shift | (material.flags & MaterialTable::emits ? emits : 0u));
    }
    textured = !tables.textures.empty();
    simple = is_flat && !textured && tables.triangles.empty() && tables.spheres.empty() && tables.disks.empty();
    for (const ShapeTable& shape : tables.shapes) {
        const MaterialTable& m = tables.materials[shape.material];
        simple &= m.bsdf == std::uint32_t(BsdfKind::none) || (m.bsdf == std::uint32_t(BsdfKind::diffuse) && m.roughness == 0);
    }
    if (is_flat) {
        for (std::uint32_t shape : tables.shape_of_primitive) primitive_info.push_back(shape_info[shape]);
        primitive_info.resize(primitive_info.size() + small_table);
    }
    for (const QuadTable& q : tables.quads) {
        const Vec3d n = normalize(cross(Vec3d{q.edge_u.x, q.edge_u.y, q.edge_u.z}, Vec3d{q.edge_v.x, q.edge_v.y, q.edge_v.z}));
        quad_normal[0].push_back(float(n.x));
        quad_normal[1].push_back(float(n.y));
        quad_normal[2].push_back(float(n.z));
        float extent = 0;
        for (float x : {q.edge_u.x, q.edge_u.y, q.edge_u.z, q.edge_v.x, q.edge_v.y, q.edge_v.z})
            extent = std::max(extent, std::abs(x));
        quad_extent.push_back(extent);
    }
    for (const MaterialTable& material : tables.materials)
        for (std::size_t c = 0; c < channels; ++c) material_color[c].push_back(material.base_color[c]);
    quad_extent.resize(quad_extent.size() + small_table);
    for (auto& table : quad_normal) table.resize(table.size() + small_table);
    for (auto& table : material_color) table.resize(table.size() + small_table);
    sees_environment = EnvironmentKind(tables.environment.kind) != EnvironmentKind::none;
    filters[0].make_gaussian();
    filters[1].make_blackman_harris();
}

std::size_t LaneScene::memory_bytes() const
{
    return shape_info.size() * 4 + primitive_info.size() * 4 + 3 * quad_normal[0].size() * 4 +
           (is_flat ? 0 : bvh.memory_bytes());
}

}  // namespace FATHOM_LANES

std::unique_ptr<KernelScene> make_kernel_scene(std::shared_ptr<const SceneTables> tables)
{
    return std::make_unique<LaneScene>(std::move(tables));
}

int kernel_lanes() { return lanes; }
const char* kernel_name() { return lanes_name; }

}  // namespace fathom
