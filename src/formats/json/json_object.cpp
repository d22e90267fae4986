// SPDX-License-Identifier: Apache-2.0
#include "formats/json/json_object.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "fathom/error.h"
#include "formats/common/suggest.h"
#include "formats/io/read_file.h"

namespace fathom {

JsonValue JsonValue::operator[](std::string_view key) const
{
    const auto found = json_->find(key);
    JsonValue child(*file_, *found, style_);
    child.parent_ = this;
    child.key_ = found.key();
    return child;
}

JsonValue JsonValue::operator[](std::size_t index) const
{
    JsonValue child(*file_, (*json_)[index], style_);
    child.parent_ = this;
    child.index_ = index;
    return child;
}

std::optional<JsonValue> JsonValue::get(std::string_view key) const
{
    if (!has(key)) return std::nullopt;
    return (*this)[key];
}

std::string JsonValue::place() const
{
    if (!parent_) return {};
    const std::string before = parent_->place();
    if (parent_->is_array()) {
        const std::string index = std::to_string(index_);
        return style_ == PlaceStyle::path ? before + '[' + index + ']' : before + '/' + index;
    }
    if (style_ == PlaceStyle::path) return before + (before.empty() ? "" : ".") + printable(key_);
    std::string word;
    for (char c : printable(key_)) {
        if (c == '~')
            word += "~0";
        else if (c == '/')
            word += "~1";
        else
            word += c;
    }
    return before + '/' + word;
}

void JsonValue::fail(const std::string& message) const
{
    throw Error(*file_, place(), message);
}

void JsonValue::fail_type(const char* expected) const
{
    fail(fmt::format("expected {}, found {}", expected, json_type(*json_)));
}

bool JsonValue::boolean() const
{
    if (!json_->is_boolean()) fail_type("true or false");
    return json_->get<bool>();
}

int JsonValue::integer() const
{
    if (!json_->is_number()) fail_type("a whole number");
    const double value = json_->get<double>();
    if (value != std::floor(value)) fail(fmt::format("expected a whole number, found {}", value));
    if (std::abs(value) > std::numeric_limits<int>::max()) fail(fmt::format("{} is too large", value));
    return int(value);
}

std::size_t JsonValue::count() const
{
    if (!json_->is_number()) fail_type("a whole number");
    const double value = json_->get<double>();
    if (!(value >= 0 && value <= 9007199254740992.0 && value == std::floor(value)))
        fail(fmt::format("expected a whole number of at least 0, found {}", value));
    return std::size_t(value);
}

double JsonValue::number() const
{
    if (!json_->is_number()) fail_type("a number");
    const double value = json_->get<double>();
    if (!std::isfinite(value)) fail("the number is not finite");
    return value;
}

float JsonValue::single() const
{
    const double value = number();
    if (std::abs(value) > std::numeric_limits<float>::max()) fail(fmt::format("{} is too large", value));
    return float(value);
}

const std::string& JsonValue::string() const
{
    if (!json_->is_string()) fail_type("a string");
    return json_->get_ref<const std::string&>();
}

Vec3d JsonValue::vec3d() const
{
    array_of(3);
    return {(*this)[0].number(), (*this)[1].number(), (*this)[2].number()};
}
Vec2f JsonValue::vec2f() const
{
    array_of(2);
    return {(*this)[0].single(), (*this)[1].single()};
}
Vec3f JsonValue::vec3f() const
{
    array_of(3);
    return {(*this)[0].single(), (*this)[1].single(), (*this)[2].single()};
}
Vec4f JsonValue::vec4f() const
{
    array_of(4);
    return {(*this)[0].single(), (*this)[1].single(), (*this)[2].single(), (*this)[3].single()};
}

Color JsonValue::color() const
{
    Color color;
    if (is_number()) {
        color.r = color.g = color.b = single();
    } else if (is_array() && size() == 3) {
        color = {(*this)[0].single(), (*this)[1].single(), (*this)[2].single()};
    } else if (is_array()) {
        fail(fmt::format("expected 3 numbers (red, green, blue) or one for gray, found {} elements", size()));
    } else {
        fail_type("a color: 3 numbers or one for gray");
    }
    if (std::min({color.r, color.g, color.b}) < 0) fail("a color can't be negative");
    return color;
}

const JsonValue& JsonValue::array(std::size_t least) const
{
    if (!is_array()) fail_type("an array");
    if (size() < least) fail(fmt::format("expected at least {} elements, found {}", least, size()));
    return *this;
}

const JsonValue& JsonValue::array_of(std::size_t elements) const
{
    if (!is_array()) fail_type(fmt::format("an array of {} numbers", elements).c_str());
    if (size() != elements) fail(fmt::format("expected {} numbers, found {}", elements, size()));
    return *this;
}

const JsonValue& JsonValue::object() const
{
    if (!is_object()) fail_type("an object");
    return *this;
}

std::optional<JsonValue> JsonObject::get(const char* key)
{
    known_.push_back(key);
    if (!value_.has(key)) return std::nullopt;
    return value_[key];
}

JsonValue JsonObject::require(const char* key)
{
    if (auto v = get(key)) return *v;
    value_.fail(fmt::format("key '{}' is missing", key));
}

void JsonObject::read(const char* key, bool& out)
{
    if (auto v = get(key)) out = v->boolean();
}
void JsonObject::read(const char* key, int& out)
{
    if (auto v = get(key)) out = v->integer();
}
void JsonObject::read(const char* key, double& out)
{
    if (auto v = get(key)) out = v->number();
}
void JsonObject::read(const char* key, float& out)
{
    if (auto v = get(key)) out = v->single();
}
void JsonObject::read(const char* key, std::string& out)
{
    if (auto v = get(key)) out = v->string();
}
void JsonObject::read(const char* key, Vec3d& out)
{
    if (auto v = get(key)) out = v->vec3d();
}
void JsonObject::read(const char* key, Vec2f& out)
{
    if (auto v = get(key)) out = v->vec2f();
}
void JsonObject::read(const char* key, Color& out)
{
    if (auto v = get(key)) out = v->color();
}

void JsonObject::done(const std::string& where)
{
    for (const auto& [key, json] : value_.json().items()) {
        if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
        // "comment" is always allowed and not listed.
        const std::vector<std::string> candidates(known_.begin() + 1, known_.end());
        value_[key].fail(fmt::format("unknown key '{}'{}{}", printable(key), where.empty() ? "" : " " + where,
                                     suggestion(key, candidates)));
    }
}

void JsonObject::read_word(const char* key, std::span<const char* const> words, std::optional<std::string>& out)
{
    if (auto v = get(key)) out = words[find_word(*v, {words.begin(), words.end()})];
}

std::size_t JsonObject::find_word(const JsonValue& v, const std::vector<std::string>& names)
{
    const std::string& word = v.string();
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end()) v.fail(fmt::format("unknown value '{}'{}", printable(word), suggestion(word, names)));
    return std::size_t(found - names.begin());
}

}  // namespace fathom
