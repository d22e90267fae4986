// SPDX-License-Identifier: Apache-2.0
#include "formats/mitsuba/legacy_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/mitsuba/object.h"
#include "formats/mitsuba/sun_of_date.h"

namespace fathom::mitsuba {

namespace {

bool is_lower(char c)
{
    return c >= 'a' && c <= 'z';
}

bool is_upper(char c)
{
    return c >= 'A' && c <= 'Z';
}

/// Converts names such as "toWorld" to "to_world" and "intIOR" to "int_ior".
std::string snake_case(std::string_view name)
{
    std::string result;
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (i == 0 || !is_lower(name[i - 1]) || !is_upper(name[i])) {
            result += name[i];
            continue;
        }
        result += '_';
        for (; i < name.size() && is_upper(name[i]); ++i) result += char(name[i] - 'A' + 'a');
        --i;
    }
    return result;
}

/// Removes a parameter and returns its value; empty if it is missing.
std::string taken(Element& element, std::string_view name)
{
    const auto is_named = [&](const std::unique_ptr<Element>& child) { return child->name() == name; };
    const auto found = std::ranges::find_if(element.children, is_named);
    if (found == element.children.end()) return "";
    std::string value = (*found)->attribute("value");
    element.children.erase(found);
    return value;
}

/// Removes a parameter and returns its number.
double taken_number(Element& element, std::string_view name, double otherwise)
{
    const std::string value = taken(element, name);
    if (value.empty()) return otherwise;
    const std::vector<double> numbers = numbers_of(element, value);
    if (numbers.size() != 1) element.fail(fmt::format("'{}' must be a number", name));
    return numbers[0];
}

Element& add(Element& to, std::string_view tag, std::map<std::string, std::string, std::less<>> attributes)
{
    auto child = std::make_unique<Element>();
    child->tag = tag;
    child->attributes = std::move(attributes);
    child->place = to.place;
    return *to.children.emplace_back(std::move(child));
}

/// Replaces 'uscale', 'vscale', 'uoffset' and 'voffset' by a transform, and a gamma of 1 by 'raw'.
void upgrade_texture(Element& texture)
{
    const double scale_u = taken_number(texture, "uscale", 1), scale_v = taken_number(texture, "vscale", 1),
                 offset_u = taken_number(texture, "uoffset", 0), offset_v = taken_number(texture, "voffset", 0);
    if (scale_u != 1 || scale_v != 1 || offset_u != 0 || offset_v != 0) {
        Element& transform = add(texture, "transform", {{"name", "to_uv"}});
        add(transform, "scale", {{"x", fmt::to_string(scale_u)}, {"y", fmt::to_string(scale_v)}});
        add(transform, "translate", {{"x", fmt::to_string(offset_u)}, {"y", fmt::to_string(offset_v)}});
    }
    // A negative gamma, the default, means sRGB; other values are close enough to be treated as sRGB.
    if (texture.type() == "bitmap" && taken_number(texture, "gamma", -1) == 1)
        add(texture, "boolean", {{"name", "raw"}, {"value", "true"}});
}

void upgrade_sky(Element& sky)
{
    const auto named = [&](std::string_view name) {
        return std::ranges::find_if(sky.children, [&](const auto& child) { return child->name() == name; });
    };
    if (named("to_world") == sky.children.end()) add(sky, "transform", {{"name", "to_world"}});
    Element& to_world = **named("to_world");
    const SunAngles sun =
        sun_of_date(sky, [&](std::string_view name, double otherwise) { return taken_number(sky, name, otherwise); });
    if (named("sun_direction") == sky.children.end()) {
        // Mitsuba 0.6's sky has +x in the east and -z in the north.
        const double flat = std::cos(sun.elevation);
        const Vec3d d = transform_of(to_world).vector(
            {std::sin(sun.azimuth) * flat, std::sin(sun.elevation), -std::cos(sun.azimuth) * flat});
        add(sky, "vector", {{"name", "sun_direction"}, {"value", fmt::format("{} {} {}", d.x, d.y, d.z)}});
    }
    // Mitsuba 3's sky has +z up.
    add(to_world, "rotate", {{"x", "1"}, {"angle", "-90"}});
    std::ranges::rotate(to_world.children, to_world.children.end() - 1);
    if (const double scale = taken_number(sky, "sun_radius_scale", 1); scale != 1)
        add(sky, "float", {{"name", "sun_aperture"}, {"value", fmt::to_string(0.5358 * scale)}});
}

bool is_one_number(const Element& spectrum)
{
    const std::string& value = spectrum.attribute("value");
    return spectrum.type().empty() && !value.empty() && value.find(':') == std::string::npos;
}

}  // namespace

void upgrade(Element& element)
{
    if (element.tag == "lookAt") element.tag = "lookat";
    if (const auto name = element.attributes.find("name"); name != element.attributes.end())
        name->second = snake_case(name->second);
    if (element.tag == "spectrum" && is_one_number(element)) element.tag = "rgb";
    if (element.tag == "bsdf" && element.type() == "diffuse")
        for (const auto& child : element.children)
            if (child->name() == "diffuse_reflectance") child->attributes["name"] = "reflectance";
    if (element.tag == "texture") upgrade_texture(element);
    if (element.tag == "emitter" && (element.type() == "sky" || element.type() == "sun" || element.type() == "sunsky"))
        upgrade_sky(element);
}

}  // namespace fathom::mitsuba
