// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Texture mapping: from a point on a surface to the coordinates at which a texture is evaluated.
#include "textures/node.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// The point in the texture's own space.
inline Vec3 texture_space_point(const ShadingTables& tables, const TextureRecord& t, const TexturePoint& at)
{
    if (t.space == no_index) return at.p_world;
    const TextureSpaceRecord& space = tables.texture_spaces[t.space];
    const auto row = [&](std::size_t i) {
        const auto& r = space.rows[i];
        return fma(at.p_world.x, Float(r[0]),
                   fma(at.p_world.y, Float(r[1]), fma(at.p_world.z, Float(r[2]), Float(r[3]))));
    };
    return {row(0), row(1), row(2)};
}

/// Texture coordinates computed from a position.
struct MappedUv {
    Float u, v;
};

/// Texture coordinates by position, for the planar, cylindrical and spherical mappings.
[[gnu::noinline]] inline MappedUv mapped_uv(const ShadingTables& tables, const TextureRecord& t, const TexturePoint& at)
{
    const Vec3 p = texture_space_point(tables, t, at);
    if (TextureMapping(t.mapping) == TextureMapping::planar) return {p.x, p.y};
    const Float turn = atan2(p.y, p.x) * Float(0.5f * inv_pi);
    if (TextureMapping(t.mapping) == TextureMapping::cylindrical) return {turn + Float(0.5f), p.z};
    const Float from_axis = sqrt(fma(p.x, p.x, p.y * p.y));
    return {select(turn < Float(0), turn + Float(1), turn), atan2(from_axis, p.z) * Float(inv_pi)};
}

/// Texture coordinates of a texture's uv set or mapping, after its affine uv_map.
struct TextureUv {
    Float u, v;

    TextureUv(const ShadingTables& tables, const TextureRecord& t, const TexturePoint& at)
    {
        const int set = t.uv_set ? 1 : 0;
        MappedUv from{at.u[set], at.v[set]};
        if (TextureMapping(t.mapping) != TextureMapping::uv) from = mapped_uv(tables, t, at);
        u = fma(from.u, Float(t.uv_map[0]), fma(from.v, Float(t.uv_map[1]), Float(t.uv_map[2])));
        v = fma(from.u, Float(t.uv_map[3]), fma(from.v, Float(t.uv_map[4]), Float(t.uv_map[5])));
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
