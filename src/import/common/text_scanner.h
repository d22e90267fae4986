#pragma once
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "fathom/error.h"
#include "import/common/read_file.h"

namespace fathom {

/// Walks through the words of a text and knows in which line it is. Numbers must be finite.
class TextScanner {
public:
    TextScanner(const std::string& file, std::string_view text, std::size_t first_line = 1)
        : file_(&file), at_(text.data()), end_(text.data() + text.size()), line_(first_line)
    {
    }

    bool at_end() const { return at_ == end_; }
    std::size_t line() const { return line_; }
    const char* position() const { return at_; }

    /// The next word of this line; empty at its end. A backslash before the line's end joins it with the next.
    std::string_view word()
    {
        skip_blanks();
        const char* start = at_;
        while (at_ != end_ && !is_space(*at_) && !(*at_ == '\\' && continues())) ++at_;
        return {start, std::size_t(at_ - start)};
    }
    /// The next word of any line; empty at the end of the text.
    std::string_view word_of_any_line()
    {
        while (at_ != end_ && is_space(*at_)) {
            if (*at_ == '\n') ++line_;
            ++at_;
        }
        const char* start = at_;
        while (at_ != end_ && !is_space(*at_)) ++at_;
        return {start, std::size_t(at_ - start)};
    }
    /// What is left of this line, without blanks around it.
    std::string_view rest()
    {
        skip_blanks();
        const char* start = at_;
        while (at_ != end_ && *at_ != '\n') ++at_;
        const char* stop = at_;
        while (stop != start && is_space(stop[-1])) --stop;
        return {start, std::size_t(stop - start)};
    }
    /// To the end of a comment: a backslash there joins nothing.
    void skip_comment()
    {
        while (at_ != end_ && *at_ != '\n') ++at_;
    }
    /// To the beginning of the next line.
    void next_line()
    {
        while (at_ != end_ && *at_ != '\n') {
            if (*at_ == '\\' && continues())
                skip_continuation();
            else
                ++at_;
        }
        if (at_ != end_) ++at_, ++line_;
    }
    bool line_has_more()
    {
        skip_blanks();
        return at_ != end_ && *at_ != '\n';
    }

    float number() { return to_number(word()); }
    float to_number(std::string_view word) const
    {
        double value = 0;
        // A sign that from_chars does not know.
        std::string_view digits = word;
        if (digits.size() > 1 && digits[0] == '+') digits.remove_prefix(1);
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        // Too small for double is 0, too large is not finite.
        if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
            fail(fmt::format("expected a number, found '{}'", printable(word)));
        if (error == std::errc::result_out_of_range && digits.find("e-") == std::string_view::npos &&
            digits.find("E-") == std::string_view::npos)
            fail(fmt::format("the number '{}' is too large", printable(word)));
        if (!(std::abs(value) <= std::numeric_limits<float>::max()))
            fail(fmt::format("the number '{}' is not finite", printable(word)));
        return float(value);
    }
    template <class Int>
    Int to_integer(std::string_view word) const
    {
        Int value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size())
            fail(fmt::format("expected a whole number, found '{}'", printable(word)));
        return value;
    }

    [[noreturn]] void fail(const std::string& message) const
    {
        throw Error(*file_, fmt::format("line {}", line_), message);
    }

private:
    static bool is_space(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }
    bool continues() const
    {
        const char* next = at_ + 1;
        if (next != end_ && *next == '\r') ++next;
        return next == end_ || *next == '\n';
    }
    void skip_continuation()
    {
        while (at_ != end_ && *at_ != '\n') ++at_;
        if (at_ != end_) ++at_, ++line_;
    }
    void skip_blanks()
    {
        while (at_ != end_ && *at_ != '\n') {
            if (*at_ == '\\' && continues())
                skip_continuation();
            else if (is_space(*at_))
                ++at_;
            else
                break;
        }
    }

    const std::string* file_;
    const char* at_;
    const char* end_;
    std::size_t line_;
};

}  // namespace fathom
