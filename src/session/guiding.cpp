#include "session/guiding.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "film/film_data.h"

namespace fathom {

namespace {

/// So many paths are learnt from: half as many as the picture has pixels, but not fewer or more than these. With fewer
/// much is missed indoors; a million take some 100 MB for a while.
constexpr std::size_t least_paths = std::size_t(1) << 18, most_paths = std::size_t(1) << 20;
/// Of each pixel that is looked at, so that the noise of its samples is known.
constexpr std::size_t least_samples = 4;
constexpr std::size_t paths_per_job = 4096;
/// Guided paths are tried in every so manieth of these pixels.
constexpr std::size_t trial_step = 2;
/// What a guided path's vertex takes, in those of one that is not; measured.
constexpr double guided_cost = 1.15;
/// With less gain the plain paths are kept: it is not known exactly, and the more samples a pixel has, the more plain
/// ones win by their even spread, which shows less in the few of the trial.
constexpr double least_gain = 1.2;
/// How bright a pixel is, is told by so many before it in its row, and as many behind it.
constexpr std::size_t neighbours = 16;
/// Of all pixels, the noisiest that don't count: a few would decide alone.
constexpr double outliers = 0.001;

/// Pixels far apart, in rows and columns of equal distances, about `count` of them or all that there are.
std::vector<std::uint32_t> spread_pixels(int width, int height, std::size_t count)
{
    const double step = std::sqrt(std::max(1.0, double(width) * height / double(count)));
    std::vector<std::uint32_t> pixels;
    for (double y = step / 2; y < height; y += step)
        for (double x = step / 2; x < width; x += step) pixels.push_back(std::uint32_t(y) << 16 | std::uint32_t(x));
    return pixels;
}

/// What some samples of some pixels met and brought.
struct Pass {
    GuidingRecords records;
    std::size_t samples = 0;  ///< of each pixel
    std::uint64_t vertices = 0;
};

/// salt: passes with another have other random numbers, as the samples of pictures have.
Pass trace(const KernelScene& scene, const CameraRecord& camera, KernelSettings settings,
           const std::vector<std::uint32_t>& pixels, std::size_t samples, std::uint32_t salt,
           const std::atomic<bool>* cancel)
{
    const auto is_cancelled = [&] { return cancel && cancel->load(std::memory_order_relaxed); };
    settings.seed ^= salt;
    settings.measure = false;
    const FilmLayout layout({}, false);
    settings.aovs = layout;
    settings.film_words = std::size_t(layout.words);
    const std::size_t step = std::clamp<std::size_t>(paths_per_job / samples, 1, max_job_pixels);
    std::vector<Pass> parts((pixels.size() + step - 1) / step);
    tbb::parallel_for(std::size_t(0), parts.size(), [&](std::size_t part) {
        if (is_cancelled()) return;
        const std::size_t first = part * step, count = std::min(step, pixels.size() - first);
        TileSums sums;
        sums.reset(count, settings.film_words);
        KernelCounters counters;
        render_job(scene, camera, settings,
                   {&pixels[first], std::uint32_t(count), 0, std::uint32_t(samples), &parts[part].records}, sums,
                   counters);
        parts[part].vertices = counters.costs.vertices;
    });
    if (is_cancelled()) throw Cancelled();
    Pass all;
    all.samples = samples;
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    for (const Pass& part : parts) {
        append(all.records.turns, part.records.turns);
        append(all.records.radiance, part.records.radiance);
        all.vertices += part.vertices;
    }
    return all;
}

/// Mean and variance of the samples of a pixel.
struct Spread {
    double mean = 0, variance = 0;
};
Spread spread_of(const Pass& pass, std::size_t pixel)
{
    const float* const values = &pass.records.radiance[pixel * pass.samples];
    Spread s;
    for (std::size_t i = 0; i < pass.samples; ++i) s.mean += double(values[i]) / double(pass.samples);
    for (std::size_t i = 0; i < pass.samples; ++i)
        s.variance += (double(values[i]) - s.mean) * (double(values[i]) - s.mean) / double(pass.samples - 1);
    return s;
}

/// Sum of the numbers but the largest.
double sum_without_outliers(std::vector<double> numbers)
{
    std::sort(numbers.begin(), numbers.end());
    numbers.resize(numbers.size() - std::size_t(outliers * double(numbers.size())));
    double sum = 0;
    for (double x : numbers) sum += x;
    return sum;
}

/// How many times as much noise, for equal time, paths have in every trial_step-th pixel without guidance as with.
double gain(const Pass& plain, const Pass& guided)
{
    const std::size_t pixels = guided.records.radiance.size() / guided.samples;
    double mean = 0;
    for (float x : plain.records.radiance) mean += double(x) / double(plain.records.radiance.size());
    std::vector<Spread> a(pixels), b(pixels);
    // Sums of the means up to each pixel: a pixel's own few samples don't tell how bright it is.
    std::vector<double> sums(pixels + 1);
    for (std::size_t i = 0; i < pixels; ++i) {
        a[i] = spread_of(plain, i * trial_step), b[i] = spread_of(guided, i);
        sums[i + 1] = sums[i] + 0.5 * (a[i].mean + b[i].mean);
    }
    std::vector<double> before(pixels), after(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        const std::size_t from = i - std::min(i, neighbours), to = std::min(pixels, i + neighbours + 1);
        const double around = (sums[to] - sums[from]) / double(to - from);
        const double scale = around * around + 0.01 * mean * mean;
        if (!(scale > 0)) continue;
        before[i] = a[i].variance / scale;
        after[i] = b[i].variance / scale;
    }
    const double noise = sum_without_outliers(before) / std::max(sum_without_outliers(after), 1e-30);
    const double share = double(guided.records.radiance.size()) / double(plain.records.radiance.size());
    return noise * share * double(plain.vertices) / (guided_cost * double(std::max<std::uint64_t>(guided.vertices, 1)));
}

}  // namespace

std::shared_ptr<const GuidingTables> learn_guiding(const KernelScene& scene, const CameraRecord& camera,
                                                   const KernelSettings& settings, const std::atomic<bool>* cancel)
{
    const std::size_t picture = std::size_t(settings.width) * std::size_t(settings.height);
    const std::size_t paths = std::clamp(picture / 2, least_paths, most_paths);
    const std::vector<std::uint32_t> pixels = spread_pixels(settings.width, settings.height, paths / least_samples);
    const std::size_t samples = std::max(least_samples, paths / pixels.size());
    Pass plain = trace(scene, camera, settings, pixels, samples, 0x9e3779b9u, cancel);
    const std::shared_ptr<const GuidingTables> first = make_guiding(plain.records.turns);
    if (!first) return nullptr;
    std::vector<std::uint32_t> tried;
    for (std::size_t i = 0; i < pixels.size(); i += trial_step) tried.push_back(pixels[i]);
    KernelSettings with_first = settings;
    with_first.guiding = first.get();
    const Pass guided = trace(scene, camera, with_first, tried, samples, 0x3c6ef372u, cancel);
    if (gain(plain, guided) < least_gain) return nullptr;
    std::vector<GuidingRecord>& turns = plain.records.turns;
    turns.insert(turns.end(), guided.records.turns.begin(), guided.records.turns.end());
    return make_guiding(turns);
}

}  // namespace fathom
