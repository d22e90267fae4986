#include <fmt/format.h>

#include <numbers>

#include "import/common/units.h"
#include "import/fathom/fathom_json_reader.h"
#include "scene/words.h"

namespace fathom {

namespace {

using Units = std::vector<std::pair<std::string, double>>;

/// Maps -z, along which lights shine, to the direction.
Transform shining_along(Vec3d direction)
{
    const Vec3d z = -normalize(direction);
    const Vec3d other = std::abs(z.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
    const Vec3d x = normalize(cross(other, z)), y = cross(z, x);
    Transform t;
    t.m = {{{x.x, y.x, z.x, 0}, {x.y, y.y, z.y, 0}, {x.z, y.z, z.z, 0}}};
    return t;
}

double read_angle(const JsonValue& v, double most_deg)
{
    const double deg = v.number();
    // Rounded to floats, as in other formats, a right angle may be more than that.
    if (deg < 0 || deg > most_deg * (1 + 1e-6))
        v.fail(fmt::format("must be between 0 and {}, found {}", most_deg, deg));
    return deg * radians_per_degree;
}

}  // namespace

FathomJsonReader::Placed FathomJsonReader::add_light(const JsonValue& v, const std::string& name)
{
    Light light;
    light.name = name;
    Placed placed;
    JsonObject o(v);
    o.read("name", light.name);
    if (!v.has("kind")) v.fail("key 'kind' is missing: point, spot or directional");
    o.read_word("kind", words::light_kinds, light.kind);
    Color color{1, 1, 1};
    o.read("color", color);
    double intensity = 1, unit = 1;
    o.read("intensity", intensity);
    if (intensity < 0) v["intensity"].fail("must not be negative");

    if (light.kind == LightKind::directional) {
        o.read_enum("unit", Units{{"lx", 1}, {"W/m2", lumens_per_watt}}, unit);
        if (auto angle = o.get("angle_deg")) light.angle = read_angle(*angle, 180);
    } else {
        // Power is what the bulb sends into the whole sphere; a spot's shade only takes away.
        const double sphere = 4 * std::numbers::pi;
        o.read_enum("unit",
                    Units{{"cd", 1}, {"lm", 1 / sphere}, {"W/sr", lumens_per_watt}, {"W", lumens_per_watt / sphere}},
                    unit);
        Vec3d position;
        o.read("position", position);
        placed.place = Transform::translate(position);
    }
    if (light.kind == LightKind::spot) {
        if (auto angle = o.get("inner_angle_deg")) light.inner_angle = read_angle(*angle, 90);
        if (auto angle = o.get("outer_angle_deg")) light.outer_angle = read_angle(*angle, 90);
        if (light.inner_angle > light.outer_angle || light.outer_angle == 0)
            v.fail("'outer_angle_deg' must be greater than 0 and not less than 'inner_angle_deg'");
    }
    if (light.kind != LightKind::point) {
        Vec3d direction{0, 0, -1};
        o.read("direction", direction);
        if (length(direction) == 0) v["direction"].fail("has no length");
        placed.place = placed.place * shining_along(direction);
    }
    o.done(fmt::format("in a light of kind '{}'", v["kind"].string()));
    const double factor = intensity * unit;
    light.intensity = {float(color.r * factor), float(color.g * factor), float(color.b * factor)};

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
