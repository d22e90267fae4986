// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <limits>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "fathom/error.h"
#include "film/film_data.h"
#include "film/film_words.h"
#include "film/moments.h"

namespace fathom {

namespace {

Image::Layer layer(const Film::Data& film, const std::string& name, const std::vector<std::string>& channels)
{
    return {name, channels, std::vector<float>(std::size_t(film.width) * std::size_t(film.height) * channels.size())};
}

/// Creates a layer whose values are value(sums of the pixel, channel).
template <class Value>
Image::Layer fill(const Film::Data& film, const std::string& name, const std::vector<std::string>& channels,
                  Value value)
{
    Image::Layer l = layer(film, name, channels);
    const std::size_t n = channels.size();
    const std::size_t pixels = l.pixels.size() / n;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pixels, 1 << 14), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            for (std::size_t c = 0; c < n; ++c) l.pixels[i * n + c] = value(film.pixel(i), int(c));
    });
    return l;
}

double radiance(const std::uint32_t* pixel, int channel)
{
    return ExactSum::value(radiance_sum(pixel, channel));
}

/// Sum of what light tracing added to a pixel.
double splats(const FilmLayout& layout, const std::uint32_t* pixel, int channel)
{
    return layout.splats < 0 ? 0 : ExactSum::value(other_sum(pixel, layout.splats + channel));
}

}  // namespace

FilmLayout::FilmLayout(const std::vector<Aov>& aovs, bool alpha_wanted, bool light_tracing, bool error_probes)
{
    const auto has = [&](Aov aov) { return std::find(aovs.begin(), aovs.end(), aov) != aovs.end(); };
    const auto take = [&](bool wanted, int count) {
        if (!wanted) return -1;
        sums += count;
        return sums - count;
    };
    alpha = take(alpha_wanted, 1);
    albedo = take(has(Aov::albedo), 3);
    normal = take(has(Aov::normal), 3);
    depth = take(has(Aov::depth), 1);
    position = take(has(Aov::position), 3);
    hits = take(depth >= 0 || position >= 0, 1);
    splats = take(light_tracing, 3);
    probe = take(error_probes, 1);
    words += sums * ExactSum::words;
    if (has(Aov::instance_id) || has(Aov::material_id)) {
        ids = words;
        words += 3;
    }
    if (light_tracing) {
        splat_squares = words;
        words += 3 * ExactSquareSum::words;
    }
}

void Film::Data::add_range(SampleRange range)
{
    if (range.first >= range.second) return;
    for (const SampleRange& r : samples)
        if (range.first < r.second && r.first < range.second)
            throw Error("", "",
                        fmt::format("samples {}:{} overlap with {}:{}, which the film already contains", range.first,
                                    range.second, r.first, r.second));
    samples.push_back(range);
    std::sort(samples.begin(), samples.end());
    std::vector<SampleRange> joined;
    for (const SampleRange& r : samples) {
        if (!joined.empty() && joined.back().second == r.first)
            joined.back().second = r.second;
        else
            joined.push_back(r);
    }
    samples = std::move(joined);
}

void Film::Data::register_samples(const FilmKey& of, const std::vector<SampleRange>& ranges,
                                  std::uint64_t dropped_there)
{
    if (const std::string difference = of.difference(key); !difference.empty())
        throw Error("", "", "does not match the others: " + difference);
    const std::vector<SampleRange> before = samples;
    try {
        for (const SampleRange& range : ranges) add_range(range);
    } catch (...) {
        samples = before;
        throw;
    }
    dropped += dropped_there;
}

Film::Data::Data(FilmKey new_key)
{
    reset(std::move(new_key));
}

void Film::Data::reset(FilmKey new_key)
{
    key = std::move(new_key);
    width = key.settings.width;
    height = key.settings.height;
    layout = FilmLayout(key.settings);
    samples.clear();
    dropped = 0;
    invalid_sample.reset();
    const std::size_t pixels = std::size_t(width) * std::size_t(height);
    words.assign(pixels * std::size_t(layout.words), 0u);
    pass_words.clear();
    if (layout.ids >= 0)
        for (std::size_t i = 0; i < pixels; ++i) pixel(i)[layout.ids] = 0xffffffffu;
}

Film::Film(FilmKey key) : data_(new Data(std::move(key))) {}

std::size_t Film::bytes_per_pixel(const RenderSettings& settings)
{
    return std::size_t(FilmLayout(settings).words) * sizeof(std::uint32_t);
}

Film::Film(Film&&) noexcept = default;
Film& Film::operator=(Film&&) noexcept = default;
Film::~Film() = default;

const FilmKey& Film::key() const
{
    return data_->key;
}
int Film::width() const
{
    return data_->width;
}
int Film::height() const
{
    return data_->height;
}
const std::vector<SampleRange>& Film::samples() const
{
    return data_->samples;
}
std::uint64_t Film::invalid_samples() const
{
    return data_->dropped;
}

std::optional<Film::SampleLocation> Film::invalid_sample() const
{
    return data_->invalid_sample;
}

std::uint64_t Film::samples_per_pixel() const
{
    std::uint64_t n = 0;
    for (const SampleRange& r : data_->samples) n += r.second - r.first;
    return n;
}

void Film::merge(const Film& other)
{
    const Data& from = *other.data_;
    Data& to = *data_;
    to.register_samples(from.key, from.samples, from.dropped);
    if (!to.invalid_sample) to.invalid_sample = from.invalid_sample;
    const std::size_t pixels = std::size_t(to.width) * std::size_t(to.height);
    for (std::size_t i = 0; i < pixels; ++i) to.add_pixel(i, from.pixel(i));
}

int words_per_pixel(const Film& film)
{
    return film.data().layout.words;
}

const std::uint32_t* film_words(const Film& film)
{
    return film.data().words.data();
}

void add_words(const Film& film, const std::uint32_t* from, std::uint32_t* to, std::size_t pixels)
{
    const auto words = std::size_t(film.data().layout.words);
    for (std::size_t i = 0; i < pixels; ++i) film.data().add_pixel(to + i * words, from + i * words);
}

void begin_merge(Film& film, const FilmKey& key, const std::vector<SampleRange>& samples, std::uint64_t invalid,
                 const std::optional<Film::SampleLocation>& invalid_sample)
{
    Film::Data& data = film.data();
    data.register_samples(key, samples, invalid);
    if (!data.invalid_sample) data.invalid_sample = invalid_sample;
}

void merge_words(Film& film, std::size_t first_pixel, const std::uint32_t* words, std::size_t pixels)
{
    add_words(film, words, film.data().pixel(first_pixel), pixels);
}

Image Film::beauty(bool alpha) const
{
    const Data& film = *data_;
    const double n = double(samples_per_pixel());
    const double scale = n > 0 ? 1 / n : 0;
    Image image;
    image.width = film.width;
    image.height = film.height;
    if (alpha && film.layout.alpha >= 0)
        image.layers.push_back(fill(film, "", {"R", "G", "B", "A"}, [&](const std::uint32_t* pixel, int c) {
            return float((c < 3 ? radiance(pixel, c) + splats(film.layout, pixel, c)
                                : ExactSum::value(other_sum(pixel, film.layout.alpha))) *
                         scale);
        }));
    else
        image.layers.push_back(fill(film, "", {"R", "G", "B"}, [&](const std::uint32_t* pixel, int c) {
            return float((radiance(pixel, c) + splats(film.layout, pixel, c)) * scale);
        }));
    return image;
}

Image Film::image(bool alpha, bool variance) const
{
    const Data& film = *data_;
    const FilmLayout& layout = film.layout;
    const double n = double(samples_per_pixel());
    const double scale = n > 0 ? 1 / n : 0;
    const auto sum = [](const std::uint32_t* pixel, int place) { return ExactSum::value(other_sum(pixel, place)); };
    const auto mean_of = [&](int first) {
        return [=](const std::uint32_t* pixel, int c) { return float(sum(pixel, first + c) * scale); };
    };
    const auto mean_of_hits = [&](int first, float without) {
        return [=](const std::uint32_t* pixel, int c) {
            const double hits = sum(pixel, layout.hits);
            return hits > 0 ? float(sum(pixel, first + c) / hits) : without;
        };
    };

    Image image = beauty(alpha);
    for (Aov aov : film.key.settings.aovs) {
        const auto id = [&](int word) {
            return [=](const std::uint32_t* pixel, int) { return float(pixel[layout.ids + word]); };
        };
        switch (aov) {
            case Aov::albedo:
                image.layers.push_back(fill(film, "albedo", {"R", "G", "B"}, mean_of(layout.albedo)));
                break;
            case Aov::normal:
                image.layers.push_back(fill(film, "normal", {"X", "Y", "Z"}, mean_of(layout.normal)));
                break;
            case Aov::depth:
                image.layers.push_back(
                    fill(film, "depth", {"Z"}, mean_of_hits(layout.depth, std::numeric_limits<float>::infinity())));
                break;
            case Aov::position:
                image.layers.push_back(fill(film, "position", {"X", "Y", "Z"}, mean_of_hits(layout.position, 0)));
                break;
            case Aov::instance_id:
                image.layers.push_back(fill(film, "instance", {"ID"}, id(1)));
                break;
            case Aov::material_id:
                image.layers.push_back(fill(film, "material", {"ID"}, id(2)));
                break;
        }
    }
    if (variance)
        image.layers.push_back(
            fill(film, "variance", {"R", "G", "B"}, [moments = FilmMoments(*this)](const std::uint32_t* pixel, int c) {
                return float(moments.of(pixel).all_variance(std::size_t(c)));
            }));
    return image;
}

}  // namespace fathom
