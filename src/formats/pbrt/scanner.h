// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace fathom::pbrt {

/// A position in a file.
struct Place {
    std::shared_ptr<const std::string> file;
    std::size_t line = 1, column = 1;

    [[noreturn]] void fail(const std::string& message) const;
    /// "file: line 3, column 5"
    std::string text() const;
};

/// A token of the scene language: a directive, a number, a string without its quotes, or a bracket.
struct Token {
    enum class Kind { end, word, string, open, close } kind = Kind::end;
    std::string_view text;
    bool escaped = false;  ///< the string contains backslashes
};

/// Tokenizes a text and keeps track of the position. The text must outlive this object.
class Scanner {
public:
    Scanner(std::shared_ptr<const std::string> file, std::string_view text);

    /// The next token, without consuming it.
    const Token& peek();
    /// Consumes and returns the next token.
    Token next();
    /// Start of the token of the last next() or peek().
    Place place() const;
    /// Reads a number; throws Error if the next token is something else.
    double number();
    /// Reads a number if one follows; it is faster than next(), since no token is made.
    template <class Number>
    bool try_number(Number& value);

    [[noreturn]] void fail(const std::string& message) const { place().fail(message); }

private:
    void skip_blanks();
    bool begin_number();
    Token scan();

    std::shared_ptr<const std::string> file_;
    const char *at_, *end_, *line_start_, *token_start_;
    std::size_t line_ = 1, token_line_ = 1;
    const char* token_line_start_;
    std::optional<Token> peeked_;
};

/// The string with its escape sequences resolved.
std::string unescaped(const Token& token);

}  // namespace fathom::pbrt
