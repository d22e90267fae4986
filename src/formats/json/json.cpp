// SPDX-License-Identifier: Apache-2.0
#include "formats/json/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "fathom/error.h"
#include "formats/io/read_file.h"
#include "formats/io/text_encoding.h"

namespace fathom {

namespace {

/// Line and column of a byte, counted from 1.
std::string line_and_column(std::string_view text, std::size_t byte)
{
    const std::string_view before = text.substr(0, byte);
    const std::size_t line = 1 + std::size_t(std::count(before.begin(), before.end(), '\n'));
    const std::size_t line_start = before.rfind('\n');
    const std::size_t column = line_start == std::string_view::npos ? before.size() + 1 : before.size() - line_start;
    return fmt::format("line {}, column {}", line, column);
}

/// The parser's reason without its error codes, such as "unexpected ']'; expected ...".
std::string plain_reason(std::string reason)
{
    for (const char* start : {"syntax error while parsing ", "parse error", "] "})
        if (const std::size_t at = reason.find(start); at != std::string::npos) {
            reason = reason.substr(at + std::string_view(start).size());
            break;
        }
    if (const std::size_t dash = reason.find(" - "); dash != std::string::npos && dash < 24)
        reason = reason.substr(dash + 3);
    return reason;
}

/// Thrown by the builder's parse_error() to leave the parser.
struct SyntaxError {
    std::size_t byte;  ///< offset behind which the parser stopped
    std::string reason;
    bool is_number;  ///< a number beyond the range of double
};

/// Builds values from the parser's events. The library's own builders accept duplicate keys or take quadratic time for
/// long arrays.
class JsonBuilder : public nlohmann::json_sax<Json> {
public:
    Json root;
    std::string duplicate;  ///< the first duplicate key

    bool null() override { return add(nullptr); }
    bool boolean(bool value) override { return add(value); }
    bool number_integer(number_integer_t value) override { return add(value); }
    bool number_unsigned(number_unsigned_t value) override { return add(value); }
    bool number_float(number_float_t value, const string_t&) override { return add(value); }
    bool string(string_t& value) override { return add(std::move(value)); }
    bool binary(binary_t&) override { return false; }  // JSON text has no binary values
    bool start_object(std::size_t) override { return open(Json::object()); }
    bool start_array(std::size_t) override { return open(Json::array()); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }
    bool key(string_t& name) override
    {
        auto& object = open_.back()->get_ref<Json::object_t&>();
        const auto [member, is_new] = object.emplace(name, nullptr);
        if (!is_new && duplicate.empty()) duplicate = name;
        member_ = &member->second;
        return true;
    }
    bool parse_error(std::size_t byte, const std::string&, const Json::exception& error) override
    {
        throw SyntaxError{byte, error.what(), dynamic_cast<const Json::out_of_range*>(&error) != nullptr};
    }

private:
    template <class Value>
    bool add(Value&& value)
    {
        put(std::forward<Value>(value));
        return true;
    }
    bool open(Json value)
    {
        open_.push_back(put(std::move(value)));
        return true;
    }
    bool close()
    {
        open_.pop_back();
        return true;
    }
    template <class Value>
    Json* put(Value&& value)
    {
        if (open_.empty()) {
            root = std::forward<Value>(value);
            return &root;
        }
        if (open_.back()->is_object()) {
            *member_ = std::forward<Value>(value);
            return member_;
        }
        auto& array = open_.back()->get_ref<Json::array_t&>();
        array.emplace_back(std::forward<Value>(value));
        return &array.back();
    }

    // Pointers stay valid, because a container only grows while no value in it is open.
    std::vector<Json*> open_;
    Json* member_ = nullptr;  ///< value of the last key
};

/// Line and column of the second occurrence of a key, if it can be found without parsing again.
std::string place_of_second(std::string_view text, const std::string& key)
{
    const std::string quoted = '"' + key + '"';
    const std::size_t first = text.find(quoted);
    if (first == std::string_view::npos) return {};
    const std::size_t second = text.find(quoted, first + quoted.size());
    if (second == std::string_view::npos || text.find(quoted, second + quoted.size()) != std::string_view::npos)
        return {};
    return line_and_column(text, second);
}

}  // namespace

Json parse_json(const std::string& file, std::string_view text, DuplicateKeys duplicates)
{
    text = utf8_text(file, text);
    JsonBuilder builder;
    try {
        Json::sax_parse(text, &builder);
    } catch (const SyntaxError& e) {
        std::string reason = plain_reason(e.reason);
        if (e.is_number) {
            // For a number like 1e999 the parser quotes the token but reports no position.
            const std::size_t quote = reason.find('\''), end = reason.rfind('\'');
            const std::size_t at = quote < end ? text.find(reason.substr(quote + 1, end - quote - 1)) : text.npos;
            throw Error(file, at != text.npos ? line_and_column(text, at) : "", "not JSON: " + printable(reason));
        }
        const std::size_t byte = std::min(text.size(), e.byte > 0 ? e.byte - 1 : 0);
        if (byte >= text.size() || reason.find("end of input") != std::string::npos)
            reason = "the file is truncated: " + reason;
        // Tokens quoted from the file may be long or binary.
        if (reason.size() > 160) reason = reason.substr(0, 160) + "...";
        for (char& c : reason)
            if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = '?';
        throw Error(file, line_and_column(text, byte), "not JSON: " + reason);
    }
    if (duplicates == DuplicateKeys::error && !builder.duplicate.empty())
        throw Error(file, place_of_second(text, builder.duplicate),
                    fmt::format("key '{}' appears twice in one object", printable(builder.duplicate)));
    return std::move(builder.root);
}

const char* json_type(const Json& value)
{
    switch (value.type()) {
        case Json::value_t::null:
            return "null";
        case Json::value_t::object:
            return "an object";
        case Json::value_t::array:
            return "an array";
        case Json::value_t::string:
            return "a string";
        case Json::value_t::boolean:
            return "true or false";
        case Json::value_t::number_integer:
        case Json::value_t::number_unsigned:
        case Json::value_t::number_float:
            return "a number";
        default:
            return "not a JSON value";
    }
}

}  // namespace fathom
