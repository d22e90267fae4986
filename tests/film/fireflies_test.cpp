// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "made_film.h"

// Tests of the reported shares of noise and samples, for images with known fireflies.
namespace fathom {
namespace {

constexpr int side = 64, samples = 64;

struct Picture {
    Film film = [] {
        RenderSettings s;
        s.width = side, s.height = side;
        return test::make_test_film(s);
    }();
    std::vector<double> values = std::vector<double>(std::size_t(side * side * samples));

    double& sample(int x, int y, int k) { return values[std::size_t((y * side + x) * samples + k)]; }
    /// Variance of a pixel's mean times the number of samples.
    double variance(int x, int y)
    {
        double sum = 0, squares = 0;
        for (int k = 0; k < samples; ++k) sum += sample(x, y, k), squares += sample(x, y, k) * sample(x, y, k);
        return squares / samples - sum * sum / (samples * samples);
    }
    Film::Fireflies found()
    {
        film.data().add_range({0, samples});
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
                for (int c = 0; c < 3; ++c)
                    for (int k = 0; k < samples; ++k) {
                        std::uint32_t* pixel = film.data().pixel(std::size_t(y * side + x));
                        ExactSum::add_number(radiance_sum(pixel, c), sample(x, y, k));
                        ExactSquareSum::add_number(square_sum(pixel, c), sample(x, y, k) * sample(x, y, k));
                    }
        return film.fireflies();
    }
};

/// An image that is brighter and noisier in the right half.
Picture noisy()
{
    Picture p;
    std::mt19937 engine(7);
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            for (int k = 0; k < samples; ++k)
                p.sample(x, y, k) = (x < side / 2 ? 0.1 : 4) * double(engine() >> 8) / 16777216.0;
    return p;
}

TEST(Fireflies, AreTheSamplesThatWerePutIn)
{
    Picture p = noisy();
    double theirs = 0, all = 0;
    const int places[][3] = {{5, 5, 1}, {20, 40, 2}, {50, 10, 1}, {63, 63, 3}, {31, 0, 1}};
    int count = 0;
    for (const auto& [x, y, times] : places) {
        theirs -= p.variance(x, y);
        for (int k = 0; k < times; ++k) p.sample(x, y, 7 * k) = 500;
        theirs += p.variance(x, y);
        count += times;
    }
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) all += p.variance(x, y);
    const Film::Fireflies found = p.found();
    EXPECT_NEAR(found.noise, theirs / all, 0.001);
    EXPECT_GT(found.noise, 0.5);
    // The other samples of a pixel differ slightly from the typical value.
    EXPECT_NEAR(found.samples * side * side * samples, count, 0.02 * count);
}

TEST(Fireflies, AreNotInPlainNoise)
{
    EXPECT_EQ(noisy().found().samples, 0);
}

/// Edge of a bright object on black: few samples of an edge pixel are bright, none of its neighbors.
TEST(Fireflies, AreNotAtEdges)
{
    Picture p;
    std::mt19937 engine(3);
    for (int y = 0; y < side; ++y) {
        const double edge = 20 + 0.3 * y;
        for (int x = 0; x < side; ++x)
            for (int k = 0; k < samples; ++k)
                p.sample(x, y, k) = x + double(engine() >> 8) / 16777216.0 > edge ? 100 : 0;
    }
    EXPECT_LT(p.found().noise, 0.001);
}

/// In a crop, only visible pixels count: shares are those of a film of the crop's size.
TEST(Fireflies, OfACropAreThoseOfItsPixels)
{
    constexpr Crop inside{8, 24, 40, 48};
    const auto fireflies_of = [&](RenderSettings settings, int left, int top) {
        Film film = test::make_test_film(settings);
        film.data().add_range({0, samples});
        Picture p = noisy();
        for (int k = 0; k < 3; ++k) p.sample(20, 30, 9 * k) = 500;
        for (int y = inside.y0; y < inside.y1; ++y)
            for (int x = inside.x0; x < inside.x1; ++x)
                for (int k = 0; k < samples; ++k) {
                    const auto at = std::size_t(y - top) * std::size_t(settings.width) + std::size_t(x - left);
                    std::uint32_t* const pixel = film.data().pixel(at);
                    for (int c = 0; c < 3; ++c) {
                        ExactSum::add_number(radiance_sum(pixel, c), p.sample(x, y, k));
                        ExactSquareSum::add_number(square_sum(pixel, c), p.sample(x, y, k) * p.sample(x, y, k));
                    }
                }
        return film.fireflies();
    };
    RenderSettings whole, alone;
    whole.width = whole.height = side, whole.crop = inside;
    alone.width = inside.x1 - inside.x0, alone.height = inside.y1 - inside.y0;
    const Film::Fireflies cropped = fireflies_of(whole, 0, 0), expected = fireflies_of(alone, inside.x0, inside.y0);
    EXPECT_NEAR(cropped.samples, 3.0 / (samples * alone.width * alone.height), 0.1 * cropped.samples);
    EXPECT_EQ(cropped.samples, expected.samples);
    EXPECT_EQ(cropped.noise, expected.noise);
}

TEST(Fireflies, NeedSamplesToBeDetected)
{
    Picture p = noisy();
    p.sample(9, 9, 9) = 500;
    EXPECT_GT(p.found().noise, 0);
    RenderSettings s;
    s.width = side, s.height = side;
    EXPECT_EQ(test::make_test_film(s).fireflies().noise, 0);
}

}  // namespace
}  // namespace fathom
