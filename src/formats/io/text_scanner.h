// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "fathom/error.h"
#include "formats/io/read_file.h"

namespace fathom {

/// Splits a text into words and keeps track of the line number. Numbers must be finite. Lines end with LF, CR LF or CR.
class TextScanner {
public:
    /// comment  character that starts a comment up to the end of the line; 0 if the format has none
    TextScanner(const std::string& file, std::string_view text, std::size_t first_line = 1, char comment = '\0')
        : file_(&file), at_(text.data()), end_(text.data() + text.size()), line_(first_line), comment_(comment)
    {
    }

    bool at_end() const { return at_ == end_; }
    std::size_t line() const { return line_; }
    const char* position() const { return at_; }

    /// The next word of this line; empty at the line's end and at a comment. A backslash before the end of a line
    /// continues it.
    std::string_view word()
    {
        skip_blanks();
        const char* start = at_;
        while (at_ != end_ && !is_space(*at_) && !at_comment() && !(*at_ == '\\' && continues())) ++at_;
        return {start, std::size_t(at_ - start)};
    }
    /// The next word on this or a later line; empty at the end of the text.
    std::string_view word_of_any_line()
    {
        while (at_ != end_ && is_space(*at_)) {
            // A CR at the end of the text may be the first half of a CR LF.
            if (*at_ == '\n' || (*at_ == '\r' && at_ + 1 != end_ && at_[1] != '\n')) ++line_;
            ++at_;
        }
        const char* start = at_;
        while (at_ != end_ && !is_space(*at_)) ++at_;
        return {start, std::size_t(at_ - start)};
    }
    /// The rest of the line, including comments, without surrounding whitespace.
    std::string_view rest()
    {
        skip_blanks();
        const char* start = at_;
        while (!at_line_end()) ++at_;
        const char* stop = at_;
        while (stop != start && is_space(stop[-1])) --stop;
        return {start, std::size_t(stop - start)};
    }
    /// Moves to the next line. A backslash at the end of a comment doesn't continue the line.
    void next_line()
    {
        while (!at_line_end() && !at_comment()) {
            if (*at_ == '\\' && continues())
                pass_line_end();
            else
                ++at_;
        }
        pass_line_end();
    }
    bool line_has_more()
    {
        skip_blanks();
        return !at_line_end() && !at_comment();
    }

    float number() { return to_number(word()); }
    float to_number(std::string_view word) const
    {
        double value = 0;
        // std::from_chars rejects a leading plus sign.
        std::string_view digits = word;
        if (digits.size() > 1 && digits[0] == '+') digits.remove_prefix(1);
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        // Numbers too small for double become 0; numbers too large are errors.
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
    bool at_comment() const { return comment_ != '\0' && at_ != end_ && *at_ == comment_; }
    /// A CR before LF counts as whitespace.
    bool at_line_end() const
    {
        return at_ == end_ || *at_ == '\n' || (*at_ == '\r' && (at_ + 1 == end_ || at_[1] != '\n'));
    }
    bool continues() const { return at_ + 1 == end_ || at_[1] == '\n' || at_[1] == '\r'; }
    void pass_line_end()
    {
        while (!at_line_end()) ++at_;
        if (at_ != end_) ++at_, ++line_;
    }
    void skip_blanks()
    {
        while (!at_line_end()) {
            if (*at_ == '\\' && continues())
                pass_line_end();
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
    char comment_;
};

}  // namespace fathom
