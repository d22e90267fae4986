// SPDX-License-Identifier: Apache-2.0
#include "formats/json/json_text.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace fathom {

namespace {

constexpr std::size_t width = 124;

std::string plain(const Json& json)
{
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Appends JSON in one line. If it gets longer than `most`, returns false and leaves a partial result in `out`.
bool append_line(const Json& json, std::size_t most, std::string& out)
{
    if (!json.is_structured()) {
        out += plain(json);
        return out.size() <= most;
    }
    const bool object = json.is_object();
    out += object ? '{' : '[';
    bool is_first = true;
    for (const auto& [key, value] : json.items()) {
        if (!is_first) out += ", ";
        is_first = false;
        if (object) out += plain(key) + ": ";
        if (!append_line(value, most, out)) return false;
    }
    out += object ? '}' : ']';
    return out.size() <= most;
}

void append(const Json& json, std::size_t indent, std::string& out)
{
    std::string line;
    if (append_line(json, width > indent ? width - indent : 0, line) || !json.is_structured() || json.empty()) {
        out += line;
        return;
    }
    const bool object = json.is_object();
    out += object ? '{' : '[';
    const char* separator = "";
    for (const auto& [key, value] : json.items()) {
        out += separator + ('\n' + std::string(indent + 2, ' '));
        if (object) out += plain(key) + ": ";
        append(value, indent + 2, out);
        separator = ",";
    }
    out += '\n' + std::string(indent, ' ') + (object ? '}' : ']');
}

}  // namespace

Json number_json(double value)
{
    constexpr double exact = 9007199254740992.0;
    if (value == std::floor(value) && std::abs(value) < exact && !(value == 0 && std::signbit(value)))
        return std::int64_t(value);
    return value;
}

Json number_json(float value)
{
    return number_json(value, 1);
}

template <class T>
Json number_json(T value, double unit)
{
    for (int digits = 1; digits <= 17; ++digits) {
        const std::string text = fmt::format("{:.{}g}", double(value) / unit, digits);
        double number = 0;
        std::from_chars(text.data(), text.data() + text.size(), number);
        if (T(number * unit) == value) return number_json(number);
    }
    // No double times `unit` rounds to this value. The quotient's product misses it by less than the spacing of floats.
    return number_json(double(value) / unit);
}
template Json number_json(float, double);
template Json number_json(double, double);

std::string json_text(const Json& json)
{
    std::string text;
    append(json, 0, text);
    return text + '\n';
}

}  // namespace fathom
