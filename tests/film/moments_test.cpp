// SPDX-License-Identifier: Apache-2.0
#include "film/moments.h"

#include <gtest/gtest.h>

#include "made_film.h"

namespace fathom {
namespace {

/// A film of one pixel with four samples, filled by channel.
struct OnePixel {
    explicit OnePixel(bool light_tracing = false) : film(test::make_test_film(settings(light_tracing)))
    {
        film.data().add_range({0, 4});
    }
    static RenderSettings settings(bool light_tracing)
    {
        RenderSettings s;
        s.width = s.height = 1;
        s.light_paths = light_tracing ? 1 : 0;
        return s;
    }
    void add_path(int channel, double radiance)
    {
        ExactSum::add_number(radiance_sum(film.data().pixel(0), channel), radiance);
        ExactSquareSum::add_number(square_sum(film.data().pixel(0), channel), radiance * radiance);
    }
    void add_splat(int channel, double radiance)
    {
        const FilmLayout& layout = film.data().layout;
        ExactSum::add_number(other_sum(film.data().pixel(0), layout.splats + channel), radiance);
        ExactSquareSum::add_number(layout.splat_square(film.data().pixel(0), channel), radiance * radiance);
    }
    double effective_samples() const { return FilmMoments(film).effective_samples(0, 0); }

    Film film;
};

/// (2 + 2)^2 / (2^2 + 2^2) = 2, whatever the channel.
TEST(FilmMoments, EffectiveSamplesCountEachChannel)
{
    for (int channel = 0; channel < 3; ++channel) {
        OnePixel p;
        p.add_path(channel, 2);
        p.add_path(channel, 2);
        EXPECT_DOUBLE_EQ(p.effective_samples(), 2) << channel;
    }
}

/// The channels have the squared sums 16 and 9 for squares of 8 and 9: 25 / 17.
TEST(FilmMoments, EffectiveSamplesWeighChannelsByTheirLight)
{
    OnePixel p;
    p.add_path(0, 2);
    p.add_path(0, 2);
    p.add_path(2, 3);
    EXPECT_DOUBLE_EQ(p.effective_samples(), 25.0 / 17);
}

/// Splats add to the light of paths: (2 + 1 + 1)^2 / (4 + 1 + 1).
TEST(FilmMoments, EffectiveSamplesIncludeSplats)
{
    OnePixel p(true);
    p.add_path(1, 2);
    p.add_splat(1, 1);
    p.add_splat(1, 1);
    EXPECT_DOUBLE_EQ(p.effective_samples(), 16.0 / 6);
}

TEST(FilmMoments, BlackPixelsHaveOneEffectiveSample)
{
    EXPECT_DOUBLE_EQ(OnePixel().effective_samples(), 1);
}

/// Samples 3, 1, 0 and 0 have the mean 1; the squares' mean is 2.5, so the variance of the mean is (2.5 - 1) / 3.
/// Splats of 2 and 2 add 1 to the mean and 8 / 16 to its variance.
TEST(FilmMoments, AreThoseOfTheMean)
{
    OnePixel p(true);
    p.add_path(2, 3);
    p.add_path(2, 1);
    p.add_splat(2, 2);
    p.add_splat(2, 2);
    const ChannelMoments m = FilmMoments(p.film).of(0, 0);
    EXPECT_DOUBLE_EQ(m.mean[2], 2);
    EXPECT_DOUBLE_EQ(m.variance[2], 0.5);
    EXPECT_DOUBLE_EQ(m.splat_variance[2], 0.5);
    EXPECT_DOUBLE_EQ(m.all_variance(2), 1);
    EXPECT_DOUBLE_EQ(FilmMoments(p.film).path_mean(0, 0)[2], 1);
    EXPECT_DOUBLE_EQ(m.mean[0], 0);
}

}  // namespace
}  // namespace fathom
