#include "integrate/scene.h"

namespace fathom {

inline namespace FATHOM_LANES {

LaneScene::LaneScene(std::shared_ptr<const SceneTables> t) : tables_owner(std::move(t)), tables(*tables_owner)
{
    is_flat = FlatScene::fits(tables);
    if (is_flat) flat.build(tables);
    for (const ShapeTable& shape : tables.shapes) {
        const MaterialTable& material = tables.materials[shape.material];
        kinds |= 1u << material.bsdf;
        shape_info.push_back(shape.material | material.bsdf << kind_shift |
                             (shape.light_base != no_index || (material.flags & MaterialTable::emits) ? emits : 0u));
    }
    for (std::uint32_t shape : tables.shape_of_primitive) primitive_info.push_back(shape_info[shape]);
    for (const QuadTable& q : tables.quads) {
        const Vec3d n = normalize(cross(Vec3d{q.edge_u.x, q.edge_u.y, q.edge_u.z}, Vec3d{q.edge_v.x, q.edge_v.y, q.edge_v.z}));
        quad_normal[0].push_back(float(n.x));
        quad_normal[1].push_back(float(n.y));
        quad_normal[2].push_back(float(n.z));
    }
    for (const MaterialTable& material : tables.materials)
        for (int c = 0; c < channels; ++c) material_color[c].push_back(material.base_color[c]);
    for (auto* table : {&quad_normal[0], &quad_normal[1], &quad_normal[2]}) table->resize(tables.quads.size() + small_table);
    for (auto& table : material_color) table.resize(tables.materials.size() + small_table);
    primitive_info.resize(primitive_info.size() + small_table);
    textured = !tables.textures.empty();
    sees_environment = tables.environment.kind != 0;
}

std::size_t LaneScene::memory_bytes() const
{
    return shape_info.size() * 4 + primitive_info.size() * 4 + 3 * quad_normal[0].size() * 4;
}

}  // namespace FATHOM_LANES

std::unique_ptr<KernelScene> make_kernel_scene(std::shared_ptr<const SceneTables> tables)
{
    return std::make_unique<LaneScene>(std::move(tables));
}

int kernel_lanes() { return lanes; }
const char* kernel_name() { return lanes_name; }

}  // namespace fathom
