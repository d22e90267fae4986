// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

#include "fathom/error.h"
#include "image/codecs/codecs.h"

// Portable float maps: P. Debevec, "PFM Portable FloatMap Image Format". Rows are stored bottom to top. The sign of the
// scale gives the byte order, and its magnitude multiplies all values.
namespace fathom {

namespace {

bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

class PfmHeader {
public:
    explicit PfmHeader(const EncodedImage& file)
        : file_(file), text_(reinterpret_cast<const char*>(file.bytes), std::min<std::size_t>(file.size, 4096))
    {
        const std::string_view magic = word();
        channels = magic == "Pf" ? 1 : magic == "PF" ? 3 : magic == "PF4" ? 4 : 0;
        if (channels == 0) fail("'PF', 'Pf' or 'PF4'", magic);
        width = size();
        height = size();
        scale = number();
        end_line();
    }

    int channels = 0;
    int width = 0, height = 0;
    double scale = 0;
    std::size_t end = 0;  ///< offset of the pixel values

private:
    /// Reads the next word of the header. Words are separated by whitespace and by comments up to the end of the line.
    std::string_view word()
    {
        while (end < text_.size() && (is_blank(text_[end]) || text_[end] == '#'))
            end = text_[end] == '#' ? std::min(text_.find('\n', end), text_.size()) : end + 1;
        const std::size_t start = end;
        while (end < text_.size() && !is_blank(text_[end]) && text_[end] != '#') ++end;
        return text_.substr(start, end - start);
    }
    int size()
    {
        const std::string_view digits = word();
        int value = 0;
        const auto [after, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (error != std::errc() || after != digits.data() + digits.size() || value <= 0) fail("a size", digits);
        return value;
    }
    double number()
    {
        const std::string_view digits = word();
        std::string_view unsigned_digits = digits;
        if (unsigned_digits.starts_with('+')) unsigned_digits.remove_prefix(1);
        double value = 0;
        const auto [after, error] =
            std::from_chars(unsigned_digits.data(), unsigned_digits.data() + unsigned_digits.size(), value);
        const bool is_whole = error == std::errc() && after == digits.data() + digits.size();
        if (!is_whole || value == 0 || !std::isfinite(value)) fail("a scale other than 0", digits);
        return value;
    }
    /// Skips the single whitespace, or CR LF, before the values. No more may be skipped: the first value may begin with
    /// the byte of a whitespace.
    void end_line()
    {
        const std::size_t values = 4 * std::size_t(channels) * std::size_t(width) * std::size_t(height);
        if (end + 1 < text_.size() && text_[end] == '\r' && text_[end + 1] == '\n' && file_.size - end - 1 > values)
            ++end;
        ++end;
    }
    [[noreturn]] void fail(const char* expected, std::string_view found) const
    {
        throw Error(file_.name, "",
                    fmt::format("damaged PFM: expected {}, found '{}'", expected, std::string(found.substr(0, 40))));
    }

    const EncodedImage& file_;
    std::string_view text_;
};

float value_at(const unsigned char* bytes, bool is_little_endian)
{
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < 4; ++i) bits |= std::uint32_t(bytes[i]) << (8 * (is_little_endian ? i : 3 - i));
    return std::bit_cast<float>(bits);
}

}  // namespace

bool is_pfm(const EncodedImage& file)
{
    if (file.size < 3 || file.bytes[0] != 'P') return false;
    const char kind = char(file.bytes[1]), next = char(file.bytes[2]);
    return (kind == 'F' || kind == 'f') && (is_blank(next) || next == '#' || (kind == 'F' && next == '4'));
}

Image read_pfm(const EncodedImage& file)
{
    const PfmHeader header(file);
    check_size(file, std::uint64_t(header.width), std::uint64_t(header.height),
               std::uint64_t(header.channels) * sizeof(float));
    Image image = make_image(header.width, header.height, header.channels);
    std::vector<float>& pixels = image.layers[0].pixels;
    if (header.end > file.size || (file.size - header.end) / 4 < pixels.size())
        throw Error(file.name, "", "the file is truncated");
    const std::size_t row = std::size_t(header.width) * std::size_t(header.channels);
    const float scale = float(std::abs(header.scale));
    const unsigned char* bytes = file.bytes + header.end;
    for (std::size_t y = std::size_t(header.height); y-- > 0;)
        for (std::size_t i = 0; i < row; ++i, bytes += 4)
            pixels[y * row + i] = scale * value_at(bytes, header.scale < 0);
    image.is_linear = true;
    return image;
}

}  // namespace fathom
