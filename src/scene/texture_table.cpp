// SPDX-License-Identifier: Apache-2.0
#include "scene/texture_table.h"

#include "scene/enum_names.h"
#include "scene/units.h"

namespace fathom {

namespace {

using P = Parameter<Texture>;
using enum TextureKind;

constexpr KindName<TextureKind> kinds[] = {
    {image, "image", "an image"},
    {checker_uv, "checker_uv", "color_a where floor(scale u) + floor(scale v) is even, else color_b"},
    {checker_space, "checker_space",
     "color_b where sin(scale x) sin(scale y) sin(scale z) < 0 in world space, else color_a"},
    {noise, "noise", "Perlin noise of scale p, from color_a to color_b"},
    {turbulence, "turbulence",
     "sum of octaves of |noise|, each with half the amplitude of the one before, from color_a (0) to color_b (1)"},
    {marble, "marble", "0.5 (1 + sin(scale z + turbulence_weight turbulence(p))), from color_a to color_b"},
    {fbm, "fbm",
     "fractal sum of Perlin noise (2002): each octave has 1.99 times the frequency and gain times the amplitude of the "
     "one before, from color_a (0) to color_b (1)"},
    {wrinkled, "wrinkled", "fbm of |noise|, plus 0.2 gain^octaves"},
    {windy, "windy", "fbm(p) of 6 octaves times |fbm(p / 10)| of 3, both of gain 0.5, from color_a (0) to color_b (1)"},
    {veined_marble, "veined_marble",
     "bands along scale y, distorted by turbulence_weight fbm(scale p), in built-in grays"},
    {dots, "dots", "color_b in disks of radius 0.35, one in about half of the unit squares of uv, else color_a"},
    {coordinates, "coordinates", "texture coordinates of the lookup: u in red, v in green"},
    {facing, "facing",
     "by |cos| of the angle between the geometric normal and direction, from color_a (0) to color_b (1)"},
    {mix, "mix", "from color_a (factor 0) to color_b (factor 1)"},
    {scale, "scale", "the product of two textures or values"},
    {uv_transform, "uv_transform", "another texture, looked up at transformed texture coordinates"},
    {ramp, "ramp", "maps a number to a color, linearly between stops"},
    {vertex_color, "vertex_color", "the mesh's vertex colors; white if it has none"},
    {invert, "invert", "1 - input, at least 0"},
    {clamp, "clamp", "input, clamped to 0 to 1"},
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
     .member = ImageReference<Texture>{field<&Texture::image>},
     .meaning = "path of an image, relative to this file",
     .required = true},
    {.key = "color_space",
     .kinds = kind_bits(image),
     .member = field<&Texture::color_space>,
     .meaning = "how 8- and 16-bit values are encoded; default: srgb if the texture is a color, linear if it is a "
                "number or a normal",
     .words = words::color_spaces,
     .default_by_use = true},
    {.key = "wrap_u",
     .kinds = kind_bits(image),
     .member = field<&Texture::wrap_u>,
     .meaning = "lookup outside 0 to 1",
     .words = wraps},
    {.key = "wrap_v",
     .kinds = kind_bits(image),
     .member = field<&Texture::wrap_v>,
     .meaning = "lookup outside 0 to 1",
     .words = wraps},
    {.key = "lookup",
     .kinds = kind_bits(image),
     .member = field<&Texture::nearest>,
     .meaning = "lookup between pixels",
     .words = words::lookups},
    {"height_scale", kind_bits(image), field<&Texture::height_scale>,
     "if not 0: the image is a height map, whose white is this many image widths above black, and the texture is its "
     "normal map"},
    {"color_a", two_colors, field<&Texture::color_a>, "first color", 0},
    {"color_b", two_colors, field<&Texture::color_b>, "second color", 0},
    {.key = "input",
     .kinds = kind_bits(scale, uv_transform, invert, clamp),
     .member = field<&Texture::color_a>,
     .meaning = "input value",
     .least = 0,
     .required = true},
    {"by", kind_bits(scale), field<&Texture::color_b>, "factor", 0},
    {.key = "factor",
     .kinds = kind_bits(mix),
     .member = field<&Texture::factor>,
     .meaning = "0: color_a, 1: color_b",
     .least = 0,
     .most = 1,
     .required = true},
    {.key = "input",
     .kinds = kind_bits(ramp),
     .member = field<&Texture::factor>,
     .meaning = "the number, from 0 to 1",
     .least = 0,
     .most = 1,
     .required = true},
    {.key = "stops",
     .kinds = kind_bits(ramp),
     .member = field<&Texture::stops>,
     .meaning = "2 to 16 pairs [number, color], in increasing order",
     .least = 0,
     .required = true},
    {"scale", kind_bits(checker_uv, dots) | in_space, field<&Texture::scale>, "multiplied with position or uv"},
    {"octaves", kind_bits(turbulence, marble) | by_octaves, field<&Texture::octaves>, "number of octaves", 1, 32},
    {"gain", by_octaves, field<&Texture::gain>, "amplitude of each octave relative to the one before", 0},
    {"turbulence_weight", kind_bits(marble, veined_marble), field<&Texture::turbulence_weight>,
     "strength of the distortion of the bands"},
    {"direction", kind_bits(facing), field<&Texture::direction>, "world-space direction; its length must not be 0"},
    {.key = "mapping",
     .kinds = in_uv,
     .member = field<&Texture::mapping>,
     .meaning = "texture coordinates of the surface, or projected: spherical and cylindrical about z, planar x and y",
     .words = mappings},
    {"transform", in_uv | in_space, field<&Texture::world_from_texture>,
     "world-from-texture transform; for uv textures, only with a projected mapping"},
    {"uv_set", in_uv, field<&Texture::uv_set>, "which set of texture coordinates", 0, 1},
    {"uv_offset", in_uv, field<&Texture::uv_offset>, "added last"},
    {"uv_scale", in_uv, field<&Texture::uv_scale>, "multiplied first"},
    {"uv_rotation_deg", in_uv, field<&Texture::uv_rotation>,
     "rotation between scale and offset, as KHR_texture_transform", -P::unbounded, P::unbounded, radians_per_degree},
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
