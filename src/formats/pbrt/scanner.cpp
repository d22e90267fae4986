// SPDX-License-Identifier: Apache-2.0
#include "formats/pbrt/scanner.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>

#include "fathom/error.h"
#include "formats/io/read_file.h"

namespace fathom::pbrt {

namespace {

bool is_blank(char c)
{
    return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}
bool ends_word(char c)
{
    return is_blank(c) || c == '"' || c == '[' || c == ']' || c == '#';
}
bool begins_number(char c)
{
    return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.';
}

}  // namespace

void Place::fail(const std::string& message) const
{
    throw Error(file ? *file : "", fmt::format("line {}, column {}", line, column), message);
}

std::string Place::text() const
{
    return fmt::format("{}: line {}, column {}", file ? *file : "", line, column);
}

Scanner::Scanner(std::shared_ptr<const std::string> file, std::string_view text)
    : file_(std::move(file)),
      at_(text.data()),
      end_(text.data() + text.size()),
      line_start_(at_),
      token_start_(at_),
      token_line_start_(at_)
{
}

Place Scanner::place() const
{
    return {file_, token_line_, std::size_t(token_start_ - token_line_start_) + 1};
}

void Scanner::skip_blanks()
{
    for (; at_ != end_; ++at_) {
        if (*at_ == '#')
            while (at_ + 1 != end_ && at_[1] != '\n' && at_[1] != '\r') ++at_;
        else if (*at_ == '\n' || (*at_ == '\r' && (at_ + 1 == end_ || at_[1] != '\n')))
            ++line_, line_start_ = at_ + 1;
        else if (!is_blank(*at_))
            return;
    }
}

Token Scanner::scan()
{
    skip_blanks();
    token_start_ = at_, token_line_ = line_, token_line_start_ = line_start_;
    if (at_ == end_) return {};
    if (*at_ == '[') return ++at_, Token{Token::Kind::open, "[", false};
    if (*at_ == ']') return ++at_, Token{Token::Kind::close, "]", false};
    if (*at_ == '"') {
        Token token{Token::Kind::string, {}, false};
        const char* const start = ++at_;
        while (at_ != end_ && *at_ != '"') {
            if (*at_ == '\n') fail("a string is not closed on its line");
            if (*at_ == '\\' && at_ + 1 != end_) token.escaped = true, ++at_;
            ++at_;
        }
        if (at_ == end_) fail("a string is not closed before the end of the file");
        token.text = {start, std::size_t(at_ - start)};
        ++at_;
        return token;
    }
    const char* const start = at_;
    while (at_ != end_ && !ends_word(*at_)) ++at_;
    return {Token::Kind::word, {start, std::size_t(at_ - start)}, false};
}

const Token& Scanner::peek()
{
    if (!peeked_) peeked_ = scan();
    return *peeked_;
}

Token Scanner::next()
{
    if (peeked_) {
        const Token token = *peeked_;
        peeked_.reset();
        return token;
    }
    return scan();
}

namespace {

/// Whether digits that don't fit their type are a number too close to 0 rather than too large.
bool is_underflow(std::string_view digits)
{
    double value = 0;
    const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const bool has_negative_exponent =
        digits.find_first_of("eE") != std::string_view::npos && digits.find('-', 1) != std::string_view::npos;
    return has_negative_exponent && (result.ec != std::errc() || std::abs(value) < 1);
}

}  // namespace

/// Moves to the next token. False unless it looks like a number.
bool Scanner::begin_number()
{
    if (peeked_) {
        // Rewinds to the beginning of the token, which contains no line ends.
        if (peeked_->kind != Token::Kind::word) return false;
        at_ = peeked_->text.data();
        peeked_.reset();
    }
    skip_blanks();
    token_start_ = at_, token_line_ = line_, token_line_start_ = line_start_;
    return at_ != end_ && begins_number(*at_);
}

template <class Number>
bool Scanner::try_number(Number& value)
{
    if (!begin_number()) return false;
    constexpr bool is_integer = std::is_integral_v<Number>;
    const char* const digits = *at_ == '+' ? at_ + 1 : at_;
    const auto [stop, error] = std::from_chars(digits, end_, value);
    const bool is_whole = stop == end_ || ends_word(*stop);
    if (error == std::errc::result_out_of_range && is_whole) {
        if (is_integer || !is_underflow({digits, std::size_t(stop - digits)}))
            fail(fmt::format("the number '{}' is too large", printable({at_, std::size_t(stop - at_)})));
        value = 0;
    } else if (error != std::errc() || !is_whole) {
        const char* word_end = at_;
        while (word_end != end_ && !ends_word(*word_end)) ++word_end;
        fail(fmt::format("expected {}, found '{}'", is_integer ? "a whole number" : "a number",
                         printable({at_, std::size_t(word_end - at_)})));
    }
    if constexpr (!is_integer)
        if (!std::isfinite(value)) fail("a number must be finite");
    at_ = stop;
    return true;
}

template bool Scanner::try_number(double&);
template bool Scanner::try_number(float&);
template bool Scanner::try_number(std::int32_t&);

double Scanner::number()
{
    double value = 0;
    if (try_number(value)) return value;
    const Token found = next();
    fail(found.kind == Token::Kind::end ? std::string("the file ends where a number is expected")
                                        : fmt::format("expected a number, found '{}'", printable(found.text)));
}

std::string unescaped(const Token& token)
{
    std::string text(token.text);
    if (!token.escaped) return text;
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '\\' || i + 1 == text.size()) {
            result += text[i];
            continue;
        }
        const char c = text[++i];
        result += c == 'n' ? '\n' : c == 't' ? '\t' : c == 'r' ? '\r' : c == 'b' ? '\b' : c == 'f' ? '\f' : c;
    }
    return result;
}

}  // namespace fathom::pbrt
