// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "fathom/error.h"
#include "image/codecs/codecs.h"
#include "image/color/primaries.h"

// Radiance's RGBE encoding, the counterpart of hdr.cpp. Header and orientations: G. Ward, "The RADIANCE picture file
// format" (ray/doc/filefmts.pdf, "Picture Files"). Run lengths: ray/src/common/color.c.
namespace fathom {

namespace {

using Rgbe = std::array<unsigned char, 4>;

/// Reads a file's bytes in sequence; throws Error at the end of the file.
class Bytes {
public:
    explicit Bytes(const EncodedImage& file) : file_(file) {}

    int next()
    {
        if (position_ >= file_.size) throw Error(file_.name, "", "damaged HDR: the file is truncated");
        return file_.bytes[position_++];
    }
    std::string line()
    {
        std::string text;
        for (int c = next(); c != '\n'; c = next()) text += char(c);
        if (text.ends_with('\r')) text.pop_back();
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
            if (count == 0 || count > row.size() - x) throw Error(file.name, "", "damaged HDR: a run exceeds its row");
            const int repeated = lead > 128 ? bytes.next() : 0;
            for (const std::size_t end = x + count; x < end; ++x)
                row[x][component] = static_cast<unsigned char>(lead > 128 ? repeated : bytes.next());
        }
}

/// Reads a row that is not compressed by component: (1, 1, 1, n) repeats the previous code n times, and each directly
/// following repeat counts 256 times as much.
void read_codes(const EncodedImage& file, Bytes& bytes, Rgbe first, std::vector<Rgbe>& row)
{
    int shift = 0;
    Rgbe code = first;
    for (std::size_t x = 0; x < row.size();) {
        if (code[0] == 1 && code[1] == 1 && code[2] == 1) {
            const std::size_t count = shift > 24 ? 0 : std::size_t(code[3]) << shift;
            if (x == 0 || count == 0 || count > row.size() - x)
                throw Error(file.name, "", "damaged HDR: a run exceeds its row");
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

/// The factors and primaries that the header states for the pixel values.
struct HdrHeader {
    std::array<double, 3> divisor{1, 1, 1};  ///< exposure and color correction that the stored values were multiplied
                                             ///< by
    std::optional<Chromaticities> chromaticities;
};

void divide_by(HdrHeader& header, const std::array<double, 3>& factors)
{
    for (const double factor : factors)
        if (!(factor > 0 && std::isfinite(factor))) return;
    for (std::size_t c = 0; c < 3; ++c) header.divisor[c] *= factors[c];
}

/// Returns the chromaticities. Throws Error if no conversion can be computed from them.
Chromaticities checked(const EncodedImage& file, const Chromaticities& chromaticities)
{
    try {
        conversion(chromaticities, rec709_chromaticities);
    } catch (const Error& error) {
        throw Error(file.name, "PRIMARIES", error.message());
    }
    return chromaticities;
}

void read_header_line(const EncodedImage& file, const std::string& line, HdrHeader& header)
{
    if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
        throw Error(file.name, line, "only 32-bit_rle_rgbe is supported");
    double v[3];
    if (std::sscanf(line.c_str(), "EXPOSURE= %lf", v) == 1) divide_by(header, {v[0], v[0], v[0]});
    if (std::sscanf(line.c_str(), "COLORCORR= %lf %lf %lf", v, v + 1, v + 2) == 3)
        divide_by(header, {v[0], v[1], v[2]});
    Chromaticities c;
    if (std::sscanf(line.c_str(), "PRIMARIES= %f %f %f %f %f %f %f %f", &c.red.x, &c.red.y, &c.green.x, &c.green.y,
                    &c.blue.x, &c.blue.y, &c.white.x, &c.white.y) == 8)
        header.chromaticities = checked(file, c);
}

/// Scan order of a file: runs ("scanlines") along one axis, ordered along the other. '-Y' is top to bottom and '+X' is
/// left to right.
struct Orientation {
    int runs = 0, length = 0;  ///< number of scanlines, and pixels in each
    bool runs_are_columns = false;
    bool runs_flipped = false, pixels_flipped = false;  ///< scanned from the right or from the bottom

    int width() const { return runs_are_columns ? runs : length; }
    int height() const { return runs_are_columns ? length : runs; }
    std::size_t place(int run, int pixel) const
    {
        const int a = runs_flipped ? runs - 1 - run : run, b = pixels_flipped ? length - 1 - pixel : pixel;
        return runs_are_columns ? std::size_t(b) * std::size_t(runs) + std::size_t(a)
                                : std::size_t(a) * std::size_t(length) + std::size_t(b);
    }
};

Orientation read_orientation(const EncodedImage& file, const std::string& line)
{
    char sign[2] = {}, axis[2] = {};
    long long size[2] = {};
    const int found =
        std::sscanf(line.c_str(), " %c%c %9lld %c%c %9lld", &sign[0], &axis[0], &size[0], &sign[1], &axis[1], &size[1]);
    const auto is_sign = [](char c) { return c == '+' || c == '-'; };
    const bool is_good = found == 6 && is_sign(sign[0]) && is_sign(sign[1]) && size[0] > 0 && size[1] > 0 &&
                         ((axis[0] == 'Y' && axis[1] == 'X') || (axis[0] == 'X' && axis[1] == 'Y'));
    if (!is_good)
        throw Error(
            file.name, "",
            fmt::format("damaged HDR: expected a size such as '-Y 600 +X 800', found '{}'", line.substr(0, 40)));
    // In resolution strings X grows to the right and Y upward.
    const auto is_flipped = [&](int i) { return sign[i] == (axis[i] == 'X' ? '-' : '+'); };
    return {int(size[0]), int(size[1]), axis[0] == 'X', is_flipped(0), is_flipped(1)};
}

void read_run(const EncodedImage& file, Bytes& bytes, std::vector<Rgbe>& run)
{
    const Rgbe first = next_code(bytes);
    const std::size_t length = run.size();
    const bool by_component = length >= 8 && length < 32768 && first[0] == 2 && first[1] == 2 &&
                              std::size_t(first[2] << 8 | first[3]) == length;
    if (by_component)
        read_runs(file, bytes, run);
    else
        read_codes(file, bytes, first, run);
}

}  // namespace

Image read_hdr(const EncodedImage& file)
{
    Bytes bytes(file);
    HdrHeader header;
    for (std::string line = bytes.line(); !line.empty(); line = bytes.line()) read_header_line(file, line, header);
    const Orientation orientation = read_orientation(file, bytes.line());
    check_size(file, std::uint64_t(orientation.width()), std::uint64_t(orientation.height()), 3 * sizeof(float));
    // Each scanline takes at least 4 bytes: four components in runs of at most 127, or repeats of 8 bytes in old files.
    if (double(orientation.runs) * 4 > double(file.size))
        throw Error(file.name, "", "damaged HDR: the file is truncated");

    Image image = make_image(orientation.width(), orientation.height(), 3);
    float* const pixels = image.layers[0].pixels.data();
    std::vector<Rgbe> run(std::size_t(orientation.length));
    for (int i = 0; i < orientation.runs; ++i) {
        read_run(file, bytes, run);
        for (int k = 0; k < orientation.length; ++k) {
            const Rgbe& code = run[std::size_t(k)];
            const float scale = code[3] ? std::ldexp(1.0f, code[3] - 136) : 0;
            float* const pixel = pixels + 3 * orientation.place(i, k);
            for (std::size_t c = 0; c < 3; ++c) pixel[c] = float(double(float(code[c]) * scale) / header.divisor[c]);
        }
    }
    image.is_linear = true;
    image.chromaticities = header.chromaticities;
    return image;
}

}  // namespace fathom
