// SPDX-License-Identifier: Apache-2.0
#include "fathom/profile.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "fathom/error.h"
#include "session/job.h"
#include "session/kernel_settings.h"
#include "session/profile_sums.h"
#include "session/thread_arena.h"
#include "session/tiles.h"

namespace fathom {

namespace {

/// Width of a tile: enough paths to fill the kernel's pool several times.
constexpr int profile_tile = 32;
/// Fraction of the pixels that RenderProfile::top_noise is about.
constexpr double top_fraction = 0.001;

/// Sums of a tile with its place in the image.
struct Tile {
    std::vector<std::uint32_t> pixels;
    ProfileTileSums sums;
    double seconds = 0;
};

/// Processor time of this thread, which other programs do not lengthen.
double thread_seconds()
{
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// The kernel's settings for one set of samples.
KernelSettings settings_of_set(const RenderJob& job, std::size_t set)
{
    RenderSettings settings = job.settings();
    settings.aovs.clear();
    settings.alpha = settings.error_probes = settings.measure_stages = false;
    settings.light_paths = 0;
    settings.seed += std::uint32_t(set);
    return kernel_settings(settings, FilmLayout({}, false));
}

Tile render_tile(const RenderJob& job, const ProfileNames& names, std::vector<std::uint32_t> pixels, int set_samples)
{
    Tile tile{std::move(pixels), {}, 0};
    std::array<PathProfile, profile_sets> sets;
    TileSums sums;
    KernelCounters counters;
    const double start = thread_seconds();
    for (std::size_t set = 0; set < sets.size(); ++set) {
        const KernelSettings settings = settings_of_set(job, set);
        sums.reset(tile.pixels.size(), settings.film_words);
        render_job(*job.scene().data().kernel, job.data().camera_record, settings,
                   {.pixels = tile.pixels.data(),
                    .pixel_count = std::uint32_t(tile.pixels.size()),
                    .samples = std::uint32_t(set_samples),
                    .profile = &sets[set]},
                   sums, counters);
    }
    tile.seconds = thread_seconds() - start;
    tile.sums = sum_profile(names, sets, tile.pixels.size(), set_samples);
    return tile;
}

/// Letters of the events of a path, from the camera to the light.
std::string path_text(PathWord word)
{
    std::string text = "E";
    for (std::uint32_t place = path_word_events; place-- > 0;) {
        if (place == 1 && (word & path_word_gap)) text += "...";
        if (const std::uint32_t event = word >> (4 * place) & 15; event != 0) text += path_event_letters[event];
    }
    return text + "L";
}

/// ProfileRow::index of a cause.
int index_of(const IndexedCause& cause)
{
    const bool has_none = cause.cause == ProfileCause::camera || cause.cause == ProfileCause::environment ||
                          cause.cause == ProfileCause::no_light || cause.cause == ProfileCause::medium;
    return has_none ? -1 : int(cause.index);
}

ProfileRow make_row(const ProfileKey& key, const ProfileSums& sums, const ProfileSums& total)
{
    const auto share = [](double part, double whole) { return whole > 0 ? part / whole : 0; };
    ProfileRow row;
    row.cause = key.cause, row.is_sampled = key.is_sampled;
    if (key.cause == ProfileCause::path || key.cause == ProfileCause::combination)
        row.path = path_text(PathWord(key.value));
    else
        row.index = index_of({key.cause, key.value});
    if (key.cause == ProfileCause::combination) {
        row.light_cause = key.light.cause, row.light_index = index_of(key.light);
        row.place_cause = key.place.cause, row.place_index = index_of(key.place);
    }
    row.noise = share(sums.noise, total.noise);
    row.light = share(sums.light, total.light);
    row.time = share(sums.nanoseconds, total.nanoseconds);
    row.rays = sums.rays, row.shadow_rays = sums.shadow_rays;
    // The jackknife over sets: Efron and Stein 1981, "The Jackknife Estimate of Variance".
    constexpr double n = profile_sets;
    std::array<double, profile_sets> shares{};
    double mean = 0, squares = 0;
    for (std::size_t s = 0; s < shares.size(); ++s) mean += (shares[s] = share(sums.without[s], total.without[s])) / n;
    for (const double x : shares) squares += (x - mean) * (x - mean);
    row.noise_error = std::sqrt(squares * (n - 1) / n);
    return row;
}

std::vector<ProfileRow> make_table(const std::map<ProfileKey, ProfileSums>& rows, const ProfileSums& total)
{
    std::vector<ProfileRow> table;
    table.reserve(rows.size());
    for (const auto& [key, sums] : rows) table.push_back(make_row(key, sums, total));
    std::stable_sort(table.begin(), table.end(),
                     [](const ProfileRow& a, const ProfileRow& b) { return a.noise > b.noise; });
    return table;
}

/// Share of the noise in the noisiest pixels.
double share_of_top(std::vector<double> noise)
{
    const auto count = std::ptrdiff_t(std::ceil(top_fraction * double(noise.size())));
    double sum = 0, top = 0;
    for (const double x : noise) sum += x;
    std::nth_element(noise.begin(), noise.begin() + (count - 1), noise.end(), std::greater<>());
    for (auto x = noise.begin(); x != noise.begin() + count; ++x) top += *x;
    return sum > 0 ? top / sum : 0;
}

/// Adds the tiles in their order, so that sums don't depend on threads.
RenderProfile add_tiles(const RenderJob& job, const std::vector<Tile>& tiles, int set_samples)
{
    const Crop crop = job.settings().rendered_pixels();
    RenderProfile profile;
    profile.width = crop.x1 - crop.x0, profile.height = crop.y1 - crop.y0;
    profile.samples_per_pixel = profile_sets * set_samples;
    const std::size_t pixels = std::size_t(profile.width) * std::size_t(profile.height);
    profile.image.resize(3 * pixels), profile.pixel_error.resize(pixels), profile.pixel_seconds.resize(pixels);
    std::array<std::map<ProfileKey, ProfileSums>, profile_table_count> rows;
    ProfileSums total;
    std::vector<double> noise(pixels);
    for (const Tile& tile : tiles) {
        total.add(tile.sums.total);
        profile.seconds += tile.seconds;
        for (std::size_t t = 0; t < rows.size(); ++t)
            for (const auto& [key, sums] : tile.sums.tables[t]) rows[t][key].add(sums);
        const double second = tile.sums.total.nanoseconds > 0 ? tile.seconds / tile.sums.total.nanoseconds : 0;
        for (std::size_t i = 0; i < tile.pixels.size(); ++i) {
            const std::size_t at = std::size_t(int(tile.pixels[i] >> 16) - crop.y0) * std::size_t(profile.width) +
                                   std::size_t(int(tile.pixels[i] & 0xffff) - crop.x0);
            const ProfilePixel& pixel = tile.sums.pixels[i];
            for (std::size_t c = 0; c < 3; ++c) profile.image[3 * at + c] = float(pixel.mean[c]);
            noise[at] = pixel.noise;
            profile.pixel_error[at] = float(std::sqrt(pixel.noise));
            profile.pixel_seconds[at] = float(pixel.nanoseconds * second);
        }
    }
    profile.error = std::sqrt(total.noise / double(pixels));
    profile.rays = total.rays;
    profile.top_noise = share_of_top(std::move(noise));
    const auto table = [&](ProfileTable t) { return make_table(rows[std::size_t(t)], total); };
    profile.lights = table(ProfileTable::lights), profile.materials = table(ProfileTable::materials);
    profile.objects = table(ProfileTable::objects), profile.paths = table(ProfileTable::paths);
    profile.depths = table(ProfileTable::depths), profile.combinations = table(ProfileTable::combinations);
    return profile;
}

}  // namespace

std::optional<RenderProfile> profile_render(const RenderJob& job, const std::vector<SceneObject>& objects,
                                            int set_samples, const std::atomic<bool>* cancel)
{
    if (set_samples < 1 || set_samples > max_profile_set_samples)
        throw Error("", "",
                    fmt::format("a profile has 1 to {} samples per set, not {}", max_profile_set_samples, set_samples));
    const ProfileNames names(*job.scene().data().tables, objects);
    const Tiles layout(job.settings().rendered_pixels(), profile_tile);
    std::vector<Tile> tiles(layout.count());
    ThreadArena arena(job.settings().threads);
    arena.execute([&] {
        tbb::parallel_for(std::size_t(0), tiles.size(), [&](std::size_t i) {
            if (cancel && *cancel) return;
            std::vector<std::uint32_t> pixels;
            layout.pixels(i, pixels);
            tiles[i] = render_tile(job, names, std::move(pixels), set_samples);
        });
    });
    if (cancel && *cancel) return {};
    return add_tiles(job, tiles, set_samples);
}

}  // namespace fathom
