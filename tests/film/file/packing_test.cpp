// SPDX-License-Identifier: Apache-2.0
#include "film/file/packing.h"

#include <gtest/gtest.h>

#include "fathom/error.h"
#include "film/made_film.h"

namespace fathom {
namespace {

RenderSettings settings_of(int width, int height)
{
    RenderSettings settings;
    settings.width = width, settings.height = height;
    settings.aovs = {Aov::albedo, Aov::normal, Aov::depth, Aov::position, Aov::instance_id, Aov::material_id};
    settings.alpha = true;
    return settings;
}

std::vector<std::uint32_t> words_of(const Film& film, std::size_t pixel)
{
    const std::uint32_t* const first = film.data().pixel(pixel);
    return {first, first + film.data().layout.words};
}

std::vector<std::uint32_t> through(const Packing& packing, const Film& film, std::size_t pixel)
{
    std::vector<unsigned char> packed(packing.stride(), 0xdd);
    std::vector<std::uint32_t> with_slack = words_of(film, pixel);
    with_slack.resize(with_slack.size() + Packing::slack / 4, 0xccccccccu);
    packing.pack(with_slack.data(), 1, packed.data());
    // Bytes after the packed pixel must not be read.
    std::fill(packed.begin() + packing.words() * 4, packed.end(), 0xee);
    std::vector<std::uint32_t> words(std::size_t(film.data().layout.words), 0x12345678u);
    packing.unpack(packed.data(), 1, words.data());
    return words;
}

TEST(Packing, RoundTripsAnyData)
{
    Film film = test::make_test_film(settings_of(8, 4));
    std::uint32_t state = 1;
    const auto random = [&] { return state = state * 1664525u + 1013904223u; };
    // Random masks give numbers of all lengths, both signs and trailing zeros.
    for (std::size_t i = 0; i < 32; ++i)
        for (int w = 0; w < film.data().layout.words; ++w) {
            const std::uint32_t kind = random() >> 30;
            film.data().pixel(i)[w] = kind == 0 ? 0 : kind == 1 ? 0xffffffffu : random();
        }
    const Packing packing(film.data());
    for (std::size_t i = 0; i < 32; ++i) EXPECT_EQ(through(packing, film, i), words_of(film, i)) << i;
}

TEST(Packing, TakesNoMoreBytesThanTheLargestNeeds)
{
    Film film = test::make_test_film(settings_of(4, 1));
    EXPECT_EQ(Packing(film.data()).words(), 1);  // the three ids of a pixel without a hit need 32 bits
    for (std::size_t i = 0; i < 4; ++i) film.data().pixel(i)[film.data().layout.ids] = 0;
    EXPECT_EQ(Packing(film.data()).words(), 0);
    const auto bytes_for = [&](std::initializer_list<double> values) {
        const std::vector<double> v(values);
        for (std::size_t i = 0; i < 4; ++i) {
            std::uint32_t* const sum = other_sum(film.data().pixel(i), film.data().layout.normal);
            sum[0] = sum[1] = sum[2] = 0;
            ExactSum::add_number(sum, v[i]);
        }
        const Packing packing(film.data());
        for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(through(packing, film, i), words_of(film, i)) << i;
        const std::string text = packing.text();
        return text;
    };
    // The first sums are three of radiance, three of squares, alpha and albedo.
    const std::string none = "0+0,0+0,0+0,0+0,0+0,0+0,0+0,0+0,0+0,0+0,",
                      rest = ",0+0,0+0,0+0,0+0,0+0,0+0,0+0,0+0,0+0,0+0";
    // The unit bit is bit 36, in the fifth byte: with the sign, integers of 12 bits fit into two bytes.
    EXPECT_EQ(bytes_for({0, 1, 127, -128}), none + "4+2" + rest);
    EXPECT_EQ(bytes_for({0, 1, 2047, -2048}), none + "4+2" + rest);
    EXPECT_EQ(bytes_for({0, 1, 2048, -2048}), none + "4+3" + rest);
    EXPECT_EQ(bytes_for({0, 1, 2047, -2049}), none + "4+3" + rest);
    EXPECT_EQ(bytes_for({0, 0x1p-36, 0, 0}), none + "0+1" + rest);
    EXPECT_EQ(bytes_for({0, -0x1p-36, 0, 0}), none + "0+1" + rest);
    EXPECT_EQ(bytes_for({-0x1p49, 0x1p49, 0, 0}), none + "10+1" + rest);
}

TEST(Packing, NumbersWithoutSignFillTheirBytes)
{
    Film film = test::make_test_film(settings_of(1, 1));
    for (int w = 0; w < film.data().layout.words; ++w) film.data().pixel(0)[w] = 0;
    square_sum(film.data().pixel(0), 0)[0] = 0xff;
    square_sum(film.data().pixel(0), 1)[0] = 0x1ff;
    radiance_sum(film.data().pixel(0), 0)[0] = 0xff;
    const Packing packing(film.data());
    EXPECT_EQ(packing.text().substr(0, 24), "0+2,0+0,0+0,0+1,0+2,0+0,");
    EXPECT_EQ(through(packing, film, 0), words_of(film, 0));
}

TEST(Packing, RoundTripsAsText)
{
    Film film = test::make_test_film(settings_of(1, 1));
    for (int w = 0; w < film.data().layout.words; ++w) film.data().words[std::size_t(w)] = std::uint32_t(w) * 77777777u;
    const Packing packing(film.data()), read(film.data().layout, packing.text());
    EXPECT_EQ(read.text(), packing.text());
    EXPECT_EQ(read.words(), packing.words());
    EXPECT_EQ(through(read, film, 0), words_of(film, 0));
}

TEST(Packing, RefusesTextsThatAreNone)
{
    const FilmLayout layout({}, false);
    EXPECT_EQ(Packing(layout, "4+3,0+12,0+1,0+16,15+1,0+0").words(), 9);
    for (const char* wrong :
         {"", "4+3,0+12,0+1,0+16,15+1", "4+3,0+13,0+1,0+16,15+1,0+0", "4+3,0+12,0+1,0+17,15+1,0+0",
          "4+3,0+12,0+1,1+16,15+1,0+0", "13+0,0+12,0+1,0+16,15+1,0+0", "4+3,0+12,0+1,0+16,15+1,0+0,",
          "4+3,0+12,0+1,0+16,15+1,0+0,1+1", "-1+3,0+12,0+1,0+16,15+1,0+0", "4+3;0+12,0+1,0+16,15+1,0+0",
          "4-3,0+12,0+1,0+16,15+1,0+0", "4+99999999999,0+12,0+1,0+16,15+1,0+0"})
        EXPECT_THROW(Packing(layout, wrong), Error) << wrong;
}

}  // namespace
}  // namespace fathom
