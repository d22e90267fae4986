// SPDX-License-Identifier: Apache-2.0
/// Writes the parts of docs/scene.schema.json that follow from the tables of materials and textures
/// (src/scene/material_table.cpp, texture_table.cpp): scene_schema FILE. With --check it only reports whether they are
/// up to date.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "formats/fathom/parameters_json.h"
#include "scene/conductors.h"
#include "scene/light_table.h"
#include "scene/material_table.h"
#include "scene/texture_table.h"

namespace fathom {

namespace {

Json number(double value, bool single)
{
    return single ? number_json(float(value)) : number_json(value);
}

Json reference(const std::string& name)
{
    return {{"$ref", "#/$defs/" + name}};
}

template <class Owner>
void add_bounds(Json& json, const Parameter<Owner>& p)
{
    if (p.least != p.unbounded && p.least != -p.unbounded)
        json[p.excludes_limits ? "exclusiveMinimum" : "minimum"] = number(p.least, false);
    if (p.most != p.unbounded) json[p.excludes_limits ? "exclusiveMaximum" : "maximum"] = number(p.most, false);
}

/// Schema of a parameter's type, and its default.
template <class Owner, class Member>
Json type_of(const Parameter<Owner>& p, Member member, Json& value)
{
    static const Owner made{};
    Json json = Json::object();
    if constexpr (std::is_same_v<Member, TextureReference<Owner>>) {
        return reference("textureInput");
    } else if constexpr (std::is_same_v<Member, ImageReference<Owner>> ||
                         std::is_same_v<Member, MeasuredReference<Owner>>) {
        return {{"type", "string"}};
    } else if constexpr (std::is_same_v<Member, MaterialReference<Owner>>) {
        return {{"oneOf", {{{"type", "string"}}, reference("material")}}};
    } else {
        const auto& out = member(made);
        using T = std::decay_t<decltype(out)>;
        if (!p.words.empty()) {
            for (const char* word : p.words) json["enum"].push_back(word);
            if constexpr (std::is_enum_v<T> || std::is_same_v<T, bool>) value = p.words[std::size_t(out)];
        } else if constexpr (std::is_same_v<T, ColorInput>) {
            value = color_json(out.value);
            return reference(p.most == 1 ? "reflectanceInput" : "colorInput");
        } else if constexpr (std::is_same_v<T, FloatInput>) {
            value = number(double(out.value), true);
            return reference(p.most == 1 ? "unitInput" : p.least < 0 ? "signedInput" : "numberInput");
        } else if constexpr (std::is_same_v<T, Color>) {
            value = color_json(out);
            return reference(p.most == 1 ? "reflectance" : "color");
        } else if constexpr (std::is_same_v<T, Vec2f>) {
            value = {number(double(out.x), true), number(double(out.y), true)};
            return reference("vec2");
        } else if constexpr (std::is_same_v<T, Vec3d>) {
            value = {number(out.x, false), number(out.y, false), number(out.z, false)};
            return reference("vec3");
        } else if constexpr (std::is_same_v<T, Transform>) {
            return reference("transform");
        } else if constexpr (std::is_same_v<T, std::vector<RampStop>>) {
            json = {{"type", "array"}, {"minItems", 2}, {"maxItems", 16}};
            json["items"] = {{"type", "array"},
                             {"prefixItems", {{{"type", "number"}}, reference("color")}},
                             {"minItems", 2},
                             {"maxItems", 2}};
        } else if constexpr (std::is_same_v<T, bool>) {
            json["type"] = "boolean";
            value = out;
        } else if constexpr (std::is_arithmetic_v<T>) {
            json["type"] = std::is_same_v<T, int> ? "integer" : "number";
            add_bounds(json, p);
            value = number(double(out) / p.unit, std::is_same_v<T, float>);
        }
    }
    return json;
}

template <class Owner>
Json property(const Parameter<Owner>& p)
{
    Json value;
    Json json = std::visit([&](auto member) { return type_of(p, member, value); }, p.member);
    json["description"] = p.meaning;
    if (!value.is_null() && !p.required && !p.default_by_use) json["default"] = value;
    return json;
}

Json conductor()
{
    Json names = Json::array();
    for (const Conductor& c : conductors()) names.push_back(c.name);
    const Json index = {{"type", "object"},
                        {"properties", {{"eta", reference("color")}, {"k", reference("color")}}},
                        {"required", {"eta", "k"}},
                        {"additionalProperties", false}};
    return {{"description", "a metal, by name or by its complex index of refraction; sets its colors"},
            {"oneOf", {{{"enum", names}}, index}}};
}

template <class Owner, class Kind>
Json kinds(std::span<const KindName<Kind>> names, std::span<const Parameter<Owner>> parameters, Kind default_kind)
{
    Json all = Json::array();
    for (const KindName<Kind>& name : names) {
        Json properties = {{"kind", {{"const", name.name}}}};
        Json required = Json::array();
        if (name.kind != default_kind) required.push_back("kind");
        for (const Parameter<Owner>& p : parameters) {
            if (!p.is_of(std::uint32_t(name.kind))) continue;
            properties[p.key] = property(p);
            if (p.required) required.push_back(p.key);
            if (std::string(p.key) == "emission")
                properties["emission_unit"] = {{"description", "unit of emission"},
                                               {"enum", {"nit", "lm/m2", "W/m2/sr", "W/m2"}},
                                               {"default", "nit"}};
        }
        if constexpr (std::is_same_v<Kind, MaterialKind>)
            if (name.kind == MaterialKind::metal || name.kind == MaterialKind::principled)
                properties["conductor"] = conductor();
        properties["comment"] = reference("comment");
        Json kind = {{"type", "object"}, {"description", name.meaning}, {"properties", properties}};
        if (!required.empty()) kind["required"] = required;
        kind["additionalProperties"] = false;
        all.push_back(kind);
    }
    return {{"oneOf", all}};
}

/// Schema of the keys that several kinds of lights share.
Json light_properties(const LightKindInfo& info)
{
    const auto vector = [](const char* meaning, const Json& value) {
        Json json = reference("vec3");
        json["description"] = meaning, json["default"] = value;
        return json;
    };
    Json color = reference("color");
    color["description"] = "multiplies intensity", color["default"] = 1;
    Json units = Json::array();
    for (const LightUnit& unit : info.units) units.push_back(unit.name);
    Json json = {{"kind", {{"const", info.kind.name}}},
                 {"name", {{"type", "string"}, {"description", "for messages"}}},
                 {"color", color},
                 {"intensity", {{"type", "number"}, {"description", "in unit"}, {"minimum", 0}, {"default", 1}}},
                 {"unit", {{"description", info.unit_meaning}, {"enum", units}, {"default", units[0]}}}};
    if (info.has_position) json["position"] = vector("meters", {0, 0, 0});
    if (info.direction_meaning) json["direction"] = vector(info.direction_meaning, {0, 0, -1});
    if (info.up_meaning) json["up"] = vector(info.up_meaning, {0, 1, 0});
    if (!info.image_meaning) return json;
    json["image"] = {{"type", "string"}, {"description", info.image_meaning}, {"minLength", 1}};
    json["color_space"] = {{"description", "how 8- and 16-bit values of the image are encoded"},
                           {"enum", {"srgb", "linear"}},
                           {"default", "srgb"}};
    json["lookup"] = {
        {"description", "lookup between pixels"}, {"enum", {"bilinear", "nearest"}}, {"default", "bilinear"}};
    return json;
}

Json lights()
{
    Json all = Json::array();
    for (const LightKindInfo& info : light_kinds()) {
        Json properties = light_properties(info);
        for (const Parameter<Light>& p : light_parameters())
            if (p.is_of(std::uint32_t(info.kind.kind))) properties[p.key] = property(p);
        properties["comment"] = reference("comment");
        Json required = {"kind"};
        if (info.needs_image) required.push_back("image");
        all.push_back({{"type", "object"},
                       {"description", info.kind.meaning},
                       {"properties", properties},
                       {"required", required},
                       {"additionalProperties", false}});
    }
    return {{"oneOf", all}};
}

int run(const std::string& file, bool check)
{
    std::ifstream in(file);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    Json schema = Json::parse(text);
    schema["$defs"]["texture"] = kinds(texture_kinds(), texture_parameters(), TextureKind::image);
    schema["$defs"]["material"] = kinds(material_kinds(), material_parameters(), MaterialKind::diffuse);
    schema["$defs"]["light"] = lights();
    const std::string made = json_text(schema);
    if (made == text) return 0;
    if (check) {
        std::fprintf(stderr,
                     "%s is not what the lists of materials, textures and lights make of it: run scene_schema on it\n",
                     file.c_str());
        return 1;
    }
    std::ofstream(file) << made;
    return 0;
}

}  // namespace

}  // namespace fathom

int main(int argc, char** argv)
{
    const bool check = argc == 3 && std::string(argv[1]) == "--check";
    if (argc != 2 && !check) {
        std::fprintf(stderr, "usage: scene_schema [--check] docs/scene.schema.json\n");
        return 2;
    }
    return fathom::run(argv[argc - 1], check);
}
