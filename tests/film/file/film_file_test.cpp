// SPDX-License-Identifier: Apache-2.0
#include "fathom/film_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <functional>

#include "fathom/error.h"
#include "film/made_film.h"
#include "image/pictures.h"
#include "support/error_message.h"
#include "support/file_size_limit.h"
#include "support/film_contents.h"

namespace fathom {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::error_text;
using test::TemporaryFolder;

constexpr int width = 7, height = 5;

/// Film with different sums in every pixel for the samples first to last - 1.
Film some_film(std::uint64_t first, std::uint64_t last, std::vector<Aov> aovs = {}, bool alpha = false)
{
    RenderSettings settings;
    settings.width = width, settings.height = height, settings.aovs = std::move(aovs), settings.alpha = alpha;
    Film film = test::make_test_film(settings);
    film.data().add_range({first, last});
    film.data().dropped = first;
    std::uint32_t state = std::uint32_t(first) + 9;
    for (std::size_t i = 0; i < std::size_t(width * height); ++i) {
        const auto random = [&] { return float((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-20f; };
        std::uint32_t* const pixel = film.data().pixel(i);
        for (int c = 0; c < 3; ++c) {
            const double value = random();
            ExactSum::add_number(radiance_sum(pixel, c), value);
            ExactSquareSum::add_number(square_sum(pixel, c), value * value);
        }
        for (int s = 0; s < film.data().layout.sums; ++s) ExactSum::add_number(other_sum(pixel, s), random() - 3);
        if (const int ids = film.data().layout.ids; ids >= 0) pixel[ids] = std::uint32_t(i), pixel[ids + 2] = 7;
    }
    return film;
}

void write(const fs::path& file, const Film& film)
{
    write_film(file, film, film.image(true, true), {});
}

void expect_same(const Film& a, const Film& b)
{
    EXPECT_EQ(test::words_of(a), test::words_of(b));
    EXPECT_EQ(a.samples(), b.samples());
    EXPECT_EQ(a.invalid_samples(), b.invalid_samples());
    EXPECT_EQ(a.key().text(), b.key().text());
}

void overwrite(const fs::path& file, const std::vector<char>& bytes)
{
    std::ofstream(file, std::ios::binary | std::ios::trunc).write(bytes.data(), std::streamsize(bytes.size()));
}

TEST(FilmFile, RoundTrips)
{
    const TemporaryFolder folder;
    const std::vector<Aov> all = {Aov::albedo,   Aov::normal,      Aov::depth,
                                  Aov::position, Aov::instance_id, Aov::material_id};
    for (const auto& aovs : {std::vector<Aov>{}, all})
        for (const bool alpha : {false, true}) {
            const Film film = some_film(4, 9, aovs, alpha);
            write(folder.path() / "a.exr", film);
            const FilmFile file(folder.path() / "a.exr");
            EXPECT_EQ(file.samples(), film.samples());
            EXPECT_EQ(file.invalid_samples(), 4u);
            EXPECT_EQ(file.key().difference(film.key()), "");
            EXPECT_EQ(file.size_bytes(), fs::file_size(folder.path() / "a.exr"));
            expect_same(file.read(), film);
        }
}

TEST(FilmFile, IsAReadableExrImage)
{
    const TemporaryFolder folder;
    const Film film = some_film(0, 3, {Aov::normal}, true);
    Image image = film.image(true, true);
    image.attributes = {{"fathom.scene", "a.json"}, {"an attribute whose name has more than 31 letters", "x"}};
    WriteOptions half;
    half.exr_half = true;
    for (const WriteOptions& options : {WriteOptions{}, half}) {
        write_film(folder.path() / "a.exr", film, image, options);
        const Image read = read_image(folder.path() / "a.exr");
        ASSERT_EQ(read.layers.size(), 3u);
        for (const Image::Layer& layer : image.layers) {
            const Image::Layer* const there = read.find(layer.name);
            ASSERT_TRUE(there) << layer.name;
            EXPECT_EQ(there->channels, layer.channels);
            for (std::size_t i = 0; i < layer.pixels.size(); ++i)
                EXPECT_NEAR(there->pixels[i], layer.pixels[i], options.exr_half ? 0.01f : 0.0f) << layer.name;
        }
        EXPECT_EQ(read.attributes.at("fathom.scene"), "a.json");
        EXPECT_EQ(read.attributes.at("an attribute whose name has more than 31 letters"), "x");
        const FilmFile file(folder.path() / "a.exr");
        EXPECT_EQ(file.attributes(), image.attributes);
        const std::vector<std::string> channels = {"A",        "B",        "G",          "R",          "normal.X",
                                                   "normal.Y", "normal.Z", "variance.B", "variance.G", "variance.R"};
        EXPECT_EQ(file.channels(), channels);
        expect_same(file.read(), film);
    }
}

TEST(FilmFile, PartsAddUp)
{
    const TemporaryFolder folder;
    Film whole = some_film(0, 3, {Aov::depth, Aov::instance_id});
    const Film second = some_film(8, 9, {Aov::depth, Aov::instance_id});
    write(folder.path() / "a.exr", whole);
    write(folder.path() / "b.exr", second);
    whole.merge(second);
    for (const auto& [first, then] : {std::pair("a.exr", "b.exr"), std::pair("b.exr", "a.exr")}) {
        Film film = FilmFile(folder.path() / first).read();
        FilmFile(folder.path() / then).add_to(film);
        expect_same(film, whole);
    }
}

/// Film files are closed after reading, also invalid ones: merging thousands of files must not run out of descriptors.
TEST(FilmFile, LeavesNoFileOpen)
{
    const auto open_files = [] {
        return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator());
    };
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.exr", other = folder.path() / "b.exr", none = folder.path() / "c.exr";
    write(file, some_film(0, 3));
    write(other, some_film(3, 4));
    write_image(none, test::make_test_image(4, 4), {});
    const auto before = open_files();
    for (int i = 0; i < 3; ++i) {
        Film film = FilmFile(file).read();
        FilmFile(other).add_to(film);
        EXPECT_THROW(FilmFile(other).add_to(film), Error);
        EXPECT_THROW(FilmFile f(none), Error);
        EXPECT_THROW(FilmFile f(folder.path()), Error);
        write(folder.path() / "merged.exr", film);
        read_image(none);
    }
    EXPECT_EQ(open_files(), before);
}

TEST(FilmFile, RejectsAFilmOfAnotherScene)
{
    const TemporaryFolder folder;
    write(folder.path() / "a.exr", some_film(0, 3));
    const FilmFile file(folder.path() / "a.exr");
    Film overlapping = some_film(2, 4), other = some_film(5, 6, {Aov::depth});
    for (Film* film : {&overlapping, &other}) {
        const Film before = test::copy_of(*film);
        const std::string message = error_text([&] { file.add_to(*film); });
        EXPECT_NE(message.find("a.exr: "), std::string::npos) << message;
        EXPECT_NE(message.find(film == &other ? "aovs is , not 2" : "overlap"), std::string::npos) << message;
        expect_same(*film, before);
    }
}

/// A flipped bit is detected anywhere: in headers, table, images and sums.
TEST(FilmFile, DetectsAnyDamage)
{
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.exr";
    write(file, some_film(4, 9, {Aov::normal}));
    const std::vector<char> good = bytes_of(file);
    EXPECT_NO_THROW(FilmFile(file).read());
    std::fstream in_place(file, std::ios::in | std::ios::out | std::ios::binary);
    const auto put = [&](std::size_t at, char byte) {
        in_place.seekp(std::streamoff(at)).put(byte).flush();
        ASSERT_TRUE(in_place);
    };
    for (std::size_t at = 0; at < good.size(); ++at) {
        put(at, char(good[at] ^ (1 << at % 8)));
        const std::string message = error_text([&] { FilmFile(file).read(); });
        EXPECT_NE(message.find("a.exr"), std::string::npos) << at << " " << message;
        EXPECT_EQ(message.find('\n'), std::string::npos);
        put(at, good[at]);
    }
    EXPECT_NO_THROW(FilmFile(file).read());
    for (std::size_t size = good.size(); size-- > 0;) {
        fs::resize_file(file, size);
        EXPECT_THROW(FilmFile(file).read(), Error) << size;
    }
}

TEST(FilmFile, TellsWhatIsNone)
{
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.exr";
    EXPECT_NE(error_text([&] { FilmFile f(file); }).find("No such file"), std::string::npos);
    EXPECT_NE(error_text([&] { FilmFile f(folder.path()); }).find("this is not a file"), std::string::npos);
    ASSERT_EQ(mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
    EXPECT_NE(error_text([&] { FilmFile f(folder.path() / "pipe"); }).find("this is not a file"), std::string::npos);
    write_image(file, test::make_test_image(4, 4), {});
    EXPECT_NE(error_text([&] { FilmFile f(file); }).find("--mergeable"), std::string::npos);
    write_image(folder.path() / "a.png", test::make_test_image(4, 4), {});
    EXPECT_NE(error_text([&] { FilmFile f(folder.path() / "a.png"); }).find("film files are OpenEXR"),
              std::string::npos);
    EXPECT_THROW(write_film(file, some_film(0, 1), test::make_test_image(4, 4), {}), Error);
}

/// The size in a header is compared with the file's size before memory is allocated.
TEST(FilmFile, AllocatesOnlyStoredData)
{
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.exr";
    write(file, some_film(4, 9));
    std::vector<char> bytes = bytes_of(file);
    const std::string key = "size=7x5;";
    const auto at = std::search(bytes.begin(), bytes.end(), key.begin(), key.end());
    ASSERT_NE(at, bytes.end());
    // The following field's name shrinks so that the header keeps its length.
    const std::string large = "size=65535x65535;";
    std::vector<char> changed(bytes.begin(), at);
    changed.insert(changed.end(), large.begin(), large.end());
    changed.insert(changed.end(), at + std::ptrdiff_t(key.size()), bytes.end());
    overwrite(file, changed);
    // The attribute is now longer than its declared size, so reading the headers stops.
    EXPECT_THROW(FilmFile f(file), Error);
    // The file is truncated, and its header consistently declares 65535 x 65535 pixels.
    RenderSettings settings;
    settings.width = settings.height = 65535;
    const std::string most = FilmKey{settings, std::string(32, '0')}.text();
    for (const std::size_t length : {std::size_t(0), std::size_t(1) << 20}) {
        Image image = test::make_test_image(65535, 1, {"Y"});
        image.attributes = {{"fathom.sums.version", "1"},
                            {"fathom.sums.key", most},
                            {"fathom.sums.samples", "0:1"},
                            {"fathom.sums.dropped", "0"},
                            {"fathom.sums.packing", "0+0,0+0,0+0,0+0,0+0,0+0"},
                            {"fathom.sums.checksum", std::string(16, '0')}};
        write_image(file, image, {});
        fs::resize_file(file, fs::file_size(file) + length);
        const std::string message = error_text([&] { FilmFile(file).read(); });
        EXPECT_NE(message.find("does not have 65535x65535 pixels"), std::string::npos) << message;
    }
}

TEST(FilmSnapshot, IsOfTheMomentItWasTaken)
{
    const TemporaryFolder folder;
    Film film = some_film(0, 3);
    const Film before = test::copy_of(film);
    FilmSnapshot snapshot;
    snapshot.take(film, film.beauty(false), {});
    film.merge(some_film(8, 9));
    snapshot.write(folder.path() / "a.exr");
    expect_same(FilmFile(folder.path() / "a.exr").read(), before);
    snapshot.take(film, film.beauty(false), {});
    snapshot.write(folder.path() / "a.exr", folder.path() / "a.previous.exr");
    expect_same(FilmFile(folder.path() / "a.exr").read(), film);
    expect_same(FilmFile(folder.path() / "a.previous.exr").read(), before);
    snapshot.write(folder.path() / "a.exr", folder.path() / "a.previous.exr");
    expect_same(FilmFile(folder.path() / "a.previous.exr").read(), film);
    EXPECT_EQ(folder.files(), 2u);
}

TEST(FilmSnapshot, LeavesTheEarlierFileWhenTheDiskIsFull)
{
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.exr";
    write(file, some_film(0, 3));
    const std::vector<char> before = bytes_of(file);
    const Film film = some_film(8, 9);
    FilmSnapshot snapshot;
    snapshot.take(film, film.beauty(false), {});
    for (rlim_t limit : {0, 1, 100, 2000}) {
        const std::string message = error_text([&] {
            const test::FileSizeLimit full(limit);
            snapshot.write(file, folder.path() / "b.exr");
        });
        EXPECT_NE(message.find("can't write: "), std::string::npos) << limit << " " << message;
        EXPECT_EQ(bytes_of(file), before);
    }
    EXPECT_EQ(folder.files(), 1u);
}

}  // namespace
}  // namespace fathom
