#include <gtest/gtest.h>

#include <random>

#include "made_film.h"

// Pictures of samples put in by hand: what share of noise and samples is told.
namespace fathom {
namespace {

constexpr int side = 64, samples = 64;

struct Picture {
    Film film = [] {
        RenderSettings s;
        s.width = side, s.height = side;
        return test::made_film(s);
    }();
    std::vector<double> values = std::vector<double>(std::size_t(side * side * samples));

    double& sample(int x, int y, int k) { return values[std::size_t((y * side + x) * samples + k)]; }
    /// The squared error of a pixel, times samples.
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

/// Noise that is brighter, and noisier, in the right half.
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
    // A pixel's other samples are not quite the usual ones.
    EXPECT_NEAR(found.samples * side * side * samples, count, 0.02 * count);
}

TEST(Fireflies, AreNotInPlainNoise)
{
    EXPECT_EQ(noisy().found().samples, 0);
}

/// The edge of something bright on black: some of its pixels have few bright samples, all others none.
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

TEST(Fireflies, NeedSamplesToBeTold)
{
    Picture p = noisy();
    p.sample(9, 9, 9) = 500;
    EXPECT_GT(p.found().noise, 0);
    RenderSettings s;
    s.width = side, s.height = side;
    EXPECT_EQ(test::made_film(s).fireflies().noise, 0);
}

}  // namespace
}  // namespace fathom
