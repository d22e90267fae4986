// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <vector>

#include "film/film_data.h"

namespace fathom {

namespace {

/// Moments of a pixel's samples: mean per channel; mean square and variance summed over channels. Floats save memory.
struct Moments {
    std::array<float, 3> mean{};
    float square = 0, variance = 0;
};

Moments moments_of(const std::uint32_t* sums, double n)
{
    Moments m;
    double squares = 0, variance = 0;
    for (int c = 0; c < 3; ++c) {
        const double mean = ExactSum::value(radiance_sum(sums, c)) / n;
        const double square = ExactSquareSum::value(square_sum(sums, c)) / n;
        m.mean[std::size_t(c)] = float(mean);
        squares += square;
        variance += std::max(0.0, square - mean * mean);
    }
    m.square = float(squares), m.variance = float(variance);
    return m;
}

double squared_mean(const Moments& m)
{
    double sum = 0;
    for (const double c : m.mean) sum += c * c;
    return sum;
}

/// Square blocks of pixels, each with the pixel of median variance as its typical one.
class Blocks {
public:
    static constexpr int side = 8;

    Blocks(const std::vector<Moments>& pixels, int width, int height)
        : columns_((width + side - 1) / side), rows_((height + side - 1) / side)
    {
        std::vector<Moments> inside;
        for (int row = 0; row < rows_; ++row)
            for (int column = 0; column < columns_; ++column) {
                inside.clear();
                for (int y = row * side; y < std::min(height, (row + 1) * side); ++y)
                    for (int x = column * side; x < std::min(width, (column + 1) * side); ++x)
                        inside.push_back(pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]);
                const auto middle = inside.begin() + std::ptrdiff_t(inside.size() / 2);
                std::nth_element(inside.begin(), middle, inside.end(),
                                 [](const Moments& a, const Moments& b) { return a.variance < b.variance; });
                usual_.push_back(*middle);
            }
    }
    /// Typical pixel of the noisiest of the nine blocks around a pixel, so that the edge of a noisy region is not an
    /// outlier.
    const Moments& typical_around(int x, int y) const
    {
        const Moments* most = nullptr;
        for (int row = std::max(y / side - 1, 0); row <= std::min(y / side + 1, rows_ - 1); ++row)
            for (int column = std::max(x / side - 1, 0); column <= std::min(x / side + 1, columns_ - 1); ++column) {
                const Moments& m = usual_[std::size_t(row) * std::size_t(columns_) + std::size_t(column)];
                if (!most || m.variance > most->variance) most = &m;
            }
        return *most;
    }

private:
    int columns_, rows_;
    std::vector<Moments> usual_;
};

/// Moments of all rendered pixels of a film.
class Pixels {
public:
    explicit Pixels(const Film& film)
    {
        const Crop inside = film.key().settings.rendered_pixels();
        width_ = inside.x1 - inside.x0, height_ = inside.y1 - inside.y0;
        const double n = double(film.samples_per_pixel());
        for (int y = inside.y0; y < inside.y1; ++y)
            for (int x = inside.x0; x < inside.x1; ++x)
                all_.push_back(
                    moments_of(film.data().pixel(std::size_t(y) * std::size_t(film.width()) + std::size_t(x)), n));
    }
    int width() const { return width_; }
    int height() const { return height_; }
    const std::vector<Moments>& all() const { return all_; }
    const Moments& at(int x, int y) const { return all_[std::size_t(y) * std::size_t(width_) + std::size_t(x)]; }
    /// The largest squared mean among the eight neighbors of a pixel.
    double brightest_neighbor(int x, int y) const
    {
        double most = 0;
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height_ - 1); ++v)
            for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width_ - 1); ++u)
                if (u != x || v != y) most = std::max(most, squared_mean(at(u, v)));
        return most;
    }

private:
    int width_ = 0, height_ = 0;
    std::vector<Moments> all_;
};

/// Number and squared height of outliers among the n samples of a pixel, assuming that all have equal height h above
/// the typical mean: k outliers add k h to the sum and k h^2 to the sum of squares.
struct Outliers {
    double count = 0, height2 = 0;

    Outliers(const Moments& m, const Moments& typical, double n)
    {
        double sum2 = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double sum = n * std::max(0.0, double(m.mean[c]) - double(typical.mean[c]));
            sum2 += sum * sum;
        }
        const double squares = n * (double(m.square) - double(typical.square));
        if (!(squares > 0) || !(sum2 > 0)) return;
        count = std::clamp(sum2 / squares, 1.0, n);
        height2 = squares / count;
    }
};

}  // namespace

Film::Fireflies Film::fireflies() const
{
    constexpr double fewest_samples = 4;
    /// Threshold on the variance relative to the typical one; it is high because the variance of few samples is itself
    /// uncertain.
    constexpr double far_beyond = 25;
    /// Largest fraction of bright samples in a pixel with fireflies; at the edge of a bright object more samples are
    /// bright.
    constexpr double few = 1 / 16.0;
    /// Threshold relative to each neighbor's mean; next to a bright object the filter causes a few bright samples of
    /// lower value.
    constexpr double much_brighter = 4;
    const double n = double(samples_per_pixel());
    if (n < fewest_samples) return {};
    const Pixels pixels(*this);
    double noise = 0;
    for (const Moments& m : pixels.all()) noise += double(m.variance);
    if (!(noise > 0)) return {};

    const Blocks blocks(pixels.all(), pixels.width(), pixels.height());
    Fireflies found;
    for (int y = 0; y < pixels.height(); ++y)
        for (int x = 0; x < pixels.width(); ++x) {
            const Moments &m = pixels.at(x, y), &typical = blocks.typical_around(x, y);
            if (!(double(m.variance) > far_beyond * double(typical.variance))) continue;
            const Outliers outliers(m, typical, n);
            if (outliers.count > std::max(1.0, few * n)) continue;
            if (outliers.height2 < much_brighter * much_brighter * pixels.brightest_neighbor(x, y)) continue;
            found.noise += (double(m.variance) - double(typical.variance)) / noise;
            found.samples += outliers.count;
        }
    found.samples /= n * double(pixels.all().size());
    return found;
}

}  // namespace fathom
