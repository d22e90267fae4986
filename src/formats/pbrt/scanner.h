#pragma once
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace fathom::pbrt {

/// Where something stands in a file.
struct Place {
    std::shared_ptr<const std::string> file;
    std::size_t line = 1, column = 1;

    [[noreturn]] void fail(const std::string& message) const;
    /// "file: line 3, column 5"
    std::string text() const;
};

/// A word of the scene language: a directive, a number, a quoted string without its quotes, or a bracket.
struct Token {
    enum class Kind { end, word, string, open, close } kind = Kind::end;
    std::string_view text;
    bool escaped = false;  ///< a string with backslashes in it
};

/// Walks through a text that outlives it, and knows where it is.
class Scanner {
public:
    Scanner(std::shared_ptr<const std::string> file, std::string_view text);

    /// What comes next, which stays there.
    const Token& peek();
    Token next();
    /// Where the token of the last next() or peek() begins.
    Place place() const;
    /// A number, where one must be.
    double number();
    /// Whether a number comes next; it is read straight, without a token of its own.
    template <class Number>
    bool try_number(Number& value);

    [[noreturn]] void fail(const std::string& message) const { place().fail(message); }

private:
    void skip_blanks();
    Token scan();

    std::shared_ptr<const std::string> file_;
    const char *at_, *end_, *line_start_, *token_start_;
    std::size_t line_ = 1, token_line_ = 1;
    const char* token_line_start_;
    std::optional<Token> peeked_;
};

/// A string with its backslashes resolved.
std::string unescaped(const Token& token);

}  // namespace fathom::pbrt
