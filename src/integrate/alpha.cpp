// SPDX-License-Identifier: Apache-2.0
/// This file is compiled for one lane (FATHOM_ONE_LANE), since traversal tests one candidate at a time. It evaluates
/// textures by the code that shading uses.
#include "integrate/alpha.h"

#include <bit>

#include "geometry/surface/vertex_attributes.h"
#include "kernel/tables.h"
#include "materials/opacity.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace {

static_assert(lanes == 1);

std::uint32_t shape_of(const SceneTables& t, const AlphaCandidate& c)
{
    return c.instance == no_index ? t.shape_of_primitive[c.primitive] : t.instances[c.instance].shape;
}

/// Texture coordinates and vertex colors of the candidate hit.
TexturePoint read_place(const SceneTables& t, const ShapeRecord& shape, const AlphaCandidate& c)
{
    TexturePoint at;
    for (Float& v : at.vertex_color) v = 1;
    const Vec3 o(c.origin[0], c.origin[1], c.origin[2]), d(c.direction[0], c.direction[1], c.direction[2]);
    at.p_world =
        fma(fma(d, c.t, o), Float(1 / t.render_scale), Vec3(Float(t.origin.x), Float(t.origin.y), Float(t.origin.z)));
    at.n_world = Vec3(0, 0, 0);
    // Images on quads are upright: edge_v points up, while v grows downward.
    const bool is_triangle = c.primitive < t.first_quad();
    for (int i = 0; i < 2; ++i) at.u[i] = is_triangle ? 0 : c.u, at.v[i] = is_triangle ? 0 : 1 - c.v;
    if (!is_triangle) return at;
    const std::uint32_t* vertex = &t.triangles[3 * std::size_t(c.primitive)];
    const TrianglePlace place{{vertex[0], vertex[1], vertex[2]}, c.u, c.v};
    const auto has = [&](ShapeRecord::Flags flag) { return (shape.flags & flag) != 0; };
    place.read_uv(t.uv0, has(ShapeRecord::has_uv0), at.u[0], at.v[0]);
    place.read_uv(t.uv1, has(ShapeRecord::has_uv1), at.u[1], at.v[1]);
    if (has(ShapeRecord::has_colors)) place.numbers(&t.colors[0].x, true, at.vertex_color);
    return at;
}

/// Random number in [0, 1), hashed from everything that distinguishes one decision from another.
Float random_number(const AlphaCandidate& c)
{
    UInt h = hash(c.primitive + hash(c.instance));
    for (const float x : {c.direction[0], c.direction[1], c.direction[2], c.origin[0], c.origin[1], c.origin[2]})
        h = hash(h + float_bits(x));
    return to_float(h >> 8) * 0x1p-24f;
}

Float opacity_of(const void* context, const AlphaCandidate& candidate)
{
    const auto& tables = *static_cast<const SceneTables*>(context);
    const ShapeRecord& shape = tables.shapes[shape_of(tables, candidate)];
    return opacity(tables, shape.material, read_place(tables, shape, candidate), true);
}

}  // namespace

}  // namespace FATHOM_LANES

bool alpha_passes(const void* context, const AlphaCandidate& candidate)
{
    const Float share = opacity_of(context, candidate);
    return share >= 1 || random_number(candidate) < share;
}

bool is_half_opaque(const void* context, const AlphaCandidate& candidate)
{
    return opacity_of(context, candidate) >= 0.5f;
}

}  // namespace fathom
