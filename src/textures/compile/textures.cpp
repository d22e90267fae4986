// SPDX-License-Identifier: Apache-2.0
#include "textures/compile/textures.h"

#include <algorithm>
#include <cmath>

#include "materials/compile/inputs.h"
#include "scene/texture_table.h"

namespace fathom {

namespace {

/// Index of the record of a texture's space; no_index if it is world space.
std::uint32_t compile_space(Compiler& c, const Transform& world_from_texture)
{
    if (world_from_texture.m == Transform().m) return no_index;
    const Transform inverse = world_from_texture.inverse();
    TextureSpaceRecord space;
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t k = 0; k < 4; ++k) space.rows[row][k] = float(inverse.m[row][k]);
    c.tables.texture_spaces.push_back(space);
    return std::uint32_t(c.tables.texture_spaces.size() - 1);
}

TextureRecord compile_texture(Compiler& c, const ImageStore& images, const Texture& texture)
{
    TextureRecord t;
    t.kind = std::uint32_t(texture.kind);
    if (texture.kind == TextureKind::image && texture.image >= 0) {
        const ImageStore::Texels texels = images.texture(texture);
        t.format = std::uint32_t(texels.format);
        t.texels = texels.place;
        t.width = texels.width;
        t.height = texels.height;
    }
    t.wrap_u = std::uint32_t(texture.wrap_u);
    t.wrap_v = std::uint32_t(texture.wrap_v);
    t.nearest = texture.nearest;
    t.uv_set = std::uint32_t(texture.uv_set);
    // KHR_texture_transform defines translation * rotation * scale, with a rotation that turns v towards u.
    const float cosine = std::cos(texture.uv_rotation), sine = std::sin(texture.uv_rotation);
    t.uv_map = {cosine * texture.uv_scale.x, sine * texture.uv_scale.y,   texture.uv_offset.x,
                -sine * texture.uv_scale.x,  cosine * texture.uv_scale.y, texture.uv_offset.y};
    t.mapping = std::uint32_t(texture.mapping);
    t.space = compile_space(c, texture.world_from_texture);
    t.scale = texture.scale;
    t.turbulence_weight = texture.turbulence_weight;
    t.gain = texture.gain;
    const Vec3f direction = to_float(normalize(texture.direction));
    t.direction = {direction.x, direction.y, direction.z};
    t.octaves = std::uint32_t(std::clamp(texture.octaves, 1, 16));
    const Color a = texture.color_a.value, b = texture.color_b.value;
    t.color_a = {a.r, a.g, a.b, 1};
    t.color_b = {b.r, b.g, b.b, 1};
    t.texture_a = texture_id(texture.color_a.texture);
    t.texture_b = texture_id(texture.color_b.texture);
    t.factor = texture.factor.value;
    t.factor_texture = texture_id(texture.factor.texture);
    t.factor_channel = std::uint32_t(texture.factor.channel);
    t.first_stop = std::uint32_t(c.tables.ramp_stops.size());
    t.stop_count = std::uint32_t(texture.stops.size());
    for (const RampStop& stop : texture.stops) c.tables.ramp_stops.push_back({stop.position, spectrum(stop.color)});
    return t;
}

}  // namespace

void compile_textures(Compiler& c, const ImageStore& images)
{
    // Parameters that the kind does not have are reset, so that they don't affect the scene's fingerprint.
    for (const Texture& texture : c.scene.textures)
        c.tables.textures.push_back(compile_texture(c, images, parameters_of_kind(texture, texture_parameters())));
}

}  // namespace fathom
