#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "import/common/units.h"
#include "import/fathom/fathom_json_reader.h"

namespace fathom {

namespace {

void check_range(const JsonValue& v, double value, double least, double most)
{
    if (value < least || value > most) v.fail(fmt::format("must be between {} and {}, found {}", least, most, value));
}

void read_wrap(JsonObject& o, Texture& texture)
{
    const std::vector<std::pair<std::string, Wrap>> words = {
        {"repeat", Wrap::repeat}, {"clamp", Wrap::clamp}, {"mirror", Wrap::mirror}};
    o.read_enum("wrap_u", words, texture.wrap_u);
    o.read_enum("wrap_v", words, texture.wrap_v);
}

void read_uv(JsonObject& o, Texture& texture)
{
    if (auto set = o.get("uv_set")) {
        texture.uv_set = set->integer();
        if (texture.uv_set != 0 && texture.uv_set != 1) set->fail("there are two sets, 0 and 1");
    }
    o.read("uv_offset", texture.uv_offset);
    o.read("uv_scale", texture.uv_scale);
    if (auto angle = o.get("uv_rotation_deg")) texture.uv_rotation = float(angle->number() * std::numbers::pi / 180);
}

}  // namespace

int FathomJsonReader::image(const JsonValue& v)
{
    const std::string& name = v.string();
    if (name.empty()) v.fail("the path of an image is empty");
    const auto [found, is_new] = images_.try_emplace(name, int(scene_.images.size()));
    if (is_new) scene_.images.push_back({name, file_.parent_path() / name, {}});
    return found->second;
}

int FathomJsonReader::texture(const JsonValue& v, Use use)
{
    if (v.is_object()) return add_texture(v, "", use);
    if (!v.is_string()) v.fail_type("the name of a texture, or a texture");
    const std::pair<std::string, Use> key = {v.string(), use};
    if (const auto found = textures_.find(key); found != textures_.end()) return found->second;
    return textures_[key] = add_texture(find("textures", "texture", v), v.string(), use);
}

int FathomJsonReader::add_texture(const JsonValue& v, const std::string& name, Use use)
{
    Texture texture;
    texture.name = name;
    JsonObject o(v);
    o.read_enum("kind",
                {{"image", TextureKind::image},
                 {"checker_uv", TextureKind::checker_uv},
                 {"checker_space", TextureKind::checker_space},
                 {"noise", TextureKind::noise},
                 {"turbulence", TextureKind::turbulence},
                 {"marble", TextureKind::marble}},
                texture.kind);
    if (texture.kind == TextureKind::image) {
        texture.image = image(o.require("image"));
        texture.color_space = use == Use::color ? ColorSpace::srgb : ColorSpace::linear;
        o.read_enum("color_space", {{"srgb", ColorSpace::srgb}, {"linear", ColorSpace::linear}}, texture.color_space);
        read_wrap(o, texture);
        const std::vector<std::pair<std::string, bool>> lookups = {{"bilinear", false}, {"nearest", true}};
        o.read_enum("lookup", lookups, texture.nearest);
    } else {
        o.read("color_a", texture.color_a);
        o.read("color_b", texture.color_b);
        o.read("scale", texture.scale);
    }
    if (texture.kind == TextureKind::image || texture.kind == TextureKind::checker_uv) read_uv(o, texture);
    if (texture.kind == TextureKind::turbulence || texture.kind == TextureKind::marble) {
        if (auto octaves = o.get("octaves")) {
            texture.octaves = octaves->integer();
            check_range(*octaves, texture.octaves, 1, 32);
        }
    }
    if (texture.kind == TextureKind::marble) o.read("turbulence_weight", texture.turbulence_weight);
    o.done(fmt::format("in a texture of kind '{}'", v.has("kind") ? v["kind"].string() : "image"));
    scene_.textures.push_back(texture);
    return int(scene_.textures.size()) - 1;
}

void FathomJsonReader::read_color(JsonObject& o, const char* key, ColorInput& out)
{
    const auto v = o.get(key);
    if (!v) return;
    if (v->is_string()) {
        out = {{1, 1, 1}, texture(*v, Use::color)};
    } else if (v->is_object()) {
        JsonObject input(*v);
        out.value = {1, 1, 1};
        input.read("value", out.value);
        if (auto name = input.get("texture")) out.texture = texture(*name, Use::color);
        input.done();
    } else {
        out.value = v->color();
    }
}

void FathomJsonReader::read_reflectance(JsonObject& o, const char* key, ColorInput& out)
{
    read_color(o, key, out);
    if (std::max({out.value.r, out.value.g, out.value.b}) > 1)
        o.value()[key].fail("a reflectance above 1 would make light out of nothing");
}

void FathomJsonReader::read_float(JsonObject& o, const char* key, FloatInput& out, double least, double most)
{
    const auto v = o.get(key);
    if (!v) return;
    if (v->is_string()) {
        out.value = 1;
        out.texture = texture(*v, Use::data);
    } else if (v->is_object()) {
        JsonObject input(*v);
        out.value = 1;
        input.read("value", out.value);
        if (auto name = input.get("texture")) out.texture = texture(*name, Use::data);
        const std::vector<std::pair<std::string, int>> channels = {{"r", 0}, {"g", 1}, {"b", 2}, {"a", 3}};
        input.read_enum("channel", channels, out.channel);
        input.done();
    } else {
        out.value = v->single();
    }
    check_range(*v, out.value, least, most);
}

void FathomJsonReader::read_emission(JsonObject& o, Material& material)
{
    read_color(o, "emission", material.emission);
    const std::vector<std::pair<std::string, double>> units = {{"nit", 1},
                                                               {"lm/m2", 1 / std::numbers::pi},
                                                               {"W/m2/sr", lumens_per_watt},
                                                               {"W/m2", lumens_per_watt / std::numbers::pi}};
    double nits = 1;
    o.read_enum("emission_unit", units, nits);
    Color& value = material.emission.value;
    value = {float(value.r * nits), float(value.g * nits), float(value.b * nits)};
    o.read("emission_two_sided", material.emission_two_sided);
}

int FathomJsonReader::material(const JsonValue& v)
{
    if (v.is_object()) return add_material(v, "");
    if (!v.is_string()) v.fail_type("the name of a material, or a material");
    const auto found = materials_.find(v.string());
    if (found == materials_.end()) find("materials", "material", v);
    return found->second;
}

int FathomJsonReader::add_material(const JsonValue& v, const std::string& name)
{
    Material m;
    m.name = name;
    JsonObject o(v);
    o.read_enum("kind",
                {{"diffuse", MaterialKind::diffuse},
                 {"metal", MaterialKind::metal},
                 {"fuzz_metal", MaterialKind::fuzz_metal},
                 {"glass", MaterialKind::glass},
                 {"principled", MaterialKind::principled},
                 {"unlit", MaterialKind::unlit},
                 {"none", MaterialKind::none}},
                m.kind);
    using enum MaterialKind;
    const auto is = [&](auto... kinds) { return ((m.kind == kinds) || ...); };

    if (is(unlit)) read_color(o, "color", m.base_color);
    if (is(diffuse, metal, fuzz_metal, principled)) read_reflectance(o, "color", m.base_color);
    if (is(diffuse, metal, glass, principled)) read_float(o, "roughness", m.roughness, 0, 1);
    if (is(principled)) read_float(o, "metallic", m.metallic, 0, 1);
    if (is(fuzz_metal)) {
        o.read("fuzz", m.fuzz);
        if (auto fuzz = o.get("fuzz")) check_range(*fuzz, m.fuzz, 0, 1);
    }
    if (is(glass, principled)) {
        if (auto ior = o.get("ior")) {
            m.ior = ior->single();
            check_range(*ior, m.ior, 0.01, 100);
        }
    }
    if (is(glass)) {
        read_reflectance(o, "color", m.transmission_color);
        o.read("thin", m.thin);
        if (auto color = o.get("attenuation_color")) {
            m.attenuation_color = color->color();
            const auto [r, g, b] = m.attenuation_color;
            if (std::max({r, g, b}) > 1) color->fail("must not be above 1: glass takes light away");
        }
        if (auto distance = o.get("attenuation_distance")) {
            m.attenuation_distance = distance->number();
            if (m.attenuation_distance < 0) distance->fail("must not be negative");
        }
    }
    if (!is(unlit)) read_emission(o, m);
    if (!is(unlit, none)) {
        if (auto map = o.get("normal_map")) m.normal_texture = texture(*map, Use::data);
        o.read("normal_scale", m.normal_scale);
    }
    if (!is(none)) {
        read_float(o, "alpha", m.alpha, 0, 1);
        // Whoever gives an alpha wants to see it.
        if (v.has("alpha")) m.alpha_mode = AlphaMode::blend;
        o.read_enum("alpha_mode",
                    {{"opaque", AlphaMode::opaque}, {"mask", AlphaMode::mask}, {"blend", AlphaMode::blend}},
                    m.alpha_mode);
        o.read("alpha_cutoff", m.alpha_cutoff);
        o.read("use_vertex_color", m.use_vertex_color);
    }
    o.done(fmt::format("in a material of kind '{}'", v.has("kind") ? v["kind"].string() : "diffuse"));
    scene_.materials.push_back(std::move(m));
    return int(scene_.materials.size()) - 1;
}

}  // namespace fathom
