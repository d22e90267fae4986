// SPDX-License-Identifier: Apache-2.0
#include "geometry/displacement/texture_detail.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "compile/render_space.h"

namespace fathom {

namespace {

/// Number of parts per checker square, and per noise cell.
constexpr double parts_of_a_square = 16, parts_of_a_cell = 8;

Transform space_of(const ShadingTables& tables, const TextureRecord& t)
{
    Transform space;
    if (t.space == no_index) return space;
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t k = 0; k < 4; ++k) space.m[row][k] = double(tables.texture_spaces[t.space].rows[row][k]);
    return space;
}

/// An upper bound on the factor by which a transform scales lengths.
double stretch_of(const Transform& t)
{
    double squares = 0;
    for (const auto& row : t.m) squares += row[0] * row[0] + row[1] * row[1] + row[2] * row[2];
    return t.m == Transform().m ? 1 : std::sqrt(squares);
}

}  // namespace

TextureDetail::TextureDetail(const ShadingTables& tables, std::uint32_t texture)
{
    add(tables, texture, nullptr);
}

/// Adds the detail of a texture. outer: the texture coordinates computed by an enclosing uv_transform, or null for
/// those of the texture's own set.
void TextureDetail::add(const ShadingTables& tables, std::uint32_t texture, const UvMap* outer)
{
    if (texture == no_index) return;
    const TextureRecord& t = tables.textures[texture];
    const TextureMapping mapping = TextureMapping(t.mapping);
    const Transform space = space_of(tables, t);
    // Textures with other mappings ignore the coordinates of an enclosing uv_transform.
    const UvMap* const above = mapping == TextureMapping::uv ? outer : nullptr;
    UvMap map{above ? above->set : std::size_t(t.uv_set != 0),
              {},
              above ? above->mapping : mapping,
              above ? above->texture_from_mesh : space};
    for (std::size_t row = 0; row < 2; ++row)
        for (std::size_t k = 0; k < 2; ++k) {
            const double u = double(t.uv_map[3 * row]), v = double(t.uv_map[3 * row + 1]);
            map.rows[row][k] = above ? u * above->rows[0][k] + v * above->rows[1][k] : (k == 0 ? u : v);
        }
    const double scale = std::abs(double(t.scale)), in_space = scale * stretch_of(space);
    switch (TextureKind(t.kind)) {
        case TextureKind::image:
            add_uv(map, t.width, t.height);
            break;
        case TextureKind::checker_uv:
            add_uv(map, parts_of_a_square * scale, parts_of_a_square * scale);
            break;
        case TextureKind::checker_space:
            per_length_ = std::max(per_length_, parts_of_a_square * in_space / std::numbers::pi);
            break;
        case TextureKind::noise:
            per_length_ = std::max(per_length_, parts_of_a_cell * in_space);
            break;
        case TextureKind::turbulence:
        case TextureKind::marble:
        case TextureKind::fbm:
        case TextureKind::wrinkled:
        case TextureKind::windy:
        case TextureKind::veined_marble:
            // Each octave doubles the frequency and halves the height; octaves after the fourth hardly matter.
            per_length_ = std::max(per_length_, parts_of_a_cell * in_space * std::exp2(std::min(t.octaves, 4u) - 1));
            break;
        case TextureKind::dots:
            add_uv(map, parts_of_a_square * scale, parts_of_a_square * scale);
            break;
        case TextureKind::coordinates:
            add_uv(map, 1, 1);
            break;
        case TextureKind::uv_transform:
            return add(tables, t.texture_a, &map);
        case TextureKind::mix:
        case TextureKind::scale:
        case TextureKind::ramp:
        case TextureKind::vertex_color:
        case TextureKind::facing:
        case TextureKind::invert:
        case TextureKind::clamp:
            break;
    }
    for (const std::uint32_t part : {t.texture_a, t.texture_b, t.factor_texture}) add(tables, part, outer);
}

void TextureDetail::add_uv(UvMap map, double across, double down)
{
    for (std::size_t k = 0; k < 2; ++k) map.rows[0][k] *= across, map.rows[1][k] *= down;
    in_uv_.push_back(map);
}

/// Change of the texture coordinates from one vertex to another.
std::array<double, 2> TextureDetail::change(const UvMap& map, const Mesh& mesh, std::uint32_t a, std::uint32_t b)
{
    if (map.mapping == TextureMapping::uv) {
        const std::vector<Vec2f>& uv = mesh.uvs[map.set];
        if (uv.empty()) return {0, 0};
        return {double(uv[b].x) - double(uv[a].x), double(uv[b].y) - double(uv[a].y)};
    }
    const Vec3d p = map.texture_from_mesh.point(to_double(mesh.positions[a])),
                q = map.texture_from_mesh.point(to_double(mesh.positions[b]));
    if (map.mapping == TextureMapping::planar) return {q.x - p.x, q.y - p.y};
    const double turn = std::remainder(std::atan2(q.y, q.x) - std::atan2(p.y, p.x), 2 * std::numbers::pi);
    const double u = turn / (2 * std::numbers::pi);
    if (map.mapping == TextureMapping::cylindrical) return {u, q.z - p.z};
    const auto from_pole = [](Vec3d x) { return std::atan2(std::hypot(x.x, x.y), x.z) / std::numbers::pi; };
    return {u, from_pole(q) - from_pole(p)};
}

double TextureDetail::parts(const Mesh& mesh, std::uint32_t a, std::uint32_t b) const
{
    double parts = per_length_ * length(to_double(mesh.positions[b]) - to_double(mesh.positions[a]));
    for (const UvMap& map : in_uv_) {
        const auto [u, v] = change(map, mesh, a, b);
        for (const auto& row : map.rows) parts = std::max(parts, std::abs(row[0] * u + row[1] * v));
    }
    return parts;
}

}  // namespace fathom
