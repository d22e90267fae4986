// SPDX-License-Identifier: Apache-2.0
#include "formats/pbrt/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "formats/common/suggest.h"
#include "formats/io/read_file.h"

namespace fathom::pbrt {

namespace {

/// A parameter type with the number of values that form a group; 0 allows any count.
struct Type {
    const char* name;
    enum Values { reals, integers, booleans, texts, spectrum } values;
    std::size_t group;
};
constexpr Type types[] = {{"integer", Type::integers, 1},  {"float", Type::reals, 1},   {"point2", Type::reals, 2},
                          {"vector2", Type::reals, 2},     {"point3", Type::reals, 3},  {"vector3", Type::reals, 3},
                          {"normal3", Type::reals, 3},     {"point", Type::reals, 3},   {"vector", Type::reals, 3},
                          {"normal", Type::reals, 3},      {"rgb", Type::reals, 3},     {"blackbody", Type::reals, 1},
                          {"spectrum", Type::spectrum, 1}, {"bool", Type::booleans, 1}, {"string", Type::texts, 1},
                          {"texture", Type::texts, 1}};

const Type& type_of(const Scanner& scanner, const std::string& name)
{
    std::vector<std::string> names;
    for (const Type& type : types) {
        if (name == type.name) return type;
        names.emplace_back(type.name);
    }
    scanner.fail(fmt::format("'{}' is not a parameter type{}", printable(name), suggestion(name, names)));
}

/// Splits a declaration such as `"float radius"` into type and name.
std::unique_ptr<Parameter> declared(const Token& token, const Scanner& scanner)
{
    constexpr std::string_view blanks = " \t\r";
    const std::string text = unescaped(token);
    const std::size_t type_start = text.find_first_not_of(blanks), type_end = text.find_first_of(blanks, type_start);
    const std::size_t name_start = text.find_first_not_of(blanks, type_end);
    if (type_start == std::string::npos || type_end == std::string::npos || name_start == std::string::npos)
        scanner.fail(fmt::format("expected a parameter's type and name, found '{}'", printable(text)));
    const std::size_t name_end = text.find_first_of(blanks, name_start);
    auto result = std::make_unique<Parameter>();
    result->type = text.substr(type_start, type_end - type_start);
    result->name = text.substr(name_start, name_end == std::string::npos ? name_end : name_end - name_start);
    result->place = scanner.place();
    return result;
}

bool read_value(Scanner& scanner, const Type& type, Parameter& parameter)
{
    if (type.values == Type::integers) {
        std::int32_t value = 0;
        if (!scanner.try_number(value)) return false;
        parameter.integers.push_back(value);
        return true;
    }
    if (type.values == Type::reals || type.values == Type::spectrum) {
        float value = 0;
        if (scanner.try_number(value)) {
            parameter.numbers.push_back(value);
            return true;
        }
        if (type.values == Type::reals) return false;
    }
    const Token& token = scanner.peek();
    if (type.values == Type::booleans) {
        if (token.text != "true" && token.text != "false") return false;
        parameter.integers.push_back(token.text == "true");
        scanner.next();
        return true;
    }
    if (token.kind != Token::Kind::string) return false;
    parameter.strings.push_back(unescaped(token));
    scanner.next();
    return true;
}

void read_values(Scanner& scanner, const Type& type, Parameter& parameter)
{
    if (scanner.peek().kind != Token::Kind::open) {
        if (!read_value(scanner, type, parameter))
            scanner.fail(fmt::format("'{} {}' has no value", printable(parameter.type), printable(parameter.name)));
        return;
    }
    scanner.next();
    while (read_value(scanner, type, parameter)) {
    }
    const Token& stop = scanner.peek();
    if (stop.kind == Token::Kind::end)
        parameter.place.fail(fmt::format("the values of '{}' are not closed by ]", printable(parameter.name)));
    if (stop.kind != Token::Kind::close)
        scanner.fail(fmt::format("'{}' is not a value of '{} {}'", printable(stop.text), printable(parameter.type),
                                 printable(parameter.name)));
    scanner.next();
    parameter.numbers.shrink_to_fit();
}

}  // namespace

ParameterList read_parameters(Scanner& scanner)
{
    ParameterList list;
    while (scanner.peek().kind == Token::Kind::string) {
        std::unique_ptr<Parameter> parameter = declared(scanner.peek(), scanner);
        const Type& type = type_of(scanner, parameter->type);
        scanner.next();
        read_values(scanner, type, *parameter);
        if (parameter->numbers.size() % type.group != 0)
            parameter->place.fail(fmt::format("'{} {}' has {} numbers: not a multiple of {}", parameter->type,
                                              printable(parameter->name), parameter->numbers.size(), type.group));
        for (const auto& other : list)
            if (other->name == parameter->name)
                parameter->place.fail(fmt::format("the parameter '{}' is given twice", printable(parameter->name)));
        if (list.size() >= 1000) parameter->place.fail("more than 1000 parameters");
        list.push_back(std::move(parameter));
    }
    return list;
}

void WarningReporter::report(const Place& place, const std::string& message)
{
    const auto [found, is_new] = first_.emplace(message, "");
    // Messages with the same cause are merged, since a scene may have millions of shapes.
    if (is_new) found->second = fmt::format("{}: {}", place.text(), message);
    warnings_.add(found->second);
}

Parameters::Parameters(std::string kind, std::string plugin, Place place, ParameterList own, ParameterList preset)
    : kind_(std::move(kind)),
      plugin_(std::move(plugin)),
      place_(std::move(place)),
      own_(std::move(own)),
      preset_(std::move(preset))
{
}

const Parameter* Parameters::find(std::string_view name) const
{
    for (const ParameterList* list : {&own_, &preset_})
        for (auto p = list->rbegin(); p != list->rend(); ++p)
            if ((*p)->name == name) {
                (*p)->is_used = true;
                return p->get();
            }
    return nullptr;
}

bool Parameters::has(std::string_view name) const
{
    const auto holds = [&](const ParameterList& list) {
        return std::any_of(list.begin(), list.end(), [&](const auto& p) { return p->name == name; });
    };
    return holds(own_) || holds(preset_);
}

double Parameters::number(std::string_view name, double otherwise) const
{
    const Parameter* const p = find(name);
    if (!p) return otherwise;
    if (p->numbers.size() == 1) return p->numbers[0];
    if (p->type == "integer" && p->integers.size() == 1) return p->integers[0];
    p->place.fail(fmt::format("'{}' must be one number", printable(name)));
}

int Parameters::integer(std::string_view name, int otherwise) const
{
    const Parameter* const p = find(name);
    if (!p) return otherwise;
    if (p->type != "integer" || p->integers.size() != 1)
        p->place.fail(fmt::format("'{}' must be one whole number", printable(name)));
    return p->integers[0];
}

bool Parameters::boolean(std::string_view name, bool otherwise) const
{
    const Parameter* const p = find(name);
    if (!p) return otherwise;
    if (p->type != "bool" || p->integers.size() != 1)
        p->place.fail(fmt::format("'{}' must be true or false", printable(name)));
    return p->integers[0] != 0;
}

std::string Parameters::text(std::string_view name, std::string_view otherwise) const
{
    const Parameter* const p = find(name);
    if (!p) return std::string(otherwise);
    if (p->strings.size() != 1) p->place.fail(fmt::format("'{}' must be one string", printable(name)));
    return p->strings[0];
}

std::optional<Vec3d> Parameters::vector(std::string_view name) const
{
    const Parameter* const p = find(name);
    if (!p) return std::nullopt;
    if (p->numbers.size() != 3) p->place.fail(fmt::format("'{}' must be three numbers", printable(name)));
    return Vec3d{p->numbers[0], p->numbers[1], p->numbers[2]};
}

std::vector<float> Parameters::numbers(std::string_view name) const
{
    const Parameter* const p = find(name);
    return p ? p->numbers : std::vector<float>();
}

std::vector<std::int32_t> Parameters::integers(std::string_view name) const
{
    const Parameter* const p = find(name);
    return p ? p->integers : std::vector<std::int32_t>();
}

std::vector<std::string> Parameters::texts(std::string_view name) const
{
    const Parameter* const p = find(name);
    return p ? p->strings : std::vector<std::string>();
}

namespace {

template <class T>
std::vector<T> grouped(const Parameter* p)
{
    constexpr std::size_t group = sizeof(T) / sizeof(float);
    if (!p) return {};
    if (p->numbers.size() % group != 0)
        p->place.fail(
            fmt::format("'{}' has {} numbers: not a multiple of {}", printable(p->name), p->numbers.size(), group));
    std::vector<T> result(p->numbers.size() / group);
    if (!result.empty()) std::memcpy(result.data(), p->numbers.data(), p->numbers.size() * sizeof(float));
    return result;
}

}  // namespace

std::vector<Vec3f> Parameters::vectors(std::string_view name) const
{
    return grouped<Vec3f>(find(name));
}

std::vector<Vec2f> Parameters::points2(std::string_view name) const
{
    return grouped<Vec2f>(find(name));
}

void Parameters::ignore(std::initializer_list<std::string_view> names) const
{
    for (std::string_view name : names) find(name);
}

void Parameters::finish(WarningReporter& reporter) const
{
    for (const auto& p : own_)
        if (!p->is_used)
            reporter.report(p->place, fmt::format("{}: the parameter '{}' is ignored", title(), printable(p->name)));
}

std::string Parameters::title() const
{
    return fmt::format("{} '{}'", kind_, printable(plugin_));
}

void Parameters::fail(const std::string& message) const
{
    place_.fail(fmt::format("{}: {}", title(), message));
}

}  // namespace fathom::pbrt
