#include <gtest/gtest.h>

#include "../image/pictures.h"
#include "fathom/error.h"
#include "fathom/render.h"
#include "made_film.h"

namespace fathom {
namespace {

Film::Sums made_sums()
{
    Film::Sums sums;
    sums.width = 6;
    sums.height = 5;
    sums.words_per_pixel = 18;
    for (int i = 0; i < 6 * 5 * 18; ++i) sums.words.push_back(std::uint32_t(i) * 2654435761u);
    sums.samples = {{0, 4}, {8, 1ull << 40}};
    sums.dropped = 3;
    sums.key = "cornell seed 0";
    return sums;
}

TEST(Sums, ComeBackFromAFileAsTheyWere)
{
    const test::TemporaryFolder folder;
    const Film::Sums sums = made_sums();
    Image image = test::made_image(6, 5);
    store_sums(sums, image);
    write_image(folder.path() / "a.exr", image, {});
    const Film::Sums read = load_sums(read_image(folder.path() / "a.exr"), "a.exr");
    EXPECT_EQ(read.width, sums.width);
    EXPECT_EQ(read.height, sums.height);
    EXPECT_EQ(read.words_per_pixel, sums.words_per_pixel);
    EXPECT_EQ(read.words, sums.words);
    EXPECT_EQ(read.samples, sums.samples);
    EXPECT_EQ(read.dropped, sums.dropped);
    EXPECT_EQ(read.key, sums.key);
}

/// Of samples that are half v and half 3 v, by turns, the variance of the mean is v^2 / (n - 1), whatever v is.
TEST(Film, VarianceIsRightForDarkAndBrightPictures)
{
    for (double v : {1e-6, 1e-5, 1e-3, 1.0, 30.0, 60.0, 1e3, 1e6, 3e7, 1e8, 1e9}) {
        RenderSettings settings;
        settings.width = settings.height = 1;
        Film film = test::made_film(settings);
        constexpr int n = 200;
        film.data().add_range({0, n});
        TileSums sums;
        sums.reset(1, other_words);
        for (int i = 0; i < n; ++i) sums.add(0, std::uint32_t(i), float(i % 2 ? 3 * v : v), float(v), 0);
        std::uint32_t* pixel = film.data().pixel(0);
        sums.add_to(0, pixel, 0, -1);
        for (const TileSums::Slow& slow : sums.slow())
            for (int c = 0; c < 3; ++c) {
                ExactSum::add_number(radiance_sum(pixel, c), slow.value[c]);
                ExactSquareSum::add_number(square_sum(pixel, c), double(slow.value[c]) * slow.value[c]);
            }
        const Image image = film.image(false, true);
        const auto& variance = image.find("variance")->pixels;
        EXPECT_NEAR(image.layers[0].pixels[0] / (2 * v), 1, 2e-5) << v;
        EXPECT_NEAR(variance[0] * (n - 1) / (v * v), 1, 1e-3) << v;
        EXPECT_LT(variance[1] * (n - 1) / (v * v), 1e-4) << v;  // no variance, but for rounding
        EXPECT_EQ(variance[2], 0) << v;
    }
}

TEST(Sums, AreCheckedWhenTheyAreRead)
{
    EXPECT_THROW(load_sums(test::made_image(6, 5), "a.exr"), Error);
    Image image = test::made_image(6, 5);
    store_sums(made_sums(), image);
    for (const char* wrong : {"4:0", "0:4,2:8", "0:4,4:8", "0-4", "x", "0:4;", "0:", "99999999999999999999:1"}) {
        Image damaged = image;
        damaged.attributes["fathom.sums.samples"] = wrong;
        EXPECT_THROW(load_sums(damaged, "a.exr"), Error) << wrong;
    }
    for (const char* wrong : {"19", "-1", "", "1x"}) {
        Image damaged = image;
        damaged.attributes["fathom.sums.words_per_pixel"] = wrong;
        EXPECT_THROW(load_sums(damaged, "a.exr"), Error) << wrong;
    }
    Image missing = image;
    missing.uint_channels[4].name = "other";
    EXPECT_THROW(load_sums(missing, "a.exr"), Error);
    Image small = test::made_image(3, 3);
    EXPECT_THROW(store_sums(made_sums(), small), Error);
}

}  // namespace
}  // namespace fathom
