// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <optional>

#include "formats/fathom/fathom_json_reader.h"
#include "scene/enum_names.h"
#include "scene/light_table.h"
#include "scene/units.h"

namespace fathom {

namespace {

/// A rotation that maps -z, the direction of lights, to `direction`, and +y toward `up` if it is given.
Transform light_rotation(Vec3d direction, const std::optional<Vec3d>& up)
{
    const Vec3d z = -normalize(direction);
    const Vec3d other = up ? normalize(*up) : std::abs(z.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
    const Vec3d x = normalize(cross(other, z)), y = cross(z, x);
    Transform t;
    t.m = {{{x.x, y.x, z.x, 0}, {x.y, y.y, z.y, 0}, {x.z, y.z, z.z, 0}}};
    return t;
}

/// Names of all kinds, for a message.
std::string all_kinds()
{
    std::string text;
    const auto kinds = light_kinds();
    for (std::size_t i = 0; i < kinds.size(); ++i)
        text += (i == 0 ? "" : i + 1 < kinds.size() ? ", " : " or ") + std::string(kinds[i].kind.name);
    return text;
}

void read_kind(JsonObject& o, const JsonValue& v, Light& light)
{
    if (!v.has("kind")) v.fail("key 'kind' is missing: expected " + all_kinds());
    std::vector<std::pair<std::string, LightKind>> names;
    for (const LightKindInfo& info : light_kinds()) names.emplace_back(info.kind.name, info.kind.kind);
    o.read_enum("kind", names, light.kind);
}

/// Reads the brightness. Without a unit, intensity_is_flux stays false.
void read_intensity(JsonObject& o, const JsonValue& v, Light& light)
{
    Color color{1, 1, 1};
    o.read("color", color);
    double intensity = 1;
    o.read("intensity", intensity);
    if (intensity < 0) v["intensity"].fail("must not be negative");
    std::vector<std::pair<std::string, LightUnit>> units;
    for (const LightUnit& unit : info_of(light.kind).units) units.emplace_back(unit.name, unit);
    LightUnit unit = units.front().second;
    o.read_enum("unit", units, unit);
    light.intensity_is_flux = unit.is_flux;
    const double factor = intensity * (unit.factor * (unit.is_radiometric ? lumens_per_watt : 1));
    light.intensity = {float(color.r * factor), float(color.g * factor), float(color.b * factor)};
}

}  // namespace

/// Reads the image of a light. False if the light has none, so that rotation about its direction has no effect.
bool FathomJsonReader::read_picture(JsonObject& o, const LightKindInfo& info, Light& light)
{
    if (!info.image_meaning) return false;
    const std::optional<JsonValue> path = info.needs_image ? o.require("image") : o.get("image");
    if (!path && info.up_needs_image) return false;
    if (path) light.picture.image = image(*path);
    o.read_word("color_space", words::color_spaces, light.picture.color_space);
    o.read_word("lookup", words::lookups, light.picture.nearest);
    return true;
}

FathomJsonReader::Placed FathomJsonReader::add_light(const JsonValue& v, const std::string& name)
{
    Light light;
    light.name = name;
    Placed placed;
    JsonObject o(v);
    o.read("name", light.name);
    read_kind(o, v, light);
    const LightKindInfo& info = info_of(light.kind);
    read_intensity(o, v, light);
    if (info.has_position) {
        Vec3d position;
        o.read("position", position);
        placed.place = Transform::translate(position);
    }
    read_parameters(o, light_parameters(), std::uint32_t(light.kind), {}, light);
    if (light.kind == LightKind::spot && (light.inner_angle > light.outer_angle || light.outer_angle == 0))
        v.fail("'outer_angle_deg' must be greater than 0 and not less than 'inner_angle_deg'");
    const bool has_picture = read_picture(o, info, light),
               has_up = info.up_meaning && (has_picture || !info.up_needs_image);
    if (info.direction_meaning) {
        Vec3d direction{0, 0, -1};
        o.read("direction", direction);
        if (length(direction) == 0) v["direction"].fail("must not have zero length");
        std::optional<Vec3d> up;
        if (has_up && v.has("up")) {
            o.read("up", up.emplace());
            if (length(cross(*up, direction)) <= 1e-9 * length(*up) * length(direction))
                v["up"].fail("must not have zero length or be parallel to 'direction'");
        }
        placed.place = placed.place * light_rotation(direction, up);
    }
    o.done(fmt::format("in a light of kind '{}'", v["kind"].string()));
    placed.index = int(scene_.lights.size());
    scene_.lights.push_back(light);
    return placed;
}

void FathomJsonReader::read_light(const JsonValue& v, Node& node)
{
    const Placed placed = v.is_string() ? place(lights_, "lights", "light", v) : add_light(v, node.name);
    if (placed.place.m == Transform().m) {
        node.light = placed.index;
        return;
    }
    Node child;
    child.name = node.name;
    child.parent_from_node = placed.place;
    child.light = placed.index;
    node.children.push_back(int(scene_.nodes.size()));
    scene_.nodes.push_back(std::move(child));
}

}  // namespace fathom
