// SPDX-License-Identifier: Apache-2.0
#include "lights/compile/textured_emission.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "fathom/description.h"
#include "math/luminance.h"

namespace fathom {

namespace {

/// Value of a finite half.
float of_half(std::uint32_t half)
{
    const float magnitude = std::bit_cast<float>((half & 0x7fffu) << 13) * 0x1p112f;
    return half & 0x8000u ? -magnitude : magnitude;
}

/// Luminance of texels, decoded as in textures/image.h.
class EmittingTexels {
public:
    EmittingTexels(const ShadingTables& tables, const TextureRecord& image) : tables_(tables), image_(image) {}

    double luminance(std::size_t texel) const
    {
        const auto format = TexelFormat(image_.format);
        if (format == TexelFormat::float4) {
            const float* c = &tables_.texels[(image_.texels + texel) * 4];
            return of(c[0], c[1], c[2]);
        }
        const std::uint32_t* words = tables_.packed_images[image_.texels].data();
        if (format == TexelFormat::bytes || format == TexelFormat::bytes_srgb) {
            const auto part = [&](int shift) {
                const std::uint32_t code = words[texel] >> shift & 0xff;
                return format == TexelFormat::bytes ? float(code) / 255 : tables_.linear_of_srgb[code];
            };
            return of(part(0), part(8), part(16));
        }
        const auto value = [&](std::uint32_t code) {
            return format == TexelFormat::halves ? of_half(code) : float(code) / 65535;
        };
        const std::uint32_t low = words[2 * texel], high = words[2 * texel + 1];
        return of(value(low & 0xffff), value(low >> 16), value(high & 0xffff));
    }

private:
    /// Luminance of the magnitudes: negative values of float images must not cancel positive ones.
    static double of(float r, float g, float b)
    {
        const float color[] = {std::abs(r), std::abs(g), std::abs(b)};
        return fathom::luminance(color);
    }

    const ShadingTables& tables_;
    const TextureRecord& image_;
};

bool can_be_summed(const TextureRecord& t)
{
    return TextureKind(t.kind) == TextureKind::image && TextureMapping(t.mapping) == TextureMapping::uv &&
           t.width > 0 && t.height > 0 && std::max(t.wrap_u, t.wrap_v) < std::uint32_t(Wrap::black);
}

/// Texels that a lookup reads, by the wrap mode, for coordinates from low to high: up to two intervals, both ends
/// included.
struct Wrapped {
    std::array<std::array<int, 2>, 2> intervals{};
    std::size_t count = 1;

    Wrapped(double low, double high, int size, std::uint32_t mode)
    {
        // A filter reads half a texel farther; the rest is for rounding.
        const double slack = 1;
        const double first = std::floor(low - slack), last = std::floor(high + slack);
        if (mode == std::uint32_t(Wrap::clamp)) {
            intervals[0] = {int(std::clamp(first, 0., size - 1.)), int(std::clamp(last, 0., size - 1.))};
            return;
        }
        const double turn = std::floor(first / size);
        const double end = last - turn * size;
        if (last - first >= size || (mode != std::uint32_t(Wrap::repeat) && end >= size)) {
            intervals[0] = {0, size - 1};
            return;
        }
        const int begin = int(first - turn * size);
        if (mode != std::uint32_t(Wrap::repeat)) {
            const bool reflected = std::fmod(std::abs(turn), 2) == 1;
            intervals[0] = reflected ? std::array{size - 1 - int(end), size - 1 - begin} : std::array{begin, int(end)};
            return;
        }
        intervals[0] = {begin, std::min(int(end), size - 1)};
        if (end >= size) intervals[count++] = {0, int(end) - size};
    }
};

}  // namespace

TexturedEmission::TexturedEmission(const ShadingTables& tables, const TextureRecord& texture)
    : width_(texture.width),
      height_(texture.height),
      block_(std::max((std::max(width_, height_) + most_blocks - 1) / most_blocks, 1)),
      columns_((width_ + block_ - 1) / block_),
      rows_((height_ + block_ - 1) / block_)
{
    if (!can_be_summed(texture)) return;
    sums_.assign(std::size_t(columns_ + 1) * std::size_t(rows_ + 1), 0);
    tbb::parallel_for(0, rows_, [&](int row) { add_row_of_blocks(tables, texture, row); });
    const auto width = std::size_t(columns_ + 1);
    for (std::size_t i = width; i < sums_.size(); ++i) sums_[i] += sums_[i - width];
}

void TexturedEmission::add_row_of_blocks(const ShadingTables& tables, const TextureRecord& image, int row)
{
    const EmittingTexels texels(tables, image);
    std::uint64_t* const sums = &sums_[std::size_t(row + 1) * std::size_t(columns_ + 1)];
    for (int y = row * block_; y < std::min((row + 1) * block_, height_); ++y)
        for (int x = 0; x < width_; ++x) {
            const double value = texels.luminance(std::size_t(y) * std::size_t(width_) + std::size_t(x));
            sums[x / block_ + 1] += std::uint64_t(std::ceil(std::min(brightest, value) * unit));
        }
    for (int column = 0; column < columns_; ++column) sums[column + 1] += sums[column];
}

double TexturedEmission::mean(int x0, int x1, int y0, int y1) const
{
    const int left = x0 / block_, right = x1 / block_ + 1, top = y0 / block_, bottom = y1 / block_ + 1;
    const auto at = [&](int column, int row) {
        return sums_[std::size_t(row) * std::size_t(columns_ + 1) + std::size_t(column)];
    };
    const std::uint64_t sum = at(right, bottom) - at(left, bottom) - at(right, top) + at(left, top);
    const auto texels = [this](int first, int end, int size) {
        return double(std::min(end * block_, size) - first * block_);
    };
    return double(sum) / unit / (texels(left, right, width_) * texels(top, bottom, height_));
}

std::optional<double> TexturedEmission::over(const TextureRecord& texture, const GeometryTables& geometry,
                                             const ShapeRecord& shape, std::uint32_t triangle) const
{
    const bool is_second = texture.uv_set != 0;
    if (sums_.empty() || !can_be_summed(texture) ||
        !(shape.flags & (is_second ? ShapeRecord::has_uv1 : ShapeRecord::has_uv0)))
        return {};
    const LargeVector<Vec2f>& table = is_second ? geometry.uv1 : geometry.uv0;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    double low[2] = {infinity, infinity}, high[2] = {-infinity, -infinity};
    const std::array sizes{width_, height_};
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const Vec2f& uv = table[geometry.triangles[3 * std::size_t(triangle) + corner]];
        for (std::size_t i = 0; i < 2; ++i) {
            const float* row = &texture.uv_map[3 * i];
            const double u = double(uv.x) * double(row[0]), v = double(uv.y) * double(row[1]), shift = double(row[2]);
            const double x = (u + v + shift) * sizes[i];
            const double terms = (std::abs(u) + std::abs(v) + std::abs(shift)) * sizes[i];
            // Shading computes with floats, whose errors stay below half a texel up to here.
            if (!(terms < 1e6)) return {};
            low[i] = std::min(low[i], x), high[i] = std::max(high[i], x);
        }
    }
    const Wrapped columns(low[0], high[0], width_, texture.wrap_u);
    const Wrapped rows(low[1], high[1], height_, texture.wrap_v);
    double largest = 0;
    for (std::size_t i = 0; i < columns.count; ++i)
        for (std::size_t k = 0; k < rows.count; ++k)
            largest = std::max(largest, mean(columns.intervals[i][0], columns.intervals[i][1], rows.intervals[k][0],
                                             rows.intervals[k][1]));
    return largest;
}

}  // namespace fathom
