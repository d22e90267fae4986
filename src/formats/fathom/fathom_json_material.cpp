// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "formats/fathom/fathom_json_reader.h"
#include "scene/conductors.h"
#include "scene/enum_names.h"
#include "scene/material_table.h"
#include "scene/texture_table.h"
#include "scene/units.h"

namespace fathom {

namespace {

void check_range(const JsonValue& v, double value, double least, double most)
{
    if (value < least || value > most) v.fail(fmt::format("must be between {} and {}, found {}", least, most, value));
}

/// Pairs of the name and the enumerator of each kind.
template <class Kind>
std::vector<std::pair<std::string, Kind>> words_of(std::span<const KindName<Kind>> kinds)
{
    std::vector<std::pair<std::string, Kind>> words;
    for (const KindName<Kind>& kind : kinds) words.emplace_back(kind.name, kind.kind);
    return words;
}

void check_most(const JsonValue& v, const Color& color, double most, const char* excess)
{
    if (std::max({color.r, color.g, color.b}) > most)
        v.fail(excess ? excess : fmt::format("must not be above {}", most));
}

/// Reads a number and checks it against the parameter's range.
template <class P>
double read_number(const JsonValue& v, const P& p)
{
    const double value = v.number();
    if (p.allows(value)) return value * p.unit;
    if (p.excludes_limits && p.most == P::unbounded) v.fail(fmt::format("must be above {}", p.least));
    if (p.excludes_limits) v.fail(fmt::format("must be above {} and below {}", p.least, p.most));
    if (p.most == P::unbounded && p.least == 0) v.fail("must not be negative");
    v.fail(fmt::format("must be between {} and {}, found {}", p.least, p.most, value));
}

/// Index of a word in the parameter's list.
template <class P>
std::size_t read_enumerator(const JsonValue& v, const P& p)
{
    return JsonObject::find_word(v, {p.words.begin(), p.words.end()});
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

int FathomJsonReader::measured(const JsonValue& v)
{
    if (v.string().empty()) v.fail("the path of a file is empty");
    return measured_.index_of(file_.parent_path() / v.string());
}

bool FathomJsonReader::is_decoded_by_use(const JsonValue& v)
{
    if (v.is_string()) {
        const JsonValue* named = table("textures");
        if (!named || !named->has(v.string())) return false;
        // The entry starts as false, which ends cycles; they are reported when the texture is read.
        const auto [found, is_new] = decoded_by_use_.try_emplace(v.string(), false);
        return is_new ? decoded_by_use_[v.string()] = is_decoded_by_use((*named)[v.string()]) : found->second;
    }
    if (!v.is_object() || v.has("color_space")) return false;
    if (v.has("image")) return true;
    for (const auto& [key, json] : v.json().items())
        if (is_decoded_by_use(v[key])) return true;
    return false;
}

void FathomJsonReader::read_textures()
{
    std::vector<std::string> names;
    for_each_named("textures", [&](const std::string& name, const JsonValue& v) {
        if (is_decoded_by_use(v)) return;
        textures_[{name, Use::color}] = int(scene_.textures.size() + names.size());
        names.push_back(name);
    });
    // Textures may refer to each other, so all get their indices before any is read.
    scene_.textures.resize(names.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
        open_textures_.insert(names[i]);
        Texture texture = read_texture((*table("textures"))[names[i]], names[i], Use::color);
        open_textures_.erase(names[i]);
        scene_.textures[i] = std::move(texture);
    }
}

int FathomJsonReader::texture(const JsonValue& v, Use use)
{
    if (v.is_object()) {
        if (!shared_textures_) return add_texture(v, "", use);
        const auto [found, is_new] = shared_textures_->try_emplace({v.json().dump(), use}, -1);
        if (is_new || found->second < 0) found->second = add_texture(v, "", use);
        return found->second;
    }
    if (!v.is_string()) v.fail_type("the name of a texture, or a texture");
    const std::string& name = v.string();
    if (open_textures_.contains(name)) v.fail(fmt::format("texture '{}' contains itself", name));
    const std::pair<std::string, Use> key = {name, is_decoded_by_use(v) ? use : Use::color};
    if (const auto found = textures_.find(key); found != textures_.end()) return found->second;
    open_textures_.insert(name);
    const int index = add_texture(find("textures", "texture", v), name, use);
    open_textures_.erase(name);
    return textures_[key] = index;
}

int FathomJsonReader::add_texture(const JsonValue& v, const std::string& name, Use use)
{
    Texture texture = read_texture(v, name, use);
    scene_.textures.push_back(std::move(texture));
    return int(scene_.textures.size()) - 1;
}

Texture FathomJsonReader::read_texture(const JsonValue& v, const std::string& name, Use use)
{
    Texture texture;
    texture.name = name;
    texture.color_space = use == Use::color ? ColorSpace::srgb : ColorSpace::linear;
    JsonObject o(v);
    o.read_enum("kind", words_of(texture_kinds()), texture.kind);
    read_parameters(o, texture_parameters(), std::uint32_t(texture.kind), use, texture);
    o.done(fmt::format("in a texture of kind '{}'", v.has("kind") ? v["kind"].string() : "image"));
    return texture;
}

template <class Owner>
void FathomJsonReader::read_parameters(JsonObject& o, std::span<const Parameter<Owner>> parameters, std::uint32_t kind,
                                       std::optional<Use> use, Owner& owner)
{
    for (const Parameter<Owner>& p : parameters) {
        if (!p.is_of(kind)) continue;
        const auto v = p.required ? o.require(p.key) : o.get(p.key);
        if (!v) continue;
        const auto read = [&](auto member) {
            using Member = decltype(member);
            if constexpr (std::is_same_v<Member, TextureReference<Owner>>)
                member(owner) = texture(*v, use.value_or(Use::data));
            else if constexpr (std::is_same_v<Member, ImageReference<Owner>>)
                member(owner) = image(*v);
            else if constexpr (std::is_same_v<Member, MeasuredReference<Owner>>)
                member(owner) = measured(*v);
            else if constexpr (std::is_same_v<Member, MaterialReference<Owner>>)
                member(owner) = material(*v);
            else
                read_value(*v, p, use, member(owner));
        };
        std::visit(read, p.member);
    }
}

template <class Owner, class T>
void FathomJsonReader::read_value(const JsonValue& v, const Parameter<Owner>& p, std::optional<Use> use, T& out)
{
    if constexpr (std::is_same_v<T, ColorInput>) {
        read_color(v, use.value_or(Use::color), out);
        check_most(v, out.value, p.most, p.excess);
    } else if constexpr (std::is_same_v<T, FloatInput>) {
        read_float(v, use.value_or(Use::data), out);
        check_range(v, out.value, p.least, p.most);
    } else if constexpr (std::is_same_v<T, Color>) {
        out = v.color();
        check_most(v, out, p.most, p.excess);
    } else if constexpr (std::is_same_v<T, Vec2f>) {
        out = v.vec2f();
    } else if constexpr (std::is_same_v<T, Vec3d>) {
        out = v.vec3d();
    } else if constexpr (std::is_same_v<T, Transform>) {
        out = transform(v);
    } else if constexpr (std::is_same_v<T, bool>) {
        out = p.words.empty() ? v.boolean() : read_enumerator(v, p) != 0;
    } else if constexpr (std::is_enum_v<T>) {
        out = T(read_enumerator(v, p));
    } else if constexpr (std::is_same_v<T, std::vector<RampStop>>) {
        out = read_stops(v);
    } else if constexpr (std::is_same_v<T, int>) {
        out = v.integer();
        check_range(v, out, p.least, p.most);
    } else {
        if constexpr (std::is_same_v<T, float>) v.single();  // checks the range of float
        out = T(read_number(v, p));
    }
}
template void FathomJsonReader::read_parameters<Light>(JsonObject&, std::span<const Parameter<Light>>, std::uint32_t,
                                                       std::optional<Use>, Light&);

std::vector<RampStop> FathomJsonReader::read_stops(const JsonValue& v)
{
    v.array(2);
    if (v.size() > 16) v.fail(fmt::format("at most 16 stops, found {}", v.size()));
    std::vector<RampStop> stops;
    for (std::size_t i = 0; i < v.size(); ++i) {
        const JsonValue pair = v[i];
        if (!pair.is_array() || pair.size() != 2) pair.fail_type("[number, color]");
        stops.push_back({pair[0].single(), pair[1].color()});
        if (i > 0 && !(stops[i - 1].position < stops[i].position)) pair.fail("the numbers of stops must increase");
    }
    return stops;
}

void FathomJsonReader::read_color(const JsonValue& v, Use use, ColorInput& out)
{
    if (v.is_string()) {
        out = {{1, 1, 1}, texture(v, use)};
    } else if (v.is_object()) {
        JsonObject input(v);
        out.value = {1, 1, 1};
        input.read("value", out.value);
        if (auto name = input.get("texture")) out.texture = texture(*name, use);
        input.done();
    } else {
        out.value = v.color();
    }
}

void FathomJsonReader::read_float(const JsonValue& v, Use use, FloatInput& out)
{
    if (v.is_string()) {
        out.value = 1;
        out.texture = texture(v, use);
    } else if (v.is_object()) {
        JsonObject input(v);
        out.value = 1;
        input.read("value", out.value);
        if (auto name = input.get("texture")) out.texture = texture(*name, use);
        input.read_word("channel", words::channels, out.channel);
        input.done();
    } else {
        out.value = v.single();
    }
}

void FathomJsonReader::read_emission_unit(JsonObject& o, Material& material)
{
    const std::vector<std::pair<std::string, double>> units = {{"nit", 1},
                                                               {"lm/m2", 1 / std::numbers::pi},
                                                               {"W/m2/sr", lumens_per_watt},
                                                               {"W/m2", lumens_per_watt / std::numbers::pi}};
    double nits = 1;
    o.read_enum("emission_unit", units, nits);
    Color& value = material.emission.radiance.value;
    value = {float(value.r * nits), float(value.g * nits), float(value.b * nits)};
}

/// Reads a metal by name or by its complex index of refraction, which determine its colors.
void FathomJsonReader::read_conductor(JsonObject& o, Material& material)
{
    const auto v = o.get("conductor");
    if (!v) return;
    for (const char* key : {"color", "edge_color", "conductor_eta", "conductor_k", "metallic"})
        if (o.value().has(key)) v->fail(fmt::format("replaces '{}': give only one of them", key));
    Conductor conductor{};
    if (v->is_string()) {
        std::vector<std::string> names;
        for (const Conductor& c : conductors()) names.emplace_back(c.name);
        conductor = conductors()[JsonObject::find_word(*v, names)];
    } else {
        JsonObject index(*v);
        conductor.eta = index.require("eta").color(), conductor.k = index.require("k").color();
        index.done();
    }
    const ConductorColors colors = colors_of(conductor);
    material.base_color.value = colors.base;
    if (material.kind != MaterialKind::principled) return;
    material.conductor.edge_color.value = colors.edge;
    material.conductor.eta = conductor.eta, material.conductor.k = conductor.k;
    material.metallic.value = 1;
}

int FathomJsonReader::material(const JsonValue& v)
{
    if (v.is_object()) return add_material(v, "");
    if (!v.is_string()) v.fail_type("the name of a material, or a material");
    const auto found = materials_.find(v.string());
    if (found == materials_.end()) find("materials", "material", v);
    return found->second;
}

void FathomJsonReader::read_materials()
{
    std::vector<std::string> names;
    for_each_named("materials", [&](const std::string& name, const JsonValue&) {
        materials_[name] = int(names.size());
        names.push_back(name);
    });
    // Materials may refer to each other, so all get their indices before any is read.
    scene_.materials.resize(names.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
        Material material = read_material((*table("materials"))[names[i]], names[i]);
        scene_.materials[i] = std::move(material);
    }
}

int FathomJsonReader::add_material(const JsonValue& v, const std::string& name)
{
    Material material = read_material(v, name);
    scene_.materials.push_back(std::move(material));
    return int(scene_.materials.size()) - 1;
}

Material FathomJsonReader::read_material(const JsonValue& v, const std::string& name)
{
    Material m;
    m.name = name;
    JsonObject o(v);
    o.read_enum("kind", words_of(material_kinds()), m.kind);
    // A material with alpha is blended unless alpha_mode says otherwise.
    if (v.has("alpha")) m.opacity.mode = AlphaMode::blend;
    read_parameters(o, material_parameters(), std::uint32_t(m.kind), {}, m);
    if (m.kind != MaterialKind::unlit) read_emission_unit(o, m);
    if (m.kind == MaterialKind::metal || m.kind == MaterialKind::principled) read_conductor(o, m);
    o.done(fmt::format("in a material of kind '{}'", v.has("kind") ? v["kind"].string() : "diffuse"));
    return m;
}

}  // namespace fathom
