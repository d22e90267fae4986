// SPDX-License-Identifier: Apache-2.0
#include "fathom/image_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "film/probes.h"
#include "made_film.h"

namespace fathom {
namespace {

/// A film that was filled without rendering: pixels are r plus independent normal noise.
struct Synthetic {
    int width = 160, height = 120, samples = 64;
    double noise = 0.05;         ///< standard deviation of a pixel's mean
    double overstated = 4;       ///< the variance of its samples suggests this multiple of noise^2
    double less_right = 1;       ///< the noise of the right half, though not that of its samples, is divided by this
    double left = 1, right = 1;  ///< r in both halves of the image
    std::uint32_t seed = 1;
    bool light_tracing = false;
    double splat_noise = 0;

    RenderSettings settings() const
    {
        RenderSettings s;
        s.width = width, s.height = height;
        s.error_probes = true;
        s.light_paths = light_tracing ? 1 : 0;
        return s;
    }
    double noise_at(int x) const { return x < width / 2 ? noise : noise / less_right; }
    double radiance(int x) const { return x < width / 2 ? left : right; }

    /// The film; `squares` receives the squared errors of its channels, weighted for the relative error.
    Film film(double* squares = nullptr) const
    {
        Film film = test::make_test_film(settings());
        Film::Data& data = film.data();
        data.add_range({0, std::uint64_t(samples)});
        std::mt19937 random(seed);
        std::normal_distribution<double> normal;
        const double n = samples;
        double sum = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (int c = 0; c < 3; ++c) {
                    std::uint32_t* const pixel = data.pixel(std::size_t(y) * std::size_t(width) + std::size_t(x));
                    const double r = radiance(x), error = noise_at(x) * normal(random), mean = r + error;
                    ExactSum::add_number(radiance_sum(pixel, c), n * mean);
                    const double variance = overstated * noise * noise;
                    ExactSquareSum::add_number(square_sum(pixel, c), n * (mean * mean + variance * (n - 1)));
                    double splats = 0;
                    if (light_tracing) {
                        splats = splat_noise * normal(random);
                        ExactSum::add_number(other_sum(pixel, data.layout.splats + c), n * splats);
                        ExactSquareSum::add_number(data.layout.splat_square(pixel, c),
                                                   n * n * splat_noise * splat_noise);
                    }
                    sum += (error + splats) * (error + splats) / (r * r + 0.01);
                }
        for (const Probe& p : probes_of(width, settings().rendered_pixels()))
            for (std::size_t c = 0; c < 3; ++c)
                ExactSum::add_number(other_sum(data.pixel(p.sums + c), data.layout.probe),
                                     n * (radiance(p.x) + noise_at(p.x) * normal(random)));
        if (squares) *squares = sum / (3.0 * width * height);
        return film;
    }
};

/// The probes correct what the variance of samples overstates, and the interval contains the true error as often as it
/// should.
TEST(ImageError, IntervalContainsTheErrorOfTheImage)
{
    for (const double overstated : {0.5, 4.0}) {
        Synthetic s;
        s.overstated = overstated;
        int inside = 0;
        double ratio = 0;
        constexpr int images = 60;
        for (int i = 0; i < images; ++i) {
            s.seed = std::uint32_t(i) * 2654435761u;
            double squares = 0;
            const ImageError error = estimate_error(s.film(&squares)).value();
            const double true_error = std::sqrt(squares);
            inside += error.low <= true_error && true_error <= error.high;
            ratio += error.error / true_error / images;
            EXPECT_TRUE(error.is_reliable());
        }
        // Correction begins as if three probes had shown a factor of 1, which is 0.7 % here.
        EXPECT_NEAR(ratio, 1, 0.015) << overstated;
        // 95 % up to 2.5 standard deviations.
        EXPECT_GE(inside, 53) << overstated;
    }
}

/// The interval is as wide as 600 probes of three channels make it: the squared error has a relative standard deviation
/// of (2 / 1800)^(1/2), so the error is known to 1.96 times 1.7 % to either side.
TEST(ImageError, IntervalIsNoWiderThanProbesMakeIt)
{
    const ImageError error = estimate_error(Synthetic().film()).value();
    EXPECT_GT((error.high - error.low) / error.error, 0.06);
    EXPECT_LT((error.high - error.low) / error.error, 0.085);
}

/// Few pixels whose light comes by chance make most of the error, and no probe meets them. The variance of the others,
/// which the probes show, overstates four times, but says nothing about these.
TEST(ImageError, CorrectsPixelsOfFewSamplesByThemselves)
{
    double ratio = 0;
    constexpr int images = 20;
    for (int i = 0; i < images; ++i) {
        Synthetic s;
        s.seed = std::uint32_t(i) * 2654435761u;
        double squares = 0;
        Film film = s.film(&squares);
        Film::Data& data = film.data();
        std::vector<bool> is_probe(std::size_t(s.width * s.height));
        for (const Probe& p : probes_of(s.width, s.settings().rendered_pixels()))
            is_probe[std::size_t(p.y * s.width + p.x)] = true;
        std::mt19937 random(s.seed + 1);
        std::normal_distribution<double> normal;
        constexpr double noise = 3;
        const double n = s.samples;
        for (std::size_t p = 0; p < is_probe.size(); p += 479)
            for (int c = 0; c < 3 && !is_probe[p]; ++c) {
                const double error = noise * normal(random);
                ExactSum::add_number(radiance_sum(data.pixel(p), c), n * error);
                ExactSquareSum::add_number(square_sum(data.pixel(p), c), n * n * noise * noise);
                squares += error * error / 1.01 / (3.0 * s.width * s.height);
            }
        ratio += estimate_error(film)->error / std::sqrt(squares) / images;
    }
    EXPECT_NEAR(ratio, 1, 0.1);
}

/// Errors are relative to the image, and near black to 0.1.
TEST(ImageError, IsRelativeToTheImage)
{
    for (const double r : {0.0, 0.1, 1.0, 20.0}) {
        Synthetic s;
        s.left = s.right = r;
        s.noise = 0.02;
        EXPECT_NEAR(estimate_error(s.film())->error, 0.02 / std::sqrt(r * r + 0.01),
                    0.1 * 0.02 / std::sqrt(r * r + 0.01));
        EXPECT_NEAR(estimate_error(s.film(), ErrorMetric::absolute)->error, 0.02, 0.002);
    }
}

/// The block with the largest error is the dark one, since errors are relative.
TEST(ImageError, FindsTheWorstBlock)
{
    Synthetic s;
    s.left = 0.2, s.right = 2;
    s.width = 256;
    const double worst = 0.05 / std::sqrt(0.04 + 0.01);
    const ImageError block = estimate_error(s.film(), ErrorMetric::worst_block).value();
    EXPECT_NEAR(block.error, worst, 0.15 * worst);
    EXPECT_LT(block.low, worst);
    EXPECT_GT(block.high, worst);
    EXPECT_NEAR(estimate_error(s.film())->error, worst / std::sqrt(2), 0.1 * worst);
}

/// The set that decides and the one that reports do not share a probe.
TEST(ImageError, SetsOfProbesAreIndependent)
{
    const Synthetic s;
    Film film = s.film();
    const double all = estimate_error(film)->error,
                 reporting = estimate_error(film, ErrorMetric::relative, ErrorProbes::reporting)->error;
    for (const Probe& p : probes_of(s.width, s.settings().rendered_pixels()))
        for (std::size_t c = 0; p.decides && c < 3; ++c)
            ExactSum::add_number(other_sum(film.data().pixel(p.sums + c), film.data().layout.probe), 1000);
    EXPECT_EQ(estimate_error(film, ErrorMetric::relative, ErrorProbes::reporting)->error, reporting);
    EXPECT_GT(estimate_error(film)->error, 2 * all);
    EXPECT_GT(estimate_error(film, ErrorMetric::relative, ErrorProbes::deciding)->error, 2 * all);
}

/// Splats have a variance of their own, which probes don't correct.
TEST(ImageError, IncludesLightPaths)
{
    Synthetic s;
    s.light_tracing = true;
    s.splat_noise = 0.1;
    double squares = 0;
    const Film film = s.film(&squares);
    EXPECT_NEAR(estimate_error(film)->error, std::sqrt(squares), 0.04 * std::sqrt(squares));
}

/// The layer is the standard error of each pixel.
TEST(ImageError, LayerIsTheStandardError)
{
    const Synthetic s;
    const Image::Layer layer = standard_error(s.film());
    EXPECT_EQ(layer.name, "error");
    double squares = 0;
    for (const float error : layer.pixels) {
        EXPECT_NEAR(error, s.noise, 0.4 * s.noise);
        squares += double(error) * double(error);
    }
    EXPECT_NEAR(std::sqrt(squares / double(layer.pixels.size())), s.noise, 0.05 * s.noise);
}

/// Where the variance of samples overstates more than elsewhere, though the samples look alike, the probes nearby
/// correct the layer.
TEST(ImageError, LayerIsCorrectedByPlace)
{
    Synthetic s;
    s.width = 512, s.height = 256;
    s.less_right = 2;
    const Image::Layer layer = standard_error(s.film());
    double left = 0, right = 0;
    for (int y = 0; y < s.height; ++y)
        for (int x = 0; x < s.width; ++x) {
            const double error = double(layer.pixels[3 * (std::size_t(y) * std::size_t(s.width) + std::size_t(x))]);
            (x < s.width / 2 ? left : right) += error * error / (s.width * s.height / 2.0);
        }
    // With one factor for the whole image both would be 0.625 times the squared noise of the left half.
    const double square = s.noise * s.noise;
    EXPECT_NEAR(left, square, 0.15 * square);
    EXPECT_NEAR(right, square / 4, 0.15 * square);
}

/// A few samples that are far brighter than all others, of all sizes, make an error that can't be trusted.
TEST(ImageError, HeavyTailsAreNotTrusted)
{
    const Synthetic s;
    Film film = s.film();
    EXPECT_TRUE(estimate_error(film)->is_reliable());
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(1e-6, 1);
    for (int i = 0; i < 600; ++i) {
        const double height = 20 / uniform(random);
        std::uint32_t* const pixel = film.data().pixel(random() % std::size_t(s.width * s.height));
        for (int c = 0; c < 3; ++c) {
            ExactSum::add_number(radiance_sum(pixel, c), height);
            ExactSquareSum::add_number(square_sum(pixel, c), height * height);
        }
    }
    const ImageError error = estimate_error(film).value();
    EXPECT_FALSE(error.is_reliable());
    EXPECT_GT(error.tail_shape, 0.7);
    EXPECT_GT(error.few_share, 0.9);
    EXPECT_GT(error.top_share, 0.3);
    EXPECT_LT(error.rest, error.error);
}

TEST(ImageError, IsUnknownWithoutProbesOrSamples)
{
    Synthetic s;
    s.samples = 1;
    EXPECT_FALSE(estimate_error(s.film()));
    s.samples = 64;
    s.width = s.height = 12;
    EXPECT_FALSE(estimate_error(s.film()));
    RenderSettings settings;
    settings.width = settings.height = 64;
    Film film = test::make_test_film(settings);
    film.data().add_range({0, 4});
    EXPECT_FALSE(estimate_error(film));
}

/// An image without noise has no error.
TEST(ImageError, IsZeroWithoutNoise)
{
    Synthetic s;
    s.noise = 0;
    const ImageError error = estimate_error(s.film()).value();
    EXPECT_NEAR(error.error, 0, 1e-6);
    EXPECT_LE(error.low, error.error);
    EXPECT_GE(error.high, error.error);
    EXPECT_TRUE(error.is_reliable());
}

}  // namespace
}  // namespace fathom
