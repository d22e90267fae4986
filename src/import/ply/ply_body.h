#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "import/common/text_scanner.h"
#include "import/ply/ply_header.h"

namespace fathom {

static_assert(std::endian::native == std::endian::little);

/// The numbers of the body one after the other, whatever they are written as.
class PlyBody {
public:
    PlyBody(const std::string& file, std::string_view body, PlyFormat format, std::size_t first_line)
        : file_(file), at_(body.data()), end_(body.data() + body.size()), format_(format), scan_(file, body, first_line)
    {
    }

    double number(PlyType type)
    {
        if (format_ == PlyFormat::ascii) {
            const std::string_view word = scan_.word_of_any_line();
            if (word.empty()) scan_.fail("the file ends too early");
            // Exact for 32-bit integers, which float would not be.
            if (type != PlyType::f32 && type != PlyType::f64) {
                std::int64_t value = 0;
                const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
                if (error == std::errc() && end == word.data() + word.size()) return double(value);
            }
            return scan_.to_number(word);
        }
        need(size_of(type));
        const char* p = at_;
        at_ += size_of(type);
        switch (type) {
            case PlyType::i8:
                return load<std::int8_t>(p);
            case PlyType::u8:
                return load<std::uint8_t>(p);
            case PlyType::i16:
                return load<std::int16_t>(p);
            case PlyType::u16:
                return load<std::uint16_t>(p);
            case PlyType::i32:
                return load<std::int32_t>(p);
            case PlyType::u32:
                return load<std::uint32_t>(p);
            case PlyType::f32:
                return load<float>(p);
            default:
                return load<double>(p);
        }
    }
    std::size_t list_length(PlyType type)
    {
        const double length = number(type);
        if (!(length >= 0)) fail(fmt::format("a list of {} elements", length));
        if (length > double(bytes_left()) + 1)
            fail(fmt::format("a list of {} elements does not fit into the file", length));
        return std::size_t(length);
    }
    void skip(const PlyProperty& property)
    {
        const std::size_t count = property.is_list ? list_length(property.count_type) : 1;
        if (format_ == PlyFormat::ascii) {
            for (std::size_t i = 0; i < count; ++i)
                if (scan_.word_of_any_line().empty()) scan_.fail("the file ends too early");
        } else {
            // list_length has bounded count: no overflow.
            need(count * size_of(property.type));
            at_ += count * size_of(property.type);
        }
    }

    /// Bytes of a binary body, for loops of their own.
    const char* take(std::size_t size)
    {
        need(size);
        const char* p = at_;
        at_ += size;
        return p;
    }
    std::size_t bytes_left() const
    {
        return std::size_t(end_ - (format_ == PlyFormat::ascii ? scan_.position() : at_));
    }
    bool is_native() const { return format_ == PlyFormat::little_endian; }

    [[noreturn]] void fail(const std::string& message) const
    {
        if (format_ == PlyFormat::ascii) scan_.fail(message);
        throw Error(file_, "", message);
    }

private:
    void need(std::size_t size) const
    {
        if (bytes_left() < size) fail("the file ends too early");
    }
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
    const char* at_;
    const char* end_;
    PlyFormat format_;
    TextScanner scan_;
};

}  // namespace fathom
