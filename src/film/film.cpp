#include <algorithm>
#include <charconv>
#include <limits>

#include <fmt/format.h>

#include "fathom/error.h"
#include "film/film_data.h"

namespace fathom {

namespace {

std::string key_of(const RenderSettings& s)
{
    std::string aovs;
    for (Aov aov : s.aovs) aovs += fmt::format("{}", int(aov));
    std::string key =
        fmt::format("aovs={};alpha={};seed={};max_depth={};roulette_depth={};light_sampling={};filter={}", aovs,
                    int(s.alpha), s.seed, s.max_depth, s.roulette_depth, int(s.light_sampling), int(s.filter));
    if (s.crop) key += fmt::format(";crop={},{},{},{}", s.crop->x0, s.crop->y0, s.crop->x1, s.crop->y1);
    if (s.background)
        key += fmt::format(";background={:a},{:a},{:a}", s.background->r, s.background->g, s.background->b);
    return key;
}

/// The value of `name=value;` in a key.
std::string field_of(const std::string& key, const std::string& name)
{
    const std::size_t at = key.find(name + "=");
    if (at == std::string::npos) throw Error("", "", "its sums are of no film that this version knows");
    const std::size_t begin = at + name.size() + 1;
    return key.substr(begin, key.find(';', begin) - begin);
}

Image::Layer layer(const Film::Data& film, const std::string& name, const std::vector<std::string>& channels)
{
    return {name, channels, std::vector<float>(std::size_t(film.width) * std::size_t(film.height) * channels.size())};
}

/// Fills a layer from `value(sums of the pixel, channel)`.
template <class Value>
Image::Layer fill(const Film::Data& film, const std::string& name, const std::vector<std::string>& channels,
                  Value value)
{
    Image::Layer l = layer(film, name, channels);
    const std::size_t n = channels.size();
    for (std::size_t i = 0; i * n < l.pixels.size(); ++i)
        for (std::size_t c = 0; c < n; ++c) l.pixels[i * n + c] = value(film.pixel(i), int(c));
    return l;
}

}  // namespace

FilmLayout::FilmLayout(const std::vector<Aov>& aovs, bool alpha_wanted)
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
    words += sums * ExactSum::words;
    if (has(Aov::instance_id) || has(Aov::material_id)) {
        ids = words;
        words += 3;
    }
}

void Film::Data::add_range(SampleRange range)
{
    if (range.first >= range.second) return;
    for (const SampleRange& r : samples)
        if (range.first < r.second && r.first < range.second)
            throw Error("", "",
                        fmt::format("samples {}:{} are in the film already (it has {}:{})", range.first, range.second,
                                    r.first, r.second));
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

Film::Film(const RenderSettings& settings) : data_(new Data)
{
    data_->width = settings.width;
    data_->height = settings.height;
    data_->aovs = settings.aovs;
    data_->alpha = settings.alpha;
    data_->layout = FilmLayout(settings.aovs, settings.alpha);
    data_->key = key_of(settings);
    const std::size_t pixels = std::size_t(settings.width) * std::size_t(settings.height);
    data_->words.resize(pixels * std::size_t(data_->layout.words));
    if (data_->layout.ids >= 0)
        for (std::size_t i = 0; i < pixels; ++i) data_->pixel(i)[data_->layout.ids] = 0xffffffffu;
}

Film::Film(Film&&) noexcept = default;
Film& Film::operator=(Film&&) noexcept = default;
Film::~Film() = default;

void Film::clear()
{
    Data& data = *data_;
    data.samples.clear();
    data.scene_key.clear();
    data.dropped = 0;
    data.dropped_sample.reset();
    std::fill(data.words.begin(), data.words.end(), 0u);
    if (data.layout.ids >= 0)
        for (std::size_t i = 0; i * std::size_t(data.layout.words) < data.words.size(); ++i)
            data.pixel(i)[data.layout.ids] = 0xffffffffu;
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
std::uint64_t Film::dropped_samples() const
{
    return data_->dropped;
}

std::optional<Film::SamplePlace> Film::dropped_sample() const
{
    return data_->dropped_sample;
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
    if (from.width != to.width || from.height != to.height)
        throw Error("", "", fmt::format("is {}x{} pixels, not {}x{}", from.width, from.height, to.width, to.height));
    if (from.key != to.key)
        throw Error("", "", fmt::format("was rendered with other settings: '{}', not '{}'", from.key, to.key));
    if (!from.samples.empty() && !to.samples.empty() && from.scene_key != to.scene_key)
        throw Error("", "", "shows another scene or camera");
    const std::vector<SampleRange> before = to.samples;
    try {
        for (const SampleRange& r : from.samples) to.add_range(r);
    } catch (...) {
        to.samples = before;
        throw;
    }
    if (to.scene_key.empty()) to.scene_key = from.scene_key;
    to.dropped += from.dropped;
    if (!to.dropped_sample) to.dropped_sample = from.dropped_sample;
    const std::size_t pixels = std::size_t(to.width) * std::size_t(to.height);
    for (std::size_t i = 0; i < pixels; ++i) to.add_pixel(i, from.pixel(i));
}

Image Film::image(bool alpha, bool variance) const
{
    const Data& film = *data_;
    const FilmLayout& layout = film.layout;
    const double n = double(samples_per_pixel());
    const double scale = n > 0 ? 1 / n : 0;
    const auto radiance = [](const std::uint32_t* pixel, int c) { return ExactSum::value(radiance_sum(pixel, c)); };
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

    Image image;
    image.width = film.width;
    image.height = film.height;
    if (alpha && layout.alpha >= 0)
        image.layers.push_back(fill(film, "", {"R", "G", "B", "A"}, [&](const std::uint32_t* pixel, int c) {
            return float((c < 3 ? radiance(pixel, c) : sum(pixel, layout.alpha)) * scale);
        }));
    else
        image.layers.push_back(fill(film, "", {"R", "G", "B"}, [&](const std::uint32_t* pixel, int c) {
            return float(radiance(pixel, c) * scale);
        }));
    for (Aov aov : film.aovs) {
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
        image.layers.push_back(fill(film, "variance", {"R", "G", "B"}, [&](const std::uint32_t* pixel, int c) {
            if (n < 2) return 0.0f;
            const double mean = radiance(pixel, c) * scale;
            return float(std::max(0.0, ExactSquareSum::value(square_sum(pixel, c)) * scale - mean * mean) / (n - 1));
        }));
    return image;
}

Film::Sums Film::sums() const
{
    Sums sums;
    sums.width = data_->width;
    sums.height = data_->height;
    sums.words_per_pixel = data_->layout.words;
    sums.words = data_->words;
    sums.samples = data_->samples;
    sums.dropped = data_->dropped;
    sums.key = data_->key + ";scene=" + data_->scene_key;
    return sums;
}

Film Film::from_sums(const Sums& sums)
{
    RenderSettings settings;
    settings.width = sums.width;
    settings.height = sums.height;
    for (char digit : field_of(sums.key, "aovs")) {
        if (digit < '0' || digit > '5') throw Error("", "", "its sums are of no film that this version knows");
        settings.aovs.push_back(Aov(digit - '0'));
    }
    settings.alpha = field_of(sums.key, "alpha") == "1";
    Film film(settings);
    Data& data = film.data();
    if (data.layout.words != sums.words_per_pixel || data.words.size() != sums.words.size())
        throw Error(
            "", "",
            fmt::format("its sums have {} words a pixel, {} were expected", sums.words_per_pixel, data.layout.words));
    const std::size_t scene = sums.key.rfind(";scene=");
    if (scene == std::string::npos) throw Error("", "", "its sums don't say which scene they are of");
    data.key = sums.key.substr(0, scene);
    data.scene_key = sums.key.substr(scene + 7);
    data.words = sums.words;
    data.samples = sums.samples;
    data.dropped = sums.dropped;
    return film;
}

}  // namespace fathom
