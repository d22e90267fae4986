// Textures, which are read when something asks for them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "import/common/read_file.h"
#include "import/pbrt/reader.h"

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

Color grey(double value)
{
    const auto v = float(value);
    return {v, v, v};
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
        p.place.fail(fmt::format("there is no texture '{}' of '{}'", printable(name), is_float ? "float" : "spectrum"));
    NamedTexture& named = found->second;
    if (named.input) return *named.input;
    if (named.is_open) p.place.fail("a texture can't contain itself");
    named.is_open = true;
    const ColorInput input = read_texture(named);
    named.is_open = false;
    named.input = input;
    named.plugin->finish(teller_);
    return input;
}

ColorInput Reader::texture_operand(const Parameters& of, std::string_view name, bool is_float, float otherwise)
{
    const Parameter* const p = of.find(name);
    if (!p) return {grey(otherwise), -1};
    if (p->type == "texture") return texture(of, name, is_float);
    if (is_float) return {grey(of.number(name, otherwise)), -1};
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

ColorInput Reader::mixture(const Parameters& of, bool is_float)
{
    const ColorInput a = texture_operand(of, "tex1", is_float, 0), b = texture_operand(of, "tex2", is_float, 1);
    if (of.plugin() == "directionmix") {
        tell(of, "the two are mixed alike in every direction");
        of.ignore({"dir"});
        return mixed(a, b, {0.5f, -1, 1});
    }
    return mixed(a, b, number_or_texture(of, "amount", 0.5f));
}

ColorInput Reader::read_texture(NamedTexture& named)
{
    const Parameters& of = *named.plugin;
    const std::string& type = of.plugin();
    const bool is_float = named.is_float;
    if (type == "constant") return texture_operand(of, "value", is_float, 1);
    if (type == "scale") return product(texture_operand(of, "tex", is_float, 1), texture_operand(of, "scale", true, 1));
    if (type == "mix" || type == "directionmix") return mixture(of, is_float);
    if (type == "imagemap") return image_map(of, is_float);
    if (type == "checkerboard") return checkerboard(named);
    if (type == "dots") {
        tell(of, "dots are not drawn: the mean of 'inside' and 'outside' is there");
        of.ignore({"mapping", "uscale", "vscale", "udelta", "vdelta", "v1", "v2"});
        // Half of the cells have a dot, whose radius is 0.35 of the cell.
        return mixed(texture_operand(of, "outside", is_float, 0), texture_operand(of, "inside", is_float, 1),
                     {0.19f, -1, 1});
    }
    if (type == "bilerp") {
        tell(of, "the mean of its four corners is there");
        const ColorInput low = mixed(texture_operand(of, "v00", is_float, 0), texture_operand(of, "v01", is_float, 1),
                                     {0.5f, -1, 1}),
                         high = mixed(texture_operand(of, "v10", is_float, 0), texture_operand(of, "v11", is_float, 1),
                                      {0.5f, -1, 1});
        of.ignore({"mapping", "uscale", "vscale", "udelta", "vdelta", "v1", "v2"});
        return mixed(low, high, {0.5f, -1, 1});
    }
    return procedural(named);
}

ColorInput Reader::procedural(const NamedTexture& named)
{
    const Parameters& of = *named.plugin;
    const std::string& type = of.plugin();
    Texture t;
    if (type == "fbm" || type == "windy") {
        t.kind = TextureKind::noise;
        t.color_a = {grey(type == "fbm" ? -1 : 0), -1};
        tell(of, "one octave of noise is there");
        of.ignore({"octaves", "roughness"});
    } else if (type == "wrinkled") {
        t.kind = TextureKind::turbulence;
        t.octaves = std::clamp(of.integer("octaves", 8), 1, 16);
        if (of.number("roughness", 0.5) != 0.5) tell(of, "each octave has half of the one before it");
    } else if (type == "marble") {
        t.kind = TextureKind::marble;
        t.octaves = std::clamp(of.integer("octaves", 8), 1, 16);
        t.scale = float(of.number("scale", 1));
        t.turbulence_weight = float(of.number("variation", 0.2)) * 10;
        t.color_a = {{0.2f, 0.2f, 0.3f}, -1}, t.color_b = {{0.58f, 0.58f, 0.6f}, -1};
        tell(of, "marble is Fathom's own, between two of its colours");
        of.ignore({"roughness"});
    } else {
        tell(of, type == "ptex" ? "Ptex files are not read: grey 0.5 instead" : "is not known: grey 0.5 instead");
        of.ignore({"filename", "encoding", "scale"});
        return {grey(0.5), -1};
    }
    if (named.world_from_texture.m != Transform().m) tell(of, "its pattern is one of the world's space");
    return {{1, 1, 1}, add_texture(t)};
}

void Reader::set_mapping(const Parameters& of, Texture& texture, bool is_picture)
{
    const std::string mapping = of.text("mapping", "uv");
    if (mapping != "uv") {
        tell(of, fmt::format("the mapping '{}' is taken as 'uv'", printable(mapping)));
        of.ignore({"v1", "v2"});
    }
    const auto su = float(of.number("uscale", 1)), sv = float(of.number("vscale", 1)),
               du = float(of.number("udelta", 0)), dv = float(of.number("vdelta", 0));
    // v grows upwards in pbrt. Of a picture the first row is at the top, of a pattern v is what counts.
    texture.uv_scale = {su, is_picture ? sv : -sv};
    texture.uv_offset = {du, is_picture ? 1 - sv - dv : sv + dv};
}

ColorInput Reader::checkerboard(const NamedTexture& named)
{
    const Parameters& of = *named.plugin;
    Texture t;
    t.color_a = texture_operand(of, "tex1", named.is_float, 1);
    t.color_b = texture_operand(of, "tex2", named.is_float, 0);
    const int dimension = of.integer("dimension", 2);
    if (dimension != 2 && dimension != 3) of.fail("'dimension' is 2 or 3");
    if (dimension == 2) {
        t.kind = TextureKind::checker_uv;
        set_mapping(of, t, false);
    } else {
        t.kind = TextureKind::checker_space;
        t.scale = float(std::numbers::pi);
        if (named.world_from_texture.m != Transform().m) tell(of, "its pattern is one of the world's space");
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

ColorInput Reader::image_map(const Parameters& of, bool is_float)
{
    Texture t;
    t.name = of.text("filename", "");
    t.image = image(of);
    const std::string wrap = of.text("wrap", "repeat"), filter = of.text("filter", "bilinear"),
                      encoding = of.text("encoding", "sRGB");
    if (wrap != "repeat" && wrap != "clamp")
        tell(of, fmt::format("the wrap '{}' is taken as 'clamp'", printable(wrap)));
    t.wrap_u = t.wrap_v = wrap == "repeat" ? Wrap::repeat : Wrap::clamp;
    t.nearest = filter == "point";
    // Only PNGs have an encoding in pbrt.
    if (t.name.ends_with(".png") || t.name.ends_with(".PNG")) {
        t.color_space = encoding == "linear" ? ColorSpace::linear : ColorSpace::srgb;
        if (encoding != "linear" && encoding != "sRGB") tell(of, "the encoding is taken as 'sRGB'");
    }
    set_mapping(of, t, true);
    // At many samples what filters over a pixel's footprint makes no difference.
    of.ignore({"maxanisotropy"});
    const double scale = of.number("scale", 1);
    ColorInput input{grey(scale), add_texture(t)};
    if (!of.boolean("invert", false)) return input;
    if (!is_float) tell(of, "a coloured picture is inverted by its green alone");
    input.value = grey(1);
    Texture inverted;
    inverted.kind = TextureKind::mix;
    inverted.color_a = {grey(1), -1}, inverted.color_b = {grey(0), -1};
    inverted.factor = {float(scale), input.texture, 1};
    return {grey(1), add_texture(inverted)};
}

}  // namespace fathom::pbrt
