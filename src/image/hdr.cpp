#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "fathom/error.h"
#include "image/formats.h"

// Radiance's RGBE: G. Ward, Real Pixels, Graphics Gems II, 1991; the run lengths as in Radiance's
// ray/src/common/color.c.
namespace fathom {

namespace {

using Rgbe = std::array<unsigned char, 4>;

Rgbe rgbe_from(const float* pixel, const DisplayChannels& channels)
{
    // The largest value that the shared exponent can say.
    constexpr float largest = 0x1.fep126f;
    std::array<float, 3> rgb = {pixel[channels.r], pixel[channels.g], pixel[channels.b]};
    // NaN and what is negative have no code.
    for (float& v : rgb) v = v > 0 ? std::min(v, largest) : 0;
    const float top = std::max({rgb[0], rgb[1], rgb[2]});
    if (top < 1e-32f) return {0, 0, 0, 0};
    int exponent = 0;
    std::frexp(top, &exponent);
    // Rounded to nearest; what rounds up to 256 takes the next exponent.
    if (std::lround(std::ldexp(top, 8 - exponent)) > 255) ++exponent;
    Rgbe code;
    for (int c = 0; c < 3; ++c) code[c] = static_cast<unsigned char>(std::lround(std::ldexp(rgb[c], 8 - exponent)));
    code[3] = static_cast<unsigned char>(exponent + 128);
    return code;
}

/// One component of a row as runs (128 + length, value) of at least 4 and literals (length, values).
void append_runs(std::vector<unsigned char>& out, const std::vector<Rgbe>& row, int component)
{
    const std::size_t width = row.size();
    const auto run_at = [&](std::size_t i) {
        std::size_t n = 1;
        while (n < 127 && i + n < width && row[i + n][component] == row[i][component]) ++n;
        return n;
    };
    std::size_t i = 0;
    while (i < width) {
        const std::size_t run = run_at(i);
        if (run >= 4) {
            out.push_back(static_cast<unsigned char>(128 + run));
            out.push_back(row[i][component]);
            i += run;
            continue;
        }
        std::size_t end = i + run;
        while (end < width && end - i < 128 && run_at(end) < 4) ++end;
        out.push_back(static_cast<unsigned char>(end - i));
        for (; i < end; ++i) out.push_back(row[i][component]);
    }
}

/// The bytes of a file, one after the other; asking for more than there are throws.
class Bytes {
public:
    explicit Bytes(const EncodedImage& file) : file_(file) {}

    int next()
    {
        if (position_ >= file_.size) throw Error(file_.name, "", "damaged HDR: the file is cut short");
        return file_.bytes[position_++];
    }
    std::string line()
    {
        std::string text;
        for (int c = next(); c != '\n'; c = next()) text += char(c);
        return text;
    }

private:
    const EncodedImage& file_;
    std::size_t position_ = 0;
};

Rgbe next_code(Bytes& bytes)
{
    Rgbe code;
    for (unsigned char& part : code) part = static_cast<unsigned char>(bytes.next());
    return code;
}

void read_runs(const EncodedImage& file, Bytes& bytes, std::vector<Rgbe>& row)
{
    for (int component = 0; component < 4; ++component)
        for (std::size_t x = 0; x < row.size();) {
            const int lead = bytes.next();
            const std::size_t count = std::size_t(lead > 128 ? lead - 128 : lead);
            if (count == 0 || count > row.size() - x) throw Error(file.name, "", "damaged HDR: a run leaves its row");
            const int repeated = lead > 128 ? bytes.next() : 0;
            for (const std::size_t end = x + count; x < end; ++x)
                row[x][component] = static_cast<unsigned char>(lead > 128 ? repeated : bytes.next());
        }
}

/// Rows without runs by component: codes, where (1, 1, 1, n) repeats the one before; repeats that follow each other
/// count 256 times as much each.
void read_codes(const EncodedImage& file, Bytes& bytes, Rgbe first, std::vector<Rgbe>& row)
{
    int shift = 0;
    Rgbe code = first;
    for (std::size_t x = 0; x < row.size();) {
        if (code[0] == 1 && code[1] == 1 && code[2] == 1) {
            const std::size_t count = shift > 24 ? 0 : std::size_t(code[3]) << shift;
            if (x == 0 || count == 0 || count > row.size() - x)
                throw Error(file.name, "", "damaged HDR: a run leaves its row");
            std::fill_n(row.begin() + std::ptrdiff_t(x), count, row[x - 1]);
            x += count;
            shift += 8;
        } else {
            row[x++] = code;
            shift = 0;
        }
        if (x < row.size()) code = next_code(bytes);
    }
}

}  // namespace

Image read_hdr(const EncodedImage& file)
{
    Bytes bytes(file);
    for (std::string line = bytes.line(); !line.empty(); line = bytes.line())
        if (line.rfind("FORMAT=", 0) == 0 && line != "FORMAT=32-bit_rle_rgbe")
            throw Error(file.name, line, "only 32-bit_rle_rgbe can be read");
    const std::string resolution = bytes.line();
    long long width = 0, height = 0;
    if (std::sscanf(resolution.c_str(), "-Y %9lld +X %9lld", &height, &width) != 2 || width <= 0 || height <= 0)
        throw Error(
            file.name, "",
            fmt::format("damaged HDR: expected a size as '-Y 600 +X 800', found '{}'", resolution.substr(0, 40)));
    check_size(file, std::uint64_t(width), std::uint64_t(height), 3 * sizeof(float));
    // A row has 4 components, each of runs of at most 127; older files repeat a row with 8 bytes or more.
    if (double(height) * 4 > double(file.size)) throw Error(file.name, "", "damaged HDR: the file is cut short");

    Image image = make_image(int(width), int(height), 3);
    float* out = image.layers[0].pixels.data();
    std::vector<Rgbe> row(static_cast<std::size_t>(width));
    for (int y = 0; y < image.height; ++y) {
        const Rgbe first = next_code(bytes);
        const bool runs =
            width >= 8 && width < 32768 && first[0] == 2 && first[1] == 2 && (first[2] << 8 | first[3]) == width;
        if (runs)
            read_runs(file, bytes, row);
        else
            read_codes(file, bytes, first, row);
        for (const Rgbe& code : row) {
            const float scale = code[3] ? std::ldexp(1.0f, code[3] - 136) : 0;
            for (int c = 0; c < 3; ++c) *out++ = float(code[c]) * scale;
        }
    }
    image.is_linear = true;
    return image;
}

std::vector<unsigned char> encode_hdr(const Image& image)
{
    const Image::Layer& layer = image.layers[0];
    const DisplayChannels channels = display_channels(layer);
    const std::string header =
        fmt::format("#?RADIANCE\nSOFTWARE=Fathom\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", image.height, image.width);
    std::vector<unsigned char> out(header.begin(), header.end());
    const std::size_t width = std::size_t(image.width);
    // The code of a compressed row has 15 bits for the width, and readers take rows below 8 as uncompressed.
    const bool runs = width >= 8 && width < 32768;
    std::vector<Rgbe> row(width);
    const float* pixel = layer.pixels.data();
    for (int y = 0; y < image.height; ++y) {
        for (std::size_t x = 0; x < width; ++x, pixel += layer.channels.size()) row[x] = rgbe_from(pixel, channels);
        if (runs) {
            out.insert(out.end(),
                       {2, 2, static_cast<unsigned char>(width >> 8), static_cast<unsigned char>(width & 255)});
            for (int component = 0; component < 4; ++component) append_runs(out, row, component);
        } else {
            for (const Rgbe& code : row) out.insert(out.end(), code.begin(), code.end());
        }
    }
    return out;
}

}  // namespace fathom
