// SPDX-License-Identifier: Apache-2.0
#include "scene/texture_table.h"

#include <numbers>

#include "scene/enum_names.h"

namespace fathom {

namespace {

using P = Parameter<Texture>;
using enum TextureKind;

constexpr KindName<TextureKind> kinds[] = {
    {image, "image", "a picture"},
    {checker_uv, "checker_uv", "color_a where floor(scale u) + floor(scale v) is even, else color_b"},
    {checker_space, "checker_space",
     "color_b where sin(scale x) sin(scale y) sin(scale z) < 0 in world space, else color_a"},
    {noise, "noise", "Perlin noise of scale p, from color_a to color_b"},
    {turbulence, "turbulence", "sum of octaves of |noise|, each half of the last, from color_a (0) to color_b (1)"},
    {marble, "marble", "0.5 (1 + sin(scale z + turbulence_weight turbulence(p))), from color_a to color_b"},
    {fbm, "fbm",
     "fractal sum of Perlin's noise (2002): octaves 1.99 times as fine, gain times as high, from color_a (0) to "
     "color_b "
     "(1)"},
    {wrinkled, "wrinkled", "the same of |noise|, plus 0.2 gain^octaves"},
    {windy, "windy", "fbm(p) of 6 octaves times |fbm(p / 10)| of 3, both of gain 0.5, from color_a (0) to color_b (1)"},
    {veined_marble, "veined_marble", "bands of scale y, shaken by turbulence_weight fbm(scale p), in greys of its own"},
    {dots, "dots", "color_b in disks of radius 0.35, one in about half of the squares of uv, else color_a"},
    {coordinates, "coordinates", "where it is looked up: red u, green v"},
    {facing, "facing", "by |cos| of the geometric normal with direction, from color_a (0) to color_b (1)"},
    {mix, "mix", "from color_a (factor 0) to color_b (factor 1)"},
    {scale, "scale", "the product of two"},
    {uv_transform, "uv_transform", "another texture, looked up at transformed texture coordinates"},
    {ramp, "ramp", "a number as a colour: linear between stops"},
    {vertex_color, "vertex_color", "the mesh's vertex colours, white where it has none"},
    {invert, "invert", "1 - input, at least 0"},
    {clamp, "clamp", "input, limited to 0 to 1"},
};
static_assert(std::size(kinds) == texture_kind_count);

constexpr std::uint32_t two_colors =
    kind_bits(checker_uv, checker_space, noise, turbulence, marble, fbm, wrinkled, windy, dots, facing, mix);
constexpr std::uint32_t in_uv = kind_bits(image, checker_uv, dots, coordinates, uv_transform);
constexpr std::uint32_t in_space =
    kind_bits(checker_space, noise, turbulence, marble, fbm, wrinkled, windy, veined_marble);
constexpr std::uint32_t by_octaves = kind_bits(fbm, wrinkled, veined_marble);

constexpr const char* wraps[] = {"repeat", "clamp", "mirror", "black", "octahedral"};
constexpr const char* mappings[] = {"uv", "spherical", "cylindrical", "planar"};

const P parameters[] = {
    {.key = "image",
     .kinds = kind_bits(image),
     .member = ImageReference<Texture>{&Texture::image},
     .meaning = "path of a picture, relative to this file",
     .required = true},
    {.key = "color_space",
     .kinds = kind_bits(image),
     .member = &Texture::color_space,
     .meaning = "how 8- and 16-bit values are encoded; default: srgb where the texture is a colour, linear where it is "
                "a number or a normal",
     .words = words::color_spaces,
     .default_by_use = true},
    {.key = "wrap_u",
     .kinds = kind_bits(image),
     .member = &Texture::wrap_u,
     .meaning = "outside 0 to 1",
     .words = wraps},
    {.key = "wrap_v",
     .kinds = kind_bits(image),
     .member = &Texture::wrap_v,
     .meaning = "outside 0 to 1",
     .words = wraps},
    {.key = "lookup",
     .kinds = kind_bits(image),
     .member = &Texture::nearest,
     .meaning = "between pixels",
     .words = words::lookups},
    {"height_scale", kind_bits(image), &Texture::height_scale,
     "unless 0: the picture holds heights, white so many of its widths above black, and the texture is their normal "
     "map"},
    {"color_a", two_colors, &Texture::color_a, "first colour", 0},
    {"color_b", two_colors, &Texture::color_b, "second colour", 0},
    {.key = "input",
     .kinds = kind_bits(scale, uv_transform, invert, clamp),
     .member = &Texture::color_a,
     .meaning = "what is changed",
     .least = 0,
     .required = true},
    {"by", kind_bits(scale), &Texture::color_b, "what it is multiplied by", 0},
    {.key = "factor",
     .kinds = kind_bits(mix),
     .member = &Texture::factor,
     .meaning = "0: color_a, 1: color_b",
     .least = 0,
     .most = 1,
     .required = true},
    {.key = "input",
     .kinds = kind_bits(ramp),
     .member = &Texture::factor,
     .meaning = "the number, from 0 to 1",
     .least = 0,
     .most = 1,
     .required = true},
    {.key = "stops",
     .kinds = kind_bits(ramp),
     .member = &Texture::stops,
     .meaning = "pairs [number, colour] by ascending number, 2 to 16 of them",
     .least = 0,
     .required = true},
    {"scale", kind_bits(checker_uv, dots) | in_space, &Texture::scale, "multiplied with position or uv"},
    {"octaves", kind_bits(turbulence, marble) | by_octaves, &Texture::octaves, "how many", 1, 32},
    {"gain", by_octaves, &Texture::gain, "height of each octave by that of the one before", 0},
    {"turbulence_weight", kind_bits(marble, veined_marble), &Texture::turbulence_weight,
     "how much the bands are shaken"},
    {"direction", kind_bits(facing), &Texture::direction, "in the world; of any length but 0"},
    {.key = "mapping",
     .kinds = in_uv,
     .member = &Texture::mapping,
     .meaning = "texture coordinates of the surface, or by place: spherical and cylindrical about z, planar x and y",
     .words = mappings},
    {"transform", in_uv | in_space, &Texture::world_from_texture,
     "where the texture stands in the world; in uv only of a mapping by place"},
    {"uv_set", in_uv, &Texture::uv_set, "which set of texture coordinates", 0, 1},
    {"uv_offset", in_uv, &Texture::uv_offset, "added last"},
    {"uv_scale", in_uv, &Texture::uv_scale, "multiplied first"},
    {"uv_rotation_deg", in_uv, &Texture::uv_rotation, "rotation between scale and offset, as KHR_texture_transform",
     -P::unbounded, P::unbounded, std::numbers::pi / 180},
};

}  // namespace

std::span<const KindName<TextureKind>> texture_kinds()
{
    return kinds;
}
std::span<const Parameter<Texture>> texture_parameters()
{
    return parameters;
}
bool reads_uv(const Texture& texture)
{
    return (in_uv >> std::uint32_t(texture.kind) & 1) && texture.mapping == TextureMapping::uv;
}
bool reads_position(const Texture& texture)
{
    return ((in_space | in_uv) >> std::uint32_t(texture.kind) & 1) && !reads_uv(texture);
}

}  // namespace fathom
