// SPDX-License-Identifier: Apache-2.0
#include "formats/fathom/parameters_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/io/read_file.h"
#include "scene/enum_names.h"
#include "scene/light_table.h"
#include "scene/material_table.h"
#include "scene/texture_table.h"

namespace fathom {

namespace {

/// Writes the parameters of a material or texture from their table: the inverse of reading.
template <class Owner>
class ParameterWriter {
public:
    ParameterWriter(const Owner& owner, const ParameterNames& names) : owner_(owner), names_(names) {}

    void write(std::span<const Parameter<Owner>> parameters, std::uint32_t kind, Json& to) const
    {
        static const Owner made{};
        for (const Parameter<Owner>& p : parameters) {
            if (!p.is_of(kind)) continue;
            const auto value_of = [&](const Owner& owner) {
                return std::visit([&](auto member) { return value(p, owner, member); }, p.member);
            };
            Json json = value_of(owner_);
            if (p.required || p.default_by_use || json != value_of(made)) to[p.key] = std::move(json);
        }
    }

private:
    using P = Parameter<Owner>;

    template <class Member>
    Json value(const P& p, const Owner& owner, Member member) const
    {
        if constexpr (std::is_same_v<Member, TextureReference<Owner>>) {
            const int texture = member(owner);
            return texture < 0 ? Json() : Json(names_.textures[std::size_t(texture)]);
        } else if constexpr (std::is_same_v<Member, ImageReference<Owner>>) {
            const int image = member(owner);
            return image < 0 ? Json() : Json(names_.images[std::size_t(image)]);
        } else if constexpr (std::is_same_v<Member, MeasuredReference<Owner>>) {
            const int measured = member(owner);
            return measured < 0 ? Json() : Json(names_.measured[std::size_t(measured)]);
        } else if constexpr (std::is_same_v<Member, MaterialReference<Owner>>) {
            const int material = member(owner);
            return material < 0 ? Json() : Json(names_.materials[std::size_t(material)]);
        } else {
            return value(p, member(owner));
        }
    }

    template <class T>
    Json value(const P& p, const T& v) const
    {
        if constexpr (std::is_same_v<T, bool> || std::is_enum_v<T>) {
            return p.words.empty() ? Json(bool(v)) : Json(p.words[std::size_t(v)]);
        } else {
            const double value = double(v) / p.unit, limited = inside(p, value);
            return number_json(limited == value ? v : T(limited * p.unit), p.unit);
        }
    }
    Json value(const P& p, int v) const { return int(inside(p, v)); }
    Json value(const P& p, const Color& v) const { return color_json(inside(p, v)); }
    Json value(const P&, const Vec2f& v) const { return {number_json(v.x), number_json(v.y)}; }
    Json value(const P&, const Vec3d& v) const { return vector_json(v); }
    Json value(const P&, const Transform& t) const { return transform_json(t); }
    Json value(const P& p, const ColorInput& v) const { return input(color_json(inside(p, v.value)), v.texture, {}); }
    Json value(const P& p, const FloatInput& v) const
    {
        const auto* member = std::get_if<Field<Owner, FloatInput>>(&p.member);
        const bool is_usual = v.channel == (*member)(Owner{}).channel;
        return input(number_json(float(inside(p, v.value))), v.texture,
                     is_usual ? Json() : Json(words::channels[std::size_t(v.channel)]));
    }
    Json value(const P& p, const std::vector<RampStop>& stops) const
    {
        Json all = Json::array();
        for (const RampStop& stop : stops) {
            Json pair = Json::array();
            pair.push_back(number_json(stop.position));
            pair.push_back(color_json(inside(p, stop.color)));
            all.push_back(std::move(pair));
        }
        return all;
    }

    /// A parameter in JSON: its value, the name of its texture, or an object with both.
    Json input(Json value, int texture, Json channel) const
    {
        if (texture < 0 && channel.is_null()) return value;
        if (texture >= 0 && channel.is_null() && value == 1) return names_.textures[std::size_t(texture)];
        Json both = Json::object();
        if (value != 1) both["value"] = std::move(value);
        if (texture >= 0) both["texture"] = names_.textures[std::size_t(texture)];
        if (!channel.is_null()) both["channel"] = std::move(channel);
        return both;
    }

    /// The value clamped to the range that files allow, with a warning if it changes.
    double inside(const P& p, double v) const
    {
        const double limited = p.allows(v) ? v : std::clamp(v, p.least, p.most);
        if (limited != v)
            names_.warnings.add(fmt::format("{}: {}: {} of '{}' becomes {}, because files allow {} to {}", names_.file,
                                            p.key, v, printable(owner_.name), limited, p.least, p.most));
        return limited;
    }
    Color inside(const P& p, const Color& c) const
    {
        const auto channel = [&](float v) { return float(inside(p, double(v))); };
        return {channel(c.r), channel(c.g), channel(c.b)};
    }

    const Owner& owner_;
    const ParameterNames& names_;
};

template <class Kind>
const char* word_of(std::span<const KindName<Kind>> kinds, Kind kind)
{
    return std::find_if(kinds.begin(), kinds.end(), [&](const KindName<Kind>& k) { return k.kind == kind; })->name;
}

}  // namespace

Json color_json(Color c)
{
    if (c.r == c.g && c.g == c.b) return number_json(c.r);
    return {number_json(c.r), number_json(c.g), number_json(c.b)};
}

Json vector_json(const Vec3d& v)
{
    return {number_json(v.x), number_json(v.y), number_json(v.z)};
}

Json matrix_json(const Transform& t)
{
    Json rows = Json::array();
    for (const auto& row : t.m) {
        rows.push_back(Json::array());
        for (const double value : row) rows.back().push_back(number_json(value));
    }
    Json json = {{"matrix", std::move(rows)}};
    if (!std::isnormal(t.determinant())) json["flat"] = true;
    return json;
}

Json transform_json(const Transform& t)
{
    if (t.m == Transform().m) return {};
    const Vec3d way{t.m[0][3], t.m[1][3], t.m[2][3]};
    if (t.m == Transform::translate(way).m) return {{"translate", vector_json(way)}};
    return matrix_json(t);
}

Json material_json(const Material& material, const ParameterNames& names)
{
    Json json = Json::object();
    json["kind"] = word_of(material_kinds(), material.kind);
    ParameterWriter<Material>(material, names).write(material_parameters(), std::uint32_t(material.kind), json);
    // Without alpha, the mode `opaque` is the default.
    if (!json.contains("alpha") && material.opacity.mode == AlphaMode::opaque) json.erase("alpha_mode");
    return json;
}

void add_light_parameters(const Light& light, const ParameterNames& names, Json& to)
{
    ParameterWriter<Light>(light, names).write(light_parameters(), std::uint32_t(light.kind), to);
}

Json texture_json(const Texture& texture, const ParameterNames& names)
{
    Json json = Json::object();
    json["kind"] = word_of(texture_kinds(), texture.kind);
    ParameterWriter<Texture>(texture, names).write(texture_parameters(), std::uint32_t(texture.kind), json);
    return json;
}

}  // namespace fathom
