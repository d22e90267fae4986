// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "fathom/vector.h"

namespace fathom {

/// An encoded image: PNG, JPEG, WebP, AVIF, HDR, EXR, PFM, KTX2 or a format of stb_image. It is either a file or a
/// block of bytes.
struct ImageFile {
    std::string name;              ///< Name of an embedded image, for messages.
    std::filesystem::path path;    ///< The file; empty if `bytes` are given.
    std::vector<std::byte> bytes;  ///< The encoded file, if it is embedded in the scene file.
};

/// Encoding of the 8- and 16-bit values of a color image. HDR, EXR and PFM are always linear.
enum class ColorSpace {
    srgb,   ///< sRGB transfer function (IEC 61966-2-1).
    linear  ///< No transfer function, for numbers and normals.
};
/// Continuation of an image texture outside texture coordinates 0 to 1.
enum class Wrap {
    repeat,     ///< The image is repeated.
    clamp,      ///< The nearest pixel of the border.
    mirror,     ///< The image is repeated, every other copy mirrored.
    black,      ///< 0, including alpha.
    octahedral  ///< The image continues across each edge, turned by 180 degrees, as octahedral maps of directions
                ///< require. Meant for both axes.
};

/// A color parameter: `value`, multiplied by the texture if there is one.
struct ColorInput {
    Color value{1, 1, 1};  ///< Constant factor.
    int texture = -1;      ///< Index into SceneDescription::textures; -1: none.
};
/// Channel number that selects the luminance of a texture: 0.2126 r + 0.7152 g + 0.0722 b.
inline constexpr int luminance_channel = 4;

/// A number parameter: `value`, multiplied by a channel of the texture if there is one.
struct FloatInput {
    float value = 1;   ///< Constant factor.
    int texture = -1;  ///< Index into SceneDescription::textures; -1: none.
    int channel = 0;   ///< Channel of the texture: 0 red, 1 green, 2 blue, 3 alpha, or luminance_channel.
};

/// Function that a texture computes. Here p is the position in the texture's space (world space by default), and u and
/// v are transformed texture coordinates. "From color_a to color_b by x" is color_a + x (color_b - color_a), without
/// limiting x.
enum class TextureKind {
    image,          ///< Image, looked up bilinearly or at the nearest pixel in full resolution.
    checker_uv,     ///< color_a where floor(scale u) + floor(scale v) is even, otherwise color_b.
    checker_space,  ///< color_b where sin(scale x) sin(scale y) sin(scale z) < 0, otherwise color_a.
    noise,          ///< From color_a to color_b by 0.5 (1 + n(scale p)) with Perlin noise n (Perlin 2002, hashed).
    turbulence,     ///< From color_a to color_b by the sum of |n(2^i scale p)| / 2^i over octaves i.
    marble,         ///< From color_a to color_b by 0.5 (1 + sin(scale z + turbulence_weight turbulence(p))).
    fbm,            ///< From color_a to color_b by the sum of gain^i n(1.99^i scale p) over octaves i, as in pbrt-v4.
    wrinkled,       ///< As fbm with |n| instead of n, plus 0.2 gain^octaves for the octaves that are left out.
    windy,          ///< From color_a to color_b by fbm(scale p) with 6 octaves times |fbm(0.1 scale p)| with 3.
    veined_marble,  ///< Bands of scale y + turbulence_weight fbm(scale p) in fixed grays, as pbrt-v4's marble.
    dots,           ///< color_b in disks of radius 0.35 in about half of the cells of (scale u, scale v), otherwise
                    ///< color_a; as in pbrt-v4.
    coordinates,    ///< Texture coordinates as a color: red is u, green is v, blue is 0.
    facing,         ///< From color_a to color_b by the absolute cosine between geometric normal and direction.
    mix,            ///< From color_a to color_b by factor.
    scale,          ///< color_a times color_b.
    uv_transform,   ///< color_a, with its texture evaluated at the transformed texture coordinates of this texture.
    ramp,           ///< Color of factor: linear interpolation between the colors of stops.
    vertex_color,   ///< Vertex color of the mesh; white if it has none.
    invert,         ///< 1 - color_a, at least 0.
    clamp,          ///< color_a, limited to 0 to 1.
};
/// Number of values of TextureKind.
inline constexpr int texture_kind_count = 20;

/// Source of the texture coordinates of image, checker_uv, dots, coordinates and uv_transform. Here (x, y, z) is the
/// position in the texture's space.
enum class TextureMapping {
    uv,           ///< Texture coordinates of the surface.
    spherical,    ///< u: angle about z, counted from x, over 2 pi; v: angle to z over pi.
    cylindrical,  ///< u: 0.5 plus the angle about z from -pi to pi over 2 pi; v: z.
    planar        ///< u: x; v: y.
};

/// A stop of a ramp: the color at a number.
struct RampStop {
    float position = 0;  ///< Number at which the ramp has this color.
    Color color;         ///< Color of the ramp at `position`.
};

/// A node of the texture graph. Its inputs may refer to other textures, up to 16 deep and without cycles. A texture has
/// three color channels and alpha; alpha is 1 where all inputs are constant colors.
struct Texture {
    std::string name;  ///< Name for messages and scene files; may be empty.
    /// Function that the texture computes. It decides which of the members below apply.
    TextureKind kind = TextureKind::image;

    // Members of kind image.
    int image = -1;                                     ///< Index into SceneDescription::images.
    ColorSpace color_space = ColorSpace::srgb;          ///< Encoding of 8- and 16-bit images.
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;  ///< Continuation of the image outside 0 to 1, along u and v.
    bool nearest = false;                               ///< Looks up the nearest pixel, not bilinearly.
    /// If not 0, the image (its first channel) is a height map, and the texture is its normal map. White is higher than
    /// black by this fraction of the image's width.
    float height_scale = 0;

    // Kinds image, checker_uv, dots, coordinates and uv_transform: texture coordinates are
    // uv_offset + rotation(uv_scale * uv).
    TextureMapping mapping = TextureMapping::uv;  ///< Source of the texture coordinates.
    int uv_set = 0;                               ///< Set of texture coordinates of the mesh, 0 or 1.
    Vec2f uv_offset{0, 0}, uv_scale{1, 1};        ///< Offset and scale of the texture coordinates.
    float uv_rotation = 0;                        ///< Rotation in radians, as in KHR_texture_transform.
    /// Places the texture in world space: for kinds that use p, and for all mappings except uv. Must not be singular.
    Transform world_from_texture;

    // Members of procedural kinds.
    float scale = 1;               ///< Frequency: all kinds whose formula has a scale.
    float turbulence_weight = 10;  ///< marble, veined_marble: strength of the distortion of the bands.
    int octaves = 7;               ///< turbulence, marble, fbm, wrinkled, veined_marble: number of octaves, 1 to 16.
    float gain = 0.5f;         ///< fbm, wrinkled, veined_marble: amplitude of an octave over that of the one before.
    Vec3d direction{0, 1, 0};  ///< facing: direction in world space, of any length above 0.
    /// Color inputs of all kinds whose formula has color_a and color_b.
    ColorInput color_a{{0, 0, 0}, -1}, color_b{{1, 1, 1}, -1};
    FloatInput factor;            ///< mix, ramp: the number that selects the color.
    std::vector<RampStop> stops;  ///< ramp: 2 to 16 stops in ascending order of position.
};

}  // namespace fathom
