#include "integrate/alpha.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "fathom/description.h"
#include "integrate/tables.h"

namespace fathom {

namespace {

// Scalar, and apart from lanes: it is called for one candidate hit at a time.

std::uint32_t mix(std::uint32_t x)
{
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

int wrapped(double x, int size, std::uint32_t mode)
{
    if (!(std::fabs(x) < 1e9)) return 0;
    const auto i = static_cast<long long>(x);
    if (mode == std::uint32_t(Wrap::clamp)) return int(std::clamp<long long>(i, 0, size - 1));
    if (mode == std::uint32_t(Wrap::repeat)) return int((i % size + size) % size);
    const long long r = (i % (2 * size) + 2 * size) % (2 * size);
    return int(std::min<long long>(r, 2 * size - 1 - r));
}

double texel_value(const SceneTables& tables, const TextureRecord& t, std::uint64_t index, std::uint32_t channel)
{
    if (TexelFormat(t.format) == TexelFormat::float4) return double(tables.texels[(t.texels + index) * 4 + channel]);
    const std::vector<std::uint32_t>& words = tables.packed_images[t.texels];
    const std::uint32_t pair =
        TexelFormat(t.format) == TexelFormat::halves || TexelFormat(t.format) == TexelFormat::shorts
            ? words[2 * index + channel / 2] >> (16 * (channel % 2)) & 0xffff
            : 0;
    switch (TexelFormat(t.format)) {
        case TexelFormat::shorts:
            return pair / 65535.0;
        case TexelFormat::halves: {
            const double magnitude = double(std::bit_cast<float>((pair & 0x7fff) << 13)) * 0x1p112;
            return pair & 0x8000 ? -magnitude : magnitude;
        }
        default:
            break;
    }
    const std::uint32_t code = words[index] >> (8 * channel) & 0xff;
    const bool is_srgb = TexelFormat(t.format) == TexelFormat::bytes_srgb && channel < 3;
    return is_srgb ? double(tables.linear_of_srgb[code]) : code / 255.0;
}

float image_value(const SceneTables& tables, const TextureRecord& t, std::uint32_t channel, float u, float v)
{
    const double x = double(u) * t.width - 0.5, y = double(v) * t.height - 0.5;
    const auto texel = [&](double tx, double ty) {
        const int ix = wrapped(tx, t.width, t.wrap_u), iy = wrapped(ty, t.height, t.wrap_v);
        return texel_value(tables, t, std::uint64_t(iy) * std::uint64_t(t.width) + std::uint64_t(ix), channel);
    };
    if (t.nearest) return float(texel(std::floor(x + 0.5), std::floor(y + 0.5)));
    const double x0 = std::floor(x), y0 = std::floor(y), fx = x - x0, fy = y - y0;
    const double top = texel(x0, y0) * (1 - fx) + texel(x0 + 1, y0) * fx;
    const double bottom = texel(x0, y0 + 1) * (1 - fx) + texel(x0 + 1, y0 + 1) * fx;
    return float(top * (1 - fy) + bottom * fy);
}

/// At a place of a triangle or quad, which a shape of the material shows.
float alpha_of(const SceneTables& t, const MaterialRecord& m, std::uint32_t primitive, float u, float v)
{
    const ShapeRecord& own = t.shapes[t.shape_of_primitive[primitive]];
    float alpha = m.alpha;
    const bool is_triangle = primitive < t.first_quad();
    const std::uint32_t* vertex = is_triangle ? &t.triangles[3 * std::size_t(primitive)] : nullptr;
    const float w = 1 - u - v;
    if (is_triangle && (own.flags & ShapeRecord::has_colors) && (m.flags & MaterialRecord::vertex_colored))
        alpha *= t.colors[vertex[0]].w * w + t.colors[vertex[1]].w * u + t.colors[vertex[2]].w * v;
    if (m.alpha_texture != no_index) {
        const TextureRecord& texture = t.textures[m.alpha_texture];
        float s = u, r = 1 - v;
        if (is_triangle) {
            const auto& uv = texture.uv_set ? t.uv1 : t.uv0;
            const bool has = own.flags & (texture.uv_set ? ShapeRecord::has_uv1 : ShapeRecord::has_uv0);
            s = has ? uv[vertex[0]].x * w + uv[vertex[1]].x * u + uv[vertex[2]].x * v : 0;
            r = has ? uv[vertex[0]].y * w + uv[vertex[1]].y * u + uv[vertex[2]].y * v : 0;
        }
        const auto& map = texture.uv_map;
        if (texture.kind == std::uint32_t(TextureKind::image))
            alpha *= image_value(t, texture, m.alpha_channel, map[0] * s + map[1] * r + map[2],
                                 map[3] * s + map[4] * r + map[5]);
    }
    return alpha;
}

}  // namespace

float alpha_share(const SceneTables& tables, std::uint32_t material, std::uint32_t primitive, float u, float v)
{
    const MaterialRecord& m = tables.materials[material];
    if (m.alpha_mode == std::uint32_t(AlphaMode::opaque) || primitive >= tables.first_sphere()) return 1;
    const float alpha = alpha_of(tables, m, primitive, u, v);
    if (m.alpha_mode == std::uint32_t(AlphaMode::mask)) return alpha >= m.alpha_cutoff ? 1.f : 0.f;
    return std::clamp(alpha, 0.f, 1.f);
}

bool alpha_passes(const void* context, std::uint32_t primitive, std::uint32_t instance, float u, float v)
{
    const auto& t = *static_cast<const SceneTables*>(context);
    const std::uint32_t shape = instance == no_index ? t.shape_of_primitive[primitive] : t.instances[instance].shape;
    const MaterialRecord& m = t.materials[t.shapes[shape].material];
    const float alpha = alpha_of(t, m, primitive, u, v);
    if (m.alpha_mode == std::uint32_t(AlphaMode::mask)) return alpha >= m.alpha_cutoff;
    if (alpha >= 1) return true;
    const std::uint32_t place =
        mix(std::bit_cast<std::uint32_t>(u) + mix(std::bit_cast<std::uint32_t>(v) + mix(primitive)));
    return float(place >> 8) * 0x1p-24f < alpha;
}

}  // namespace fathom
