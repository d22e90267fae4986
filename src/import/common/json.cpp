#include "import/common/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_set>
#include <vector>

#include "fathom/error.h"
#include "import/common/read_file.h"

namespace fathom {

namespace {

/// Position in text as people count it: from 1.
std::string line_and_column(std::string_view text, std::size_t byte)
{
    const std::string_view before = text.substr(0, byte);
    const std::size_t line = 1 + std::size_t(std::count(before.begin(), before.end(), '\n'));
    const std::size_t line_start = before.rfind('\n');
    const std::size_t column = line_start == std::string_view::npos ? before.size() + 1 : before.size() - line_start;
    return fmt::format("line {}, column {}", line, column);
}

/// The parser's own words without its codes: "unexpected ']'; expected ..."
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

/// Finds a key that stands twice in one object.
class DuplicateFinder {
public:
    bool operator()(int depth, Json::parse_event_t event, const Json& value)
    {
        using Event = Json::parse_event_t;
        if (event == Event::object_start) {
            keys_.emplace_back();
        } else if (event == Event::object_end) {
            keys_.pop_back();
        } else if (event == Event::key && !keys_.empty() && duplicate_.empty()) {
            const std::string& key = value.get_ref<const std::string&>();
            if (!keys_.back().insert(key).second) duplicate_ = key;
        }
        return true;
    }
    const std::string& duplicate() const { return duplicate_; }

private:
    std::vector<std::unordered_set<std::string>> keys_;
    std::string duplicate_;
};

/// Where the key is written for the second time, if it can be told without parsing again.
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
    try {
        if (duplicates == DuplicateKeys::last_wins) return Json::parse(text);
        DuplicateFinder finder;
        Json json = Json::parse(
            text, [&](int depth, Json::parse_event_t event, Json& value) { return finder(depth, event, value); });
        if (!finder.duplicate().empty())
            throw Error(file, place_of_second(text, finder.duplicate()),
                        fmt::format("key '{}' stands twice in one object", printable(finder.duplicate())));
        return json;
    } catch (const Json::parse_error& e) {
        // e.byte counts the byte after which the parser stopped.
        const std::size_t byte = std::min(text.size(), e.byte > 0 ? e.byte - 1 : 0);
        std::string reason = plain_reason(e.what());
        if (byte >= text.size() || reason.find("end of input") != std::string::npos) {
            reason = "the file ends too early: " + reason;
        }
        // Tokens quoted from the file may be long or binary.
        if (reason.size() > 160) reason = reason.substr(0, 160) + "...";
        for (char& c : reason)
            if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = '?';
        throw Error(file, line_and_column(text, byte), "not JSON: " + reason);
    } catch (const Json::out_of_range& e) {
        // A number like 1e999; the parser quotes it, but does not tell where it is.
        const std::string reason = plain_reason(e.what());
        const std::size_t quote = reason.find('\''), end = reason.rfind('\'');
        const std::size_t byte = quote < end ? text.find(reason.substr(quote + 1, end - quote - 1)) : text.npos;
        throw Error(file, byte != text.npos ? line_and_column(text, byte) : "", "not JSON: " + printable(reason));
    }
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
            return "no JSON value";
    }
}

}  // namespace fathom
