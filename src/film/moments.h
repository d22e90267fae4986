// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>

#include "film/film_data.h"
#include "film/probes.h"

namespace fathom {

/// Red, green and blue of linear Rec.709 radiance.
using Channels = std::array<double, 3>;

/// Mean of a pixel's samples, and the variance of this mean as its samples show it.
struct ChannelMoments {
    Channels mean{};
    Channels variance{};        ///< of paths from the camera, as if their samples were independent
    Channels splat_variance{};  ///< of light paths

    double all_variance(std::size_t channel) const { return variance[channel] + splat_variance[channel]; }
};

/// The sums of a film's pixels as means and variances. Coordinates are those of the whole image.
class FilmMoments {
public:
    explicit FilmMoments(const Film& film)
        : film_(film.data()), samples_(double(film.samples_per_pixel())), scale_(samples_ > 0 ? 1 / samples_ : 0)
    {
    }

    /// Returns the moments of a pixel; variances are 0 below two samples per pixel.
    ChannelMoments of(const std::uint32_t* pixel) const
    {
        ChannelMoments m;
        const FilmLayout& layout = film_.layout;
        for (std::size_t c = 0; c < 3; ++c) {
            m.mean[c] = ExactSum::value(radiance_sum(pixel, int(c))) * scale_;
            if (samples_ > 1) {
                const double square = ExactSquareSum::value(square_sum(pixel, int(c))) * scale_;
                m.variance[c] = std::max(0.0, square - m.mean[c] * m.mean[c]) / (samples_ - 1);
            }
            if (layout.splats < 0) continue;
            m.mean[c] += ExactSum::value(other_sum(pixel, layout.splats + int(c))) * scale_;
            // Splats are rare: the variance of their sum is the sum of their squares.
            if (samples_ > 1)
                m.splat_variance[c] = ExactSquareSum::value(layout.splat_square(pixel, int(c))) * scale_ * scale_;
        }
        return m;
    }
    ChannelMoments of(int x, int y) const { return of(pixel(x, y)); }
    /// Returns the number of equally bright samples that would have the sum and the sum of squares of a pixel's
    /// samples, at least 1.
    double effective_samples(int x, int y) const
    {
        const std::uint32_t* const sums = pixel(x, y);
        double squared_sums = 0, squares = 0;
        for (int c = 0; c < 3; ++c) {
            double sum = ExactSum::value(radiance_sum(sums, c));
            squares += ExactSquareSum::value(square_sum(sums, c));
            if (const FilmLayout& layout = film_.layout; layout.splats >= 0) {
                sum += ExactSum::value(other_sum(sums, layout.splats + c));
                squares += ExactSquareSum::value(layout.splat_square(sums, c));
            }
            squared_sums += sum * sum;
        }
        return squares > 0 ? std::max(1.0, squared_sums / squares) : 1;
    }
    /// Returns the mean of what paths from the camera bring to a pixel.
    Channels path_mean(int x, int y) const
    {
        const std::uint32_t* const sums = pixel(x, y);
        Channels mean{};
        for (std::size_t c = 0; c < 3; ++c) mean[c] = ExactSum::value(radiance_sum(sums, int(c))) * scale_;
        return mean;
    }
    /// Returns the same mean of a probe's second result.
    Channels second_mean(const Probe& probe) const
    {
        Channels mean{};
        for (std::size_t c = 0; c < 3; ++c)
            mean[c] = ExactSum::value(other_sum(film_.pixel(probe.sums + c), film_.layout.probe)) * scale_;
        return mean;
    }

private:
    const std::uint32_t* pixel(int x, int y) const
    {
        return film_.pixel(std::size_t(y) * std::size_t(film_.width) + std::size_t(x));
    }

    const Film::Data& film_;
    const double samples_, scale_;
};

}  // namespace fathom
