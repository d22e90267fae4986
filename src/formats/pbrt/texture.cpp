// SPDX-License-Identifier: Apache-2.0
// Textures are read when something refers to them.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "formats/io/read_file.h"
#include "formats/pbrt/reader.h"

namespace fathom::pbrt {

namespace {

Color times(Color a, Color b)
{
    return {a.r * b.r, a.g * b.g, a.b * b.b};
}

Color between(Color a, Color b, float t)
{
    return {a.r + t * (b.r - a.r), a.g + t * (b.g - a.g), a.b + t * (b.b - a.b)};
}

Color gray(double value)
{
    const auto v = float(value);
    return {v, v, v};
}

bool is_within_unit(Color c)
{
    return std::min({c.r, c.g, c.b}) >= 0 && std::max({c.r, c.g, c.b}) <= 1;
}

/// The exponent for decoding an image's encoding; 0 for sRGB, which is not a power.
double gamma_of(const Parameters& of, const std::string& encoding)
{
    if (encoding == "sRGB") return 0;
    if (encoding == "linear") return 1;
    constexpr std::string_view start = "gamma ";
    double gamma = 0;
    if (encoding.starts_with(start)) {
        const char *const first = encoding.data() + start.size(), *const last = encoding.data() + encoding.size();
        if (std::from_chars(first, last, gamma).ptr != last) gamma = 0;
    }
    if (!(gamma > 0 && std::isfinite(gamma)))
        of.fail(fmt::format("'encoding' must be 'sRGB', 'linear' or 'gamma' with a number, found '{}'",
                            printable(encoding)));
    return gamma;
}

/// The largest difference between a power and the sRGB curve.
double distance_to_srgb(double gamma)
{
    double most = 0;
    for (int code = 0; code < 256; ++code) {
        const double v = code / 255.0, linear = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
        most = std::max(most, std::abs(std::pow(v, gamma) - linear));
    }
    return most;
}

/// Whether all values of a texture are known to lie in [0, 1].
bool is_within_unit(const SceneDescription& scene, const ColorInput& input)
{
    if (!is_within_unit(input.value)) return false;
    if (input.texture < 0) return true;
    const Texture& t = scene.textures[std::size_t(input.texture)];
    const auto number = [&](const FloatInput& f) { return is_within_unit(scene, {gray(double(f.value)), f.texture}); };
    switch (t.kind) {
        case TextureKind::image:
            return !t.name.ends_with(".exr") && !t.name.ends_with(".pfm") && !t.name.ends_with(".hdr");
        case TextureKind::checker_uv:
        case TextureKind::checker_space:
        case TextureKind::dots:
        case TextureKind::facing:
        case TextureKind::scale:
            return is_within_unit(scene, t.color_a) && is_within_unit(scene, t.color_b);
        case TextureKind::mix:
            return is_within_unit(scene, t.color_a) && is_within_unit(scene, t.color_b) && number(t.factor);
        case TextureKind::veined_marble:
        case TextureKind::invert:
        case TextureKind::clamp:
            return true;
        default:
            return false;
    }
}

}  // namespace

int Reader::add_texture(Texture texture)
{
    scene_.textures.push_back(std::move(texture));
    return int(scene_.textures.size()) - 1;
}

ColorInput Reader::texture(const Parameters& of, std::string_view parameter, bool is_float)
{
    const Parameter& p = *of.find(parameter);
    const std::string name = p.strings.size() == 1 ? p.strings[0] : "";
    auto& textures = is_float ? float_textures_ : color_textures_;
    const auto found = textures.find(name);
    if (found == textures.end())
        p.place.fail(
            fmt::format("there is no texture '{}' of type '{}'", printable(name), is_float ? "float" : "spectrum"));
    NamedTexture& named = found->second;
    if (named.input) return *named.input;
    if (named.is_open) p.place.fail("a texture can't contain itself");
    named.is_open = true;
    const ColorInput input = read_texture(named);
    named.is_open = false;
    named.input = input;
    named.plugin->finish(reporter_);
    return input;
}

ColorInput Reader::texture_operand(const Parameters& of, std::string_view name, bool is_float, float otherwise)
{
    const Parameter* const p = of.find(name);
    if (!p) return {gray(otherwise), -1};
    if (p->type == "texture") return texture(of, name, is_float);
    if (is_float) return {gray(of.number(name, otherwise)), -1};
    return {color_value(of, *p, false), -1};
}

ColorInput Reader::product(const ColorInput& a, const ColorInput& b)
{
    if (a.texture < 0 || b.texture < 0) return {times(a.value, b.value), std::max(a.texture, b.texture)};
    Texture scaled;
    scaled.kind = TextureKind::scale;
    scaled.color_a = a, scaled.color_b = b;
    return {{1, 1, 1}, add_texture(scaled)};
}

ColorInput Reader::mixed(const ColorInput& a, const ColorInput& b, const FloatInput& amount)
{
    if (a.texture < 0 && b.texture < 0 && amount.texture < 0) return {between(a.value, b.value, amount.value), -1};
    Texture mix;
    mix.kind = TextureKind::mix;
    mix.color_a = a, mix.color_b = b, mix.factor = amount;
    return {{1, 1, 1}, add_texture(mix)};
}

/// Clamps reflectances to [0, 1], as pbrt's materials do.
ColorInput Reader::limited(ColorInput input)
{
    if (is_within_unit(scene_, input)) return input;
    Texture limit;
    limit.kind = TextureKind::clamp;
    limit.color_a = input;
    return {{1, 1, 1}, add_texture(limit)};
}

ColorInput Reader::mixture(const NamedTexture& named)
{
    const Parameters& of = *named.plugin;
    const ColorInput a = texture_operand(of, "tex1", named.is_float, 0),
                     b = texture_operand(of, "tex2", named.is_float, 1);
    if (of.plugin() == "mix") return mixed(a, b, number_or_texture(of, "amount", 0.5f));
    Texture t;
    t.kind = TextureKind::facing;
    t.color_a = b, t.color_b = a;
    t.direction = named.world_from_texture.vector(of.vector("dir").value_or(Vec3d{0, 1, 0}));
    if (!(length(t.direction) > 0)) of.fail("'dir' is not a direction: all components are 0");
    return {{1, 1, 1}, add_texture(t)};
}

ColorInput Reader::read_texture(NamedTexture& named)
{
    const Parameters& of = *named.plugin;
    const std::string& type = of.plugin();
    const bool is_float = named.is_float;
    if (type == "constant") return texture_operand(of, "value", is_float, 1);
    if (type == "scale") return product(texture_operand(of, "tex", is_float, 1), texture_operand(of, "scale", true, 1));
    if (type == "mix" || type == "directionmix") return mixture(named);
    if (type == "imagemap") return image_map(named);
    if (type == "checkerboard") return checkerboard(named);
    if (type == "dots") return dots(named);
    if (type == "bilerp") return bilerp(named);
    return procedural(named);
}

ColorInput Reader::dots(const NamedTexture& named)
{
    const Parameters& of = *named.plugin;
    Texture t;
    t.kind = TextureKind::dots;
    // pbrt-v4 uses 'inside' between the dots and 'outside' within them.
    t.color_a = texture_operand(of, "inside", named.is_float, 1);
    t.color_b = texture_operand(of, "outside", named.is_float, 0);
    set_mapping(named, t, false);
    return {{1, 1, 1}, add_texture(t)};
}

/// Interpolates bilinearly by s and t, which a coordinates texture supplies.
ColorInput Reader::bilerp(const NamedTexture& named)
{
    const Parameters& of = *named.plugin;
    Texture place;
    place.kind = TextureKind::coordinates;
    set_mapping(named, place, false);
    const int st = add_texture(place);
    const auto side = [&](const char* at_0, const char* at_1, float otherwise) {
        return mixed(texture_operand(of, at_0, named.is_float, otherwise),
                     texture_operand(of, at_1, named.is_float, otherwise), {1, st, 0});
    };
    return mixed(side("v00", "v10", 0), side("v01", "v11", 1), {1, st, 1});
}

ColorInput Reader::procedural(const NamedTexture& named)
{
    const Parameters& of = *named.plugin;
    const std::string& type = of.plugin();
    Texture t;
    t.world_from_texture = world_from_texture(named);
    if (type == "fbm" || type == "wrinkled" || type == "marble") {
        t.kind = type == "fbm"        ? TextureKind::fbm
                 : type == "wrinkled" ? TextureKind::wrinkled
                                      : TextureKind::veined_marble;
        t.octaves = std::clamp(of.integer("octaves", 8), 1, 16);
        t.gain = float(of.number("roughness", 0.5));
        if (type == "marble") {
            t.scale = float(of.number("scale", 1));
            t.turbulence_weight = float(of.number("variation", 0.2));
        }
    } else if (type == "windy") {
        t.kind = TextureKind::windy;
    } else {
        report(of, type == "ptex" ? "Ptex files are not supported: gray 0.5 is used"
                                  : "is not supported: gray 0.5 is used");
        of.ignore({"filename", "encoding", "scale"});
        return {gray(0.5), -1};
    }
    return {{1, 1, 1}, add_texture(t)};
}

Transform Reader::world_from_texture(const NamedTexture& named)
{
    if (!std::isnormal(named.world_from_texture.determinant()))
        named.plugin->fail("the texture's transform must be invertible");
    return named.world_from_texture;
}

/// Sets the mapping that defines s and t. In pbrt, t grows upward on images. Patterns use s and t as u and v; for
/// images v is flipped, because Fathom's first row is at the top.
void Reader::set_mapping(const NamedTexture& named, Texture& texture, bool is_picture)
{
    const Parameters& of = *named.plugin;
    const std::string mapping = of.text("mapping", "uv");
    if (mapping == "spherical" || mapping == "cylindrical" || mapping == "planar") {
        texture.world_from_texture = world_from_texture(named);
        if (mapping == "planar") return set_plane(of, texture, is_picture);
        if (is_picture) texture.uv_offset.y = 1;
        texture.mapping = mapping == "spherical" ? TextureMapping::spherical : TextureMapping::cylindrical;
        if (mapping == "cylindrical") {
            texture.uv_scale.y = is_picture ? -1 : 1;
        } else {
            // In pbrt, s is the polar angle and t the azimuth; these are Fathom's v and u.
            texture.uv_rotation = float(std::numbers::pi / 2);
            texture.uv_scale.x = is_picture ? 1 : -1;
        }
        of.ignore({"uscale", "vscale", "udelta", "vdelta", "v1", "v2"});
        return;
    }
    if (mapping != "uv") report(of, fmt::format("the mapping '{}' is not supported: 'uv' is used", printable(mapping)));
    of.ignore({"v1", "v2"});
    const auto su = float(of.number("uscale", 1)), sv = float(of.number("vscale", 1)),
               du = float(of.number("udelta", 0)), dv = float(of.number("vdelta", 0));
    // Fathom's v of meshes grows downward.
    texture.uv_scale = {su, is_picture ? sv : -sv};
    texture.uv_offset = {du, is_picture ? 1 - sv - dv : sv + dv};
}

/// Planar mapping: s and t are dot products with two vectors, which become the x and y coordinates of texture space.
void Reader::set_plane(const Parameters& of, Texture& texture, bool is_picture)
{
    const Vec3d s = of.vector("v1").value_or(Vec3d{1, 0, 0}), t = of.vector("v2").value_or(Vec3d{0, 1, 0}),
                n = cross(s, t);
    Transform plane_from_texture;
    plane_from_texture.m = {{{s.x, s.y, s.z, 0}, {t.x, t.y, t.z, 0}, {n.x, n.y, n.z, 0}}};
    if (!std::isnormal(plane_from_texture.determinant())) of.fail("'v1' and 'v2' don't span a plane");
    texture.mapping = TextureMapping::planar;
    texture.world_from_texture = texture.world_from_texture * plane_from_texture.inverse();
    const auto ds = float(of.number("udelta", 0)), dt = float(of.number("vdelta", 0));
    texture.uv_scale = {1, is_picture ? -1.f : 1.f};
    texture.uv_offset = {ds, is_picture ? 1 - dt : dt};
    of.ignore({"uscale", "vscale"});
}

ColorInput Reader::checkerboard(const NamedTexture& named)
{
    const Parameters& of = *named.plugin;
    Texture t;
    t.color_a = texture_operand(of, "tex1", named.is_float, 1);
    t.color_b = texture_operand(of, "tex2", named.is_float, 0);
    const int dimension = of.integer("dimension", 2);
    if (dimension != 2 && dimension != 3) of.fail("'dimension' must be 2 or 3");
    if (dimension == 2) {
        t.kind = TextureKind::checker_uv;
        set_mapping(named, t, false);
    } else {
        t.kind = TextureKind::checker_space;
        t.scale = float(std::numbers::pi);
        t.world_from_texture = world_from_texture(named);
    }
    return {{1, 1, 1}, add_texture(t)};
}

int Reader::image(const Parameters& of)
{
    const std::string filename = of.text("filename", "");
    if (filename.empty()) of.fail("it needs a 'filename'");
    const std::filesystem::path file = locate(of, filename);
    const auto [found, is_new] = images_.emplace(file.string(), int(scene_.images.size()));
    if (is_new) scene_.images.push_back({filename, file, {}});
    return found->second;
}

ColorInput Reader::image_map(const NamedTexture& named)
{
    const Parameters& of = *named.plugin;
    Texture t;
    t.name = of.text("filename", "");
    t.image = image(of);
    const std::string wrap = of.text("wrap", "repeat"), filter = of.text("filter", "bilinear"),
                      encoding = of.text("encoding", "sRGB");
    t.wrap_u = t.wrap_v = wrap_of(of, wrap);
    t.nearest = filter == "point";
    // In pbrt only PNG files have an encoding.
    if (t.name.ends_with(".png") || t.name.ends_with(".PNG")) {
        const double gamma = gamma_of(of, encoding);
        t.color_space = gamma == 1 ? ColorSpace::linear : ColorSpace::srgb;
        if (gamma > 0 && gamma != 1)
            report(of, fmt::format("the encoding '{}' is approximated by 'sRGB': the error is up to {:.1g}",
                                   printable(encoding), distance_to_srgb(gamma)));
    }
    set_mapping(named, t, true);
    // Texture filtering makes no difference at many samples per pixel.
    of.ignore({"maxanisotropy"});
    const ColorInput input{gray(of.number("scale", 1)), add_texture(t)};
    if (!of.boolean("invert", false)) return input;
    Texture inverted;
    inverted.kind = TextureKind::invert;
    inverted.color_a = input;
    return {gray(1), add_texture(inverted)};
}

Wrap Reader::wrap_of(const Parameters& of, const std::string& name)
{
    if (name == "repeat") return Wrap::repeat;
    if (name == "black") return Wrap::black;
    if (name == "octahedralsphere") return Wrap::octahedral;
    if (name != "clamp")
        report(of, fmt::format("the wrap mode '{}' is not supported: 'clamp' is used", printable(name)));
    return Wrap::clamp;
}

}  // namespace fathom::pbrt
