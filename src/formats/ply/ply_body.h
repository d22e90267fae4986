// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "formats/io/input_window.h"
#include "formats/io/text_scanner.h"
#include "formats/ply/ply_header.h"

namespace fathom {

static_assert(std::endian::native == std::endian::little);

/// Reads the numbers of a PLY body in sequence, in any format and type.
class PlyBody {
public:
    /// window  positioned at the beginning of the body
    PlyBody(const std::string& file, InputWindow& window, PlyFormat format, std::size_t first_line)
        : file_(file), window_(window), format_(format), scan_(file, {}, first_line)
    {
    }

    double number(PlyType type)
    {
        if (format_ == PlyFormat::ascii) {
            const std::string_view word = next_word();
            // Integers are parsed exactly: float would round 32-bit values.
            if (type != PlyType::f32 && type != PlyType::f64) {
                std::int64_t value = 0;
                const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
                if (error == std::errc() && end == word.data() + word.size()) return double(value);
            }
            return scan_.to_number(word);
        }
        const char* p = take(size_of(type));
        return visit_type(type, [&]<class T>() { return double(load<T>(p)); });
    }
    std::size_t list_length(PlyType type)
    {
        const double length = number(type);
        if (!(length >= 0)) fail(fmt::format("a list can't have {} elements", length));
        if (length > double(bytes_left()) + 1)
            fail(fmt::format("a list of {} elements does not fit into the file", length));
        return std::size_t(length);
    }
    void skip(const PlyProperty& property)
    {
        const std::size_t count = property.is_list ? list_length(property.count_type) : 1;
        if (format_ == PlyFormat::ascii)
            for (std::size_t i = 0; i < count; ++i) next_word();
        else
            for (std::size_t i = 0; i < count; ++i) take(size_of(property.type));
    }

    /// Returns the following bytes of a binary body without moving on, for specialized loops: at least `least` if the
    /// file has them.
    std::string_view peek(std::size_t least) { return window_.peek(least); }
    /// The next `size` bytes in one contiguous piece. Throws Error at the end of the file.
    const char* take(std::size_t size)
    {
        const char* const data = window_.take(size);
        if (!data) fail("the file is truncated");
        return data;
    }
    std::uint64_t bytes_left() const { return window_.bytes_left() + (text_.end() - scan_.position()); }
    bool is_native() const { return format_ == PlyFormat::little_endian; }

    [[noreturn]] void fail(const std::string& message) const
    {
        if (format_ == PlyFormat::ascii) scan_.fail(message);
        throw Error(file_, "", message);
    }

private:
    std::string_view next_word()
    {
        for (;;) {
            const std::string_view word = scan_.word_of_any_line();
            if (!word.empty()) return word;
            next_text();
        }
    }
    /// Scans the next part of the window, up to whitespace, so that words stay whole.
    void next_text()
    {
        std::string_view text = window_.peek(1);
        std::size_t size = blank_end(text);
        while (size == 0 && !text.empty()) {
            // The word is longer than the window.
            const std::size_t before = text.size();
            text = window_.peek(2 * before < window_.bytes_left() ? 2 * before : std::size_t(window_.bytes_left()));
            size = text.size() == before ? before : blank_end(text);
        }
        if (size == 0) scan_.fail("the file is truncated");
        text_ = text.substr(0, size);
        window_.pass(size);
        scan_ = TextScanner(file_, text_, scan_.line());
    }
    static std::size_t blank_end(std::string_view text) { return text.find_last_of(" \n\t\r\v\f") + 1; }

    template <class T>
    T load(const char* p) const
    {
        char bytes[sizeof(T)];
        std::memcpy(bytes, p, sizeof(T));
        if (format_ == PlyFormat::big_endian) std::reverse(bytes, bytes + sizeof(T));
        T value;
        std::memcpy(&value, bytes, sizeof(T));
        return value;
    }

    const std::string& file_;
    InputWindow& window_;
    PlyFormat format_;
    std::string_view text_;  ///< text being scanned
    TextScanner scan_;
};

}  // namespace fathom
