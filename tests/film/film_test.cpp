// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "fathom/error.h"
#include "made_film.h"
#include "support/film_contents.h"

// Films filled with known sums.
namespace fathom {
namespace {

RenderSettings settings_with(std::vector<Aov> aovs, bool alpha)
{
    RenderSettings s;
    s.width = 2, s.height = 2;
    s.aovs = std::move(aovs);
    s.alpha = alpha;
    return s;
}

void add_radiance(Film& film, std::size_t pixel, int channel, double sum, double squares)
{
    ExactSum::add_number(radiance_sum(film.data().pixel(pixel), channel), sum);
    ExactSquareSum::add_number(square_sum(film.data().pixel(pixel), channel), squares);
}
void add_other(Film& film, std::size_t pixel, int place, double value)
{
    ExactSum::add_number(other_sum(film.data().pixel(pixel), place), value);
}

/// Every layer has sums of its own that don't overlap.
TEST(FilmLayout, HasAPlaceForEach)
{
    const FilmLayout all({Aov::position, Aov::albedo, Aov::depth, Aov::normal, Aov::instance_id, Aov::material_id},
                         true);
    struct Part {
        int first, count;
    };
    const Part parts[] = {{all.alpha, 1}, {all.albedo, 3},   {all.normal, 3},
                          {all.depth, 1}, {all.position, 3}, {all.hits, 1}};
    std::vector<int> used(std::size_t(all.sums), 0);
    for (const Part& p : parts)
        for (int i = 0; i < p.count; ++i) ++used.at(std::size_t(p.first + i));
    for (int u : used) EXPECT_EQ(u, 1);
    // Words of radiance, squares, other layers and ids don't overlap.
    const std::vector<std::uint32_t> words(std::size_t(all.words));
    const std::uint32_t* const pixel = words.data();
    EXPECT_EQ(square_sum(pixel, 0) - pixel, 3 * ExactSum::words);
    EXPECT_EQ(other_sum(pixel, 0) - square_sum(pixel, 2), ExactSquareSum::words);
    EXPECT_EQ(all.ids, other_sum(pixel, all.sums) - pixel);
    EXPECT_EQ(all.words, all.ids + 3);
    const FilmLayout none({}, false);
    EXPECT_EQ(none.words, other_words);
    EXPECT_EQ(none.ids, -1);
    EXPECT_EQ(none.alpha, -1);
    EXPECT_FALSE(none.any());
}

TEST(FilmImage, MeansOfWhatWasSummed)
{
    Film film = test::make_test_film(
        settings_with({Aov::albedo, Aov::normal, Aov::depth, Aov::position, Aov::instance_id, Aov::material_id}, true));
    Film::Data& data = film.data();
    const FilmLayout& layout = data.layout;
    data.add_range({0, 3});
    data.add_range({10, 15});
    ASSERT_EQ(film.samples_per_pixel(), 8u);
    const std::size_t p = 2;
    for (int c = 0; c < 3; ++c) {
        add_radiance(film, p, c, 8.0 * (c + 1), 8.0 * ((c + 1) * (c + 1) + 7));  // values with variance 7
        add_other(film, p, layout.albedo + c, 2 + c);
        add_other(film, p, layout.normal + c, -4 - c);
        add_other(film, p, layout.position + c, 10 + c);
    }
    add_other(film, p, layout.alpha, 2);
    add_other(film, p, layout.hits, 2);
    add_other(film, p, layout.depth, 5);
    std::uint32_t* ids = data.pixel(p) + layout.ids;
    ids[0] = 1, ids[1] = 42, ids[2] = 43;
    const Image image = film.image(true, true);
    const auto value = [&](const char* name, std::size_t stride, std::size_t c) {
        return image.find(name)->pixels[stride * p + c];
    };
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(value("", 4, c), float(c + 1));
        EXPECT_EQ(value("variance", 3, c), 1);  // variance of the mean: 7 / (8 - 1)
        EXPECT_EQ(value("albedo", 3, c), float(2 + c) / 8);
        EXPECT_EQ(value("normal", 3, c), -float(4 + c) / 8);
        EXPECT_EQ(value("position", 3, c), float(10 + c) / 2);  // mean over the samples that hit
    }
    EXPECT_EQ(value("", 4, 3), 0.25f);
    EXPECT_EQ(value("depth", 1, 0), 2.5f);
    EXPECT_EQ(value("instance", 1, 0), 42);
    EXPECT_EQ(value("material", 1, 0), 43);
    // Other pixels keep their defaults.
    EXPECT_EQ(image.layers[0].pixels[0], 0);
    EXPECT_TRUE(std::isinf(image.find("depth")->pixels[0]));
    EXPECT_EQ(film.image(false, false).layers[0].channels.size(), 3u);
    EXPECT_EQ(film.image(false, false).find("variance"), nullptr);
}

TEST(FilmRanges, JoinWhereTheyTouchAndRefuseToOverlap)
{
    Film film = test::make_test_film(settings_with({}, false));
    Film::Data& data = film.data();
    data.add_range({8, 10});
    data.add_range({0, 2});
    data.add_range({5, 5});
    EXPECT_EQ(data.samples, (std::vector<SampleRange>{{0, 2}, {8, 10}}));
    data.add_range({2, 8});
    EXPECT_EQ(data.samples, (std::vector<SampleRange>{{0, 10}}));
    for (const SampleRange& wrong : {SampleRange{9, 12}, {0, 1}, {3, 4}, {0, 20}})
        EXPECT_THROW(data.add_range(wrong), Error);
    data.add_range({10, 12});
    EXPECT_EQ(data.samples, (std::vector<SampleRange>{{0, 12}}));
}

TEST(FilmMerge, AddsSumsAndKeepsIdsOfTheFirstSample)
{
    const RenderSettings settings = settings_with({Aov::instance_id}, true);
    Film a = test::make_test_film(settings), b = test::make_test_film(settings);
    a.data().add_range({0, 2}), b.data().add_range({2, 5});
    for (Film* film : {&a, &b})
        for (std::size_t p = 0; p < 4; ++p) {
            const bool first = film == &a;
            const double value = (first ? 1 : 10) * double(p + 1);
            for (int c = 0; c < 3; ++c) add_radiance(*film, p, c, value, 2 * value);
            add_other(*film, p, film->data().layout.alpha, 3 * value);
            std::uint32_t* ids = film->data().pixel(p) + film->data().layout.ids;
            // In some pixels the other film has the lower sample index.
            ids[0] = first ? (p % 2 ? 1 : 4) : 3;
            ids[1] = ids[2] = (first ? 100 : 200) + std::uint32_t(p);
        }
    a.data().dropped = 2, b.data().dropped = 3;
    a.merge(b);
    for (std::size_t p = 0; p < 4; ++p) {
        const std::uint32_t* words = a.data().pixel(p);
        const double value = 11 * double(p + 1);
        for (int c = 0; c < 3; ++c) {
            EXPECT_EQ(ExactSum::value(radiance_sum(words, c)), value);
            EXPECT_EQ(ExactSquareSum::value(square_sum(words, c)), 2 * value);
        }
        EXPECT_EQ(ExactSum::value(other_sum(words, a.data().layout.alpha)), 3 * value);
        const int ids = a.data().layout.ids;
        EXPECT_EQ(words[ids], p % 2 ? 1u : 3u);
        EXPECT_EQ(words[ids + 1], (p % 2 ? 100u : 200u) + p);
    }
    EXPECT_EQ(a.invalid_samples(), 5u);
    EXPECT_EQ(a.samples(), (std::vector<SampleRange>{{0, 5}}));
}

TEST(FilmMerge, InPiecesIsTheSame)
{
    const RenderSettings settings = settings_with({Aov::instance_id, Aov::depth}, true);
    Film own = test::make_test_film(settings), whole = test::make_test_film(settings),
         pieces = test::make_test_film(settings);
    const auto pixels = std::size_t(own.width()) * std::size_t(own.height());
    for (Film* film : {&own, &whole, &pieces}) {
        film->data().add_range(film == &own ? SampleRange{2, 5} : SampleRange{0, 2});
        for (std::size_t p = 0; p < pixels; ++p) {
            const double value = (film == &own ? -0.25 : 7) * double(p + 1);
            for (int c = 0; c < 3; ++c) add_radiance(*film, p, c, value, value * value);
            add_other(*film, p, film->data().layout.depth, 2 * value);
            std::uint32_t* ids = film->data().pixel(p) + film->data().layout.ids;
            ids[0] = film == &own ? std::uint32_t(2 + p % 2) : 3;
            ids[1] = ids[2] = film == &own ? 100 : 200;
        }
    }
    own.data().dropped = 2;
    own.data().invalid_sample = Film::SampleLocation{1, 1, 4};
    whole.merge(own);

    begin_merge(pieces, own.key(), own.samples(), own.invalid_samples(), own.invalid_sample());
    const auto words = std::size_t(words_per_pixel(own));
    for (std::size_t p = pixels; p-- > 0;) merge_words(pieces, p, film_words(own) + p * words, 1);
    EXPECT_EQ(test::words_of(pieces), test::words_of(whole));
    EXPECT_EQ(pieces.samples(), (std::vector<SampleRange>{{0, 5}}));
    EXPECT_EQ(pieces.invalid_samples(), 2u);
    ASSERT_TRUE(pieces.invalid_sample());
    EXPECT_EQ(pieces.invalid_sample()->sample, 4u);

    // Merging partial sums of two films equals merging both films.
    std::vector<std::uint32_t> passing = test::words_of(own);
    Film start = test::make_test_film(settings), twice = test::make_test_film(settings);
    add_words(own, film_words(own), passing.data(), pixels);
    merge_words(twice, 0, passing.data(), pixels);
    for (int i = 0; i < 2; ++i) merge_words(start, 0, film_words(own), pixels);
    EXPECT_EQ(test::words_of(twice), test::words_of(start));

    EXPECT_THROW(begin_merge(pieces, own.key(), own.samples(), 0, {}), Error) << "these samples are already merged";
    EXPECT_THROW(begin_merge(pieces, test::make_test_film(settings_with({}, true)).key(), {{8, 9}}, 0, {}), Error);
}

/// Settings that change the bits of an image prevent merging.
TEST(FilmMerge, RefusesOtherSettings)
{
    const RenderSettings settings = settings_with({Aov::depth}, true);
    std::vector<RenderSettings> others(13, settings);
    others[0].seed = 1;
    others[1].max_depth = 3;
    others[2].roulette_depth = 6;
    others[3].light_sampling = false;
    others[4].filter = Filter::gaussian;
    others[5].crop = Crop{0, 0, 1, 1};
    others[6].background = Color{0, 0, 1};
    others[7].alpha = false;
    others[8].aovs = {Aov::normal};
    others[9].light_selection = LightSelection::uniform;
    others[10].light_selection = LightSelection::power;
    others[11].guiding = true;
    others[12].filter_radius = 3;
    for (const RenderSettings& other : others)
        EXPECT_THROW(test::make_test_film(settings).merge(test::make_test_film(other)), Error)
            << &other - others.data();
    RenderSettings same = settings;
    same.threads = 7;
    EXPECT_NO_THROW(test::make_test_film(settings).merge(test::make_test_film(same)));
}

TEST(FilmKey, ComesBackFromItsText)
{
    RenderSettings settings = settings_with({Aov::material_id, Aov::normal}, true);
    settings.filter = Filter::tent;
    settings.filter_radius = 1.3;
    const FilmKey key = test::make_test_film(settings).key();
    const FilmKey again = FilmKey::parse(key.text());
    EXPECT_EQ(again.text(), key.text());
    EXPECT_EQ(again.settings.aovs, settings.aovs);
    EXPECT_EQ(again.settings.filter, Filter::tent);
    EXPECT_EQ(again.settings.filter_radius, 1.3);
    EXPECT_TRUE(again.settings.alpha);
}

}  // namespace
}  // namespace fathom
