// SPDX-License-Identifier: Apache-2.0
#include "kernel/quad_columns.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "geometry/ray.h"

namespace fathom {
inline namespace FATHOM_LANES {

bool QuadColumns::is_plain(const MaterialRecord& material)
{
    constexpr MaterialFeatures varied = MaterialFeature::textured | MaterialFeature::normal_mapped |
                                        MaterialFeature::bumped | MaterialFeature::vertex_colored;
    return material.closure == ClosureKind::none ||
           (material.closure == ClosureKind::diffuse && material.parameters_as<RoughRecord>().roughness == 0 &&
            !material.features.has_any(varied));
}

void QuadColumns::build(const SceneTables& tables, bool sheared)
{
    size_ = int(tables.quads.size());
    stride_ = std::max<std::size_t>(tables.quads.size() + 1, lookup_size);
    values_.assign(columns * stride_ + lookup_size, 0);
    for (std::size_t q = 0; q < tables.quads.size(); ++q) {
        const auto set = [&](int column, double value) { values_[std::size_t(column) * stride_ + q] = float(value); };
        const auto set_bits = [&](int column, std::uint32_t bits) {
            values_[std::size_t(column) * stride_ + q] = std::bit_cast<float>(bits);
        };
        const Vec3f eu = tables.quads[q].edge_u, ev = tables.quads[q].edge_v;
        const Vec3d u{eu.x, eu.y, eu.z}, v{ev.x, ev.y, ev.z};
        const Vec3d n = normalize(cross(u, v)), t = normalize(u);
        const Vec3f corner = tables.quads[q].corner;
        const Vec3d center = Vec3d{corner.x, corner.y, corner.z} + (u + v) * 0.5;
        set(first_center, center.x), set(first_center + 1, center.y), set(first_center + 2, center.z);
        set(0, n.x), set(1, n.y), set(2, n.z);
        set(3, t.x), set(4, t.y), set(5, t.z);
        const Vec3d size{std::max(std::abs(u.x), std::abs(v.x)), std::max(std::abs(u.y), std::abs(v.y)),
                         std::max(std::abs(u.z), std::abs(v.z))};
        const double along = std::abs(n.x) * size.x + std::abs(n.y) * size.y + std::abs(n.z) * size.z;
        const double largest = std::max({size.x, size.y, size.z});
        set(6, 0x1p-22 * along + (sheared ? double(rounding_of_shear) * largest : 0));

        const std::uint32_t primitive = tables.first_quad() + std::uint32_t(q);
        const ShapeRecord& shape = tables.shapes[tables.shape_of_primitive[primitive]];
        const MaterialRecord& material = tables.materials[shape.material];
        // Emission is on the front as the scene defines it; a mirroring transform swaps front and back.
        const bool flipped = (shape.flags & ShapeRecord::flipped) != 0;
        std::uint32_t flags = std::uint32_t(material.closure) << kind_shift;
        if (material.closure != ClosureKind::none) flags |= scatters;
        if (is_plain(material)) flags |= plain;
        const bool emits = material.features.has(MaterialFeature::emits),
                   two_sided = material.features.has(MaterialFeature::two_sided_emission);
        if (emits && (two_sided || !flipped)) flags |= emits_front;
        if (emits && (two_sided || flipped)) flags |= emits_back;
        if (material.features.has(MaterialFeature::unlit)) flags |= unlit;
        set_bits(7, flags);
        set_bits(8, shape.light_base == no_index ? no_index : shape.light_base + (primitive - shape.first_primitive));
        for (std::size_t c = 0; c < channels; ++c) {
            set(9 + int(c), material.base_color[c]);
            set(9 + channels + int(c), material.emission[c]);
        }
    }
}

}  // namespace FATHOM_LANES
}  // namespace fathom
