#include <gtest/gtest.h>

#include "../image/pictures.h"
#include "fathom/error.h"
#include "fathom/render.h"

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
