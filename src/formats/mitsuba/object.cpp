// SPDX-License-Identifier: Apache-2.0
#include "formats/mitsuba/object.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <numbers>

#include "formats/io/read_file.h"

namespace fathom::mitsuba {

namespace {

bool is_blank(char c)
{
    return c == ' ' || c == ',' || c == '\t' || c == '\n' || c == '\r';
}

double number_of(const Element& element, std::string_view text)
{
    const std::vector<double> numbers = numbers_of(element, text);
    if (numbers.size() != 1) element.fail(fmt::format("expected a number, found '{}'", printable(text)));
    return numbers[0];
}

/// A vector from attributes x, y and z, or from `value`.
Vec3d vector_of(const Element& element, double otherwise)
{
    if (element.has("value")) {
        const std::vector<double> v = numbers_of(element, element.attribute("value"));
        if (v.size() == 1) return {v[0], v[0], v[0]};
        if (v.size() != 3) element.fail(fmt::format("expected three numbers, found {}", v.size()));
        return {v[0], v[1], v[2]};
    }
    const auto axis = [&](const char* name) {
        return element.has(name) ? number_of(element, element.attribute(name)) : otherwise;
    };
    return {axis("x"), axis("y"), axis("z")};
}

Vec3d three_numbers(const Element& element, std::string_view name)
{
    const std::vector<double> v = numbers_of(element, element.attribute(name));
    if (v.size() != 3) element.fail(fmt::format("'{}' must have three numbers, found {}", name, v.size()));
    return {v[0], v[1], v[2]};
}

/// Transform of a camera that looks along +z with +x to its left.
Transform look_at(const Element& element)
{
    const Vec3d origin = three_numbers(element, "origin"), target = three_numbers(element, "target");
    const Vec3d forward = normalize(target - origin);
    Vec3d up = element.has("up") ? three_numbers(element, "up") : Vec3d{0, 0, 0};
    if (length(up) == 0) up = std::abs(forward.x) > std::abs(forward.y) ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
    const Vec3d left = normalize(cross(up, forward)), above = cross(forward, left);
    if (length(forward) == 0 || length(left) == 0) element.fail("origin, target and up don't define an orientation");
    Transform t;
    const Vec3d columns[] = {left, above, forward, origin};
    for (std::size_t c = 0; c < 4; ++c) t.m[0][c] = columns[c].x, t.m[1][c] = columns[c].y, t.m[2][c] = columns[c].z;
    return t;
}

Transform matrix_of(const Element& element)
{
    const std::vector<double> v = numbers_of(element, element.attribute("value"));
    Transform t;
    if (v.size() == 9) {
        for (std::size_t i = 0; i < 9; ++i) t.m[i / 3][i % 3] = v[i];
        return t;
    }
    if (v.size() != 16) element.fail(fmt::format("a matrix must have 16 or 9 numbers, found {}", v.size()));
    if (v[12] != 0 || v[13] != 0 || v[14] != 0 || v[15] == 0)
        element.fail("the last row of a matrix must be 0 0 0 1: perspective belongs to cameras");
    for (std::size_t i = 0; i < 12; ++i) t.m[i / 4][i % 4] = v[i] / v[15];
    return t;
}

Transform step_of(const Element& element)
{
    if (element.tag == "translate") return Transform::translate(vector_of(element, 0));
    if (element.tag == "scale") return Transform::scale(vector_of(element, 1));
    if (element.tag == "rotate") {
        const Vec3d axis = vector_of(element, 0);
        if (length(axis) == 0) element.fail("a rotation needs an axis: give x, y or z");
        return Transform::rotate(axis, number_of(element, element.attribute("angle")) * std::numbers::pi / 180);
    }
    if (element.tag == "lookat") return look_at(element);
    if (element.tag == "matrix") return matrix_of(element);
    element.fail(fmt::format("<{}> is not a step of a transform", printable(element.tag)));
}

}  // namespace

std::vector<double> numbers_of(const Element& element, std::string_view text)
{
    std::vector<double> numbers;
    const char *at = text.data(), *const end = at + text.size();
    while (true) {
        while (at != end && is_blank(*at)) ++at;
        if (at == end) return numbers;
        if (*at == '+') ++at;
        double value = 0;
        const auto [next, error] = std::from_chars(at, end, value);
        // Numbers too small for double become 0.
        const bool is_tiny = error == std::errc::result_out_of_range && value == 0;
        if ((error != std::errc() && !is_tiny) || (next != end && !is_blank(*next)) || !std::isfinite(value))
            element.fail(fmt::format("expected numbers, found '{}'", printable(text)));
        numbers.push_back(value);
        at = next;
    }
}

Transform transform_of(const Element& element)
{
    Transform all;
    for (const auto& step : element.children) all = step_of(*step) * all;
    for (const auto& row : all.m)
        for (double v : row)
            if (!std::isfinite(v)) element.fail("the transform is not finite");
    return all;
}

const Element* Object::find(std::string_view name) const
{
    for (const auto& child : element_.children)
        if (child->name() == name) return child.get();
    return nullptr;
}

const Element* Object::use(std::string_view name)
{
    const Element* const found = find(name);
    if (found) used_.insert(found);
    return found;
}

double Object::number(std::string_view name, double otherwise)
{
    const Element* const found = use(name);
    if (!found) return otherwise;
    if (!found->has("value")) found->fail(fmt::format("'{}' must be a number here", name));
    return number_of(*found, found->attribute("value"));
}

int Object::integer(std::string_view name, int otherwise)
{
    const double value = number(name, otherwise);
    if (value != std::floor(value) || std::abs(value) > 1e9)
        find(name)->fail(fmt::format("'{}' must be a whole number", name));
    return int(value);
}

bool Object::boolean(std::string_view name, bool otherwise)
{
    const Element* const found = use(name);
    if (!found) return otherwise;
    const std::string& value = found->attribute("value");
    if (value == "true" || value == "True" || value == "1") return true;
    if (value == "false" || value == "False" || value == "0") return false;
    found->fail(fmt::format("expected true or false, found '{}'", printable(value)));
}

std::string Object::text(std::string_view name, std::string_view otherwise)
{
    const Element* const found = use(name);
    return found ? found->attribute("value") : std::string(otherwise);
}

std::optional<Vec3d> Object::vector(std::string_view name)
{
    const Element* const found = use(name);
    return found ? std::optional(vector_of(*found, 0)) : std::nullopt;
}

Transform Object::transform(std::string_view name)
{
    const Element* const found = use(name);
    return found ? transform_of(*found) : Transform();
}

const Element* Object::child(std::string_view name)
{
    const Element* const found = use(name);
    return found && found->tag == "ref" ? &document_.find(*found) : found;
}

std::vector<const Element*> Object::children(std::string_view tag)
{
    std::vector<const Element*> found;
    for (const auto& child : element_.children) {
        const Element* const meant = child->tag == "ref" ? &document_.find(*child) : child.get();
        if (meant->tag != tag) continue;
        used_.insert(child.get());
        found.push_back(meant);
    }
    return found;
}

void Object::ignore(std::initializer_list<std::string_view> names)
{
    for (std::string_view name : names) use(name);
}

void Object::finish(Warnings& warnings) const
{
    for (const auto& child : element_.children) {
        if (used_.contains(child.get()) || child->tag == "alias") continue;
        const std::string what = child->name().empty() || child->name().starts_with("_arg_")
                                     ? fmt::format("<{}> '{}'", printable(child->tag), printable(child->type()))
                                     : fmt::format("'{}'", printable(child->name()));
        warnings.add(
            fmt::format("{}: {} of {} is ignored", element_.place.file ? *element_.place.file : "", what, title()));
    }
}

std::string Object::title() const
{
    return fmt::format("{} '{}'", printable(element_.tag), printable(type()));
}

}  // namespace fathom::mitsuba
