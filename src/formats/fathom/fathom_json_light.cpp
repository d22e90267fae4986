// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <numbers>
#include <optional>

#include "formats/common/units.h"
#include "formats/fathom/fathom_json_reader.h"
#include "scene/enum_names.h"

namespace fathom {

namespace {

using Units = std::vector<std::pair<std::string, double>>;

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

double read_angle(const JsonValue& v, double max_deg)
{
    const double deg = v.number();
    // Angles converted from floats may exceed the limit by rounding.
    if (deg < 0 || deg > max_deg * (1 + 1e-6)) v.fail(fmt::format("must be between 0 and {}, found {}", max_deg, deg));
    return deg * radians_per_degree;
}

}  // namespace

/// Reads the image of a spot, projector or goniometric light. False if the light has none and needs none.
bool FathomJsonReader::read_picture(JsonObject& o, Light& light)
{
    if (light.kind == LightKind::point || light.kind == LightKind::directional || light.kind == LightKind::beam)
        return false;
    std::optional<JsonValue> path = o.get("image");
    if (!path && light.kind == LightKind::goniometric) path = o.require("image");
    if (!path && light.kind == LightKind::spot) return false;
    if (path) light.picture.image = image(*path);
    o.read_word("color_space", words::color_spaces, light.picture.color_space);
    o.read_word("lookup", words::lookups, light.picture.nearest);
    return true;
}

namespace {

/// Factor from the unit of `intensity` in the file to the description's: lx for parallel light, else cd or lm.
double read_light_unit(const JsonValue& v, JsonObject& o, Light& light)
{
    double unit = 1;
    if (light.kind == LightKind::directional || light.kind == LightKind::beam) {
        o.read_enum("unit", Units{{"lx", 1}, {"W/m2", lumens_per_watt}}, unit);
        return unit;
    }
    // Power refers to the whole sphere, also for spots: the cone only blocks light.
    const bool may_be_flux = light.kind == LightKind::projector || light.kind == LightKind::goniometric;
    const double sphere = may_be_flux ? 1 : 4 * std::numbers::pi;
    o.read_enum("unit",
                Units{{"cd", 1}, {"lm", 1 / sphere}, {"W/sr", lumens_per_watt}, {"W", lumens_per_watt / sphere}}, unit);
    // With an image, the light's distribution is normalized to the given flux.
    if (may_be_flux && v.has("unit")) light.intensity_is_flux = v["unit"].string() == "lm" || v["unit"].string() == "W";
    return unit;
}

void read_light_intensity(const JsonValue& v, JsonObject& o, Light& light)
{
    Color color{1, 1, 1};
    o.read("color", color);
    double intensity = 1;
    o.read("intensity", intensity);
    if (intensity < 0) v["intensity"].fail("must not be negative");
    const double factor = intensity * read_light_unit(v, o, light);
    light.intensity = {float(color.r * factor), float(color.g * factor), float(color.b * factor)};
}

void read_spot(const JsonValue& v, JsonObject& o, Light& light)
{
    if (auto angle = o.get("inner_angle_deg")) light.inner_angle = read_angle(*angle, 90);
    if (auto angle = o.get("outer_angle_deg")) light.outer_angle = read_angle(*angle, 90);
    o.read_word("falloff", words::spot_falloffs, light.falloff);
    if (light.inner_angle > light.outer_angle || light.outer_angle == 0)
        v.fail("'outer_angle_deg' must be greater than 0 and not less than 'inner_angle_deg'");
}

void read_projector(const JsonValue& v, JsonObject& o, Light& light)
{
    if (auto angle = o.get("fov_deg")) light.fov = read_angle(*angle, 180);
    if (light.fov <= 0 || light.fov >= std::numbers::pi) v["fov_deg"].fail("must be above 0 and below 180");
    o.read_word("fov_axis", words::fov_axes, light.fov_axis);
    o.read("flat_field", light.flat_field);
}

void read_beam(const JsonValue& v, JsonObject& o, Light& light)
{
    for (const auto& [key, side] : {std::pair{"width", &light.width}, {"height", &light.height}}) {
        o.read(key, *side);
        if (!(*side > 0)) v[key].fail("must be above 0");
    }
    o.read("round", light.round);
}

/// The light's rotation, from its direction and, if it `has_up`, the direction that is up in its image.
Transform read_light_rotation(const JsonValue& v, JsonObject& o, bool has_up)
{
    Vec3d direction{0, 0, -1};
    o.read("direction", direction);
    if (length(direction) == 0) v["direction"].fail("must not have zero length");
    std::optional<Vec3d> up;
    if (has_up && v.has("up")) {
        o.read("up", up.emplace());
        if (length(cross(*up, direction)) <= 1e-9 * length(*up) * length(direction))
            v["up"].fail("must not have zero length or be parallel to 'direction'");
    }
    return light_rotation(direction, up);
}

}  // namespace

FathomJsonReader::Placed FathomJsonReader::add_light(const JsonValue& v, const std::string& name)
{
    Light light;
    light.name = name;
    Placed placed;
    JsonObject o(v);
    o.read("name", light.name);
    if (!v.has("kind"))
        v.fail("key 'kind' is missing: expected point, spot, directional, projector, goniometric or beam");
    o.read_word("kind", words::light_kinds, light.kind);
    read_light_intensity(v, o, light);
    if (light.kind == LightKind::directional) {
        if (auto angle = o.get("angle_deg")) light.angle = read_angle(*angle, 180);
    } else {
        Vec3d position;
        o.read("position", position);
        placed.place = Transform::translate(position);
    }
    if (light.kind == LightKind::spot) read_spot(v, o, light);
    if (light.kind == LightKind::projector) read_projector(v, o, light);
    if (light.kind == LightKind::beam) read_beam(v, o, light);
    const bool has_up = read_picture(o, light) || light.kind == LightKind::beam;
    if (light.kind != LightKind::point) placed.place = placed.place * read_light_rotation(v, o, has_up);
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
