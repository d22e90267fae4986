#include "compile/displacement/texture_detail.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "compile/render_space.h"

namespace fathom {

namespace {

/// Of a square of a checker, or of a cell of noise.
constexpr double parts_of_a_square = 16, parts_of_a_cell = 8;

}  // namespace

TextureDetail::TextureDetail(const ShadingTables& tables, std::uint32_t texture)
{
    add(tables, texture, nullptr);
}

/// outer: the coordinates that a uv_transform above finds; else those of the texture's own set.
void TextureDetail::add(const ShadingTables& tables, std::uint32_t texture, const UvMap* outer)
{
    if (texture == no_index) return;
    const TextureRecord& t = tables.textures[texture];
    UvMap map{outer ? outer->set : std::size_t(t.uv_set != 0), {}};
    for (std::size_t row = 0; row < 2; ++row)
        for (std::size_t k = 0; k < 2; ++k) {
            const double u = double(t.uv_map[3 * row]), v = double(t.uv_map[3 * row + 1]);
            map.rows[row][k] = outer ? u * outer->rows[0][k] + v * outer->rows[1][k] : (k == 0 ? u : v);
        }
    const double scale = std::abs(double(t.scale));
    switch (TextureKind(t.kind)) {
        case TextureKind::image:
            add_uv(map, t.width, t.height);
            break;
        case TextureKind::checker_uv:
            add_uv(map, parts_of_a_square * scale, parts_of_a_square * scale);
            break;
        case TextureKind::checker_space:
            per_length_ = std::max(per_length_, parts_of_a_square * scale / std::numbers::pi);
            break;
        case TextureKind::noise:
            per_length_ = std::max(per_length_, parts_of_a_cell * scale);
            break;
        case TextureKind::turbulence:
        case TextureKind::marble:
            // Each octave is twice as fine and half as high; those after the fourth hardly matter.
            per_length_ = std::max(per_length_, parts_of_a_cell * scale * std::exp2(std::min(t.octaves, 4u) - 1));
            break;
        case TextureKind::uv_transform:
            return add(tables, t.texture_a, &map);
        case TextureKind::mix:
        case TextureKind::scale:
        case TextureKind::ramp:
        case TextureKind::vertex_color:
            break;
    }
    for (const std::uint32_t part : {t.texture_a, t.texture_b, t.factor_texture}) add(tables, part, outer);
}

void TextureDetail::add_uv(UvMap map, double across, double down)
{
    for (std::size_t k = 0; k < 2; ++k) map.rows[0][k] *= across, map.rows[1][k] *= down;
    in_uv_.push_back(map);
}

double TextureDetail::parts(const Mesh& mesh, std::uint32_t a, std::uint32_t b) const
{
    double parts = per_length_ * length(to_double(mesh.positions[b]) - to_double(mesh.positions[a]));
    for (const UvMap& map : in_uv_) {
        const std::vector<Vec2f>& uv = mesh.uvs[map.set];
        if (uv.empty()) continue;
        const double u = double(uv[b].x) - double(uv[a].x), v = double(uv[b].y) - double(uv[a].y);
        for (const auto& row : map.rows) parts = std::max(parts, std::abs(row[0] * u + row[1] * v));
    }
    return parts;
}

}  // namespace fathom
