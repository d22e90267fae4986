// SPDX-License-Identifier: Apache-2.0
#include "fathom/render.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "fathom/error.h"
#include "fathom/memory.h"
#include "film/film_data.h"
#include "film/probes.h"
#include "kernel/kernel.h"
#include "session/caustic_map.h"
#include "session/guiding.h"
#include "session/job.h"
#include "session/kernel_settings.h"
#include "session/light_targets.h"
#include "session/light_trial.h"
#include "session/photon_trial.h"
#include "session/splat_adder.h"
#include "session/thread_arena.h"
#include "session/tiles.h"

namespace fathom {

namespace {

/// Target duration of a pass, for progress reports and quick cancellation.
constexpr double pass_s = 0.4;
/// A pass of a single sample that takes longer can be discarded, since cancellation should take at most two seconds.
constexpr double longest_pass_s = 0.8;
/// Light paths per task.
constexpr std::uint32_t light_paths_per_job = 1u << 14;
/// Limit on the samples of a pass, which a task of the smallest tile can hold.
constexpr std::uint64_t max_pass_samples = 1024;

/// The job's guiding tables, learned on the first call; nullptr without guiding. Runs in the caller's task arena.
/// Throws Cancelled if `cancel` becomes true.
const GuidingTables* guiding_of(const RenderJob& job, const KernelSettings& settings, const std::atomic<bool>* cancel)
{
    TrainedGuiding* const guiding = job.data().guiding.get();
    if (!guiding) return nullptr;
    std::call_once(guiding->once, [&] {
        guiding->tables = train_guiding(*job.scene().data().kernel, job.data().camera_record, settings, cancel);
    });
    return guiding->tables.get();
}

/// The targets of the job's light paths, learned on the first call; nullptr if they are not aimed. Runs in the caller's
/// task arena. Throws Cancelled if `cancel` becomes true.
const LightTargets* light_targets_of(const RenderJob& job, const KernelSettings& settings,
                                     const std::atomic<bool>* cancel)
{
    LearnedLightTargets* const learned = job.data().light_targets.get();
    if (!learned || settings.light_paths == 0) return nullptr;
    std::call_once(learned->once, [&] {
        learned->targets =
            learn_light_targets(*job.scene().data().kernel, *job.scene().data().tables, job.data().camera_record,
                                settings, job.settings().gathers_caustics(), cancel);
    });
    return learned->targets.get();
}

/// Radius of the job's photons at sample index 0, found on the first call. Runs in the caller's task arena.
float caustic_radius_of(const RenderJob& job, const KernelSettings& settings)
{
    LearnedCausticRadius* const learned = job.data().caustic_radius.get();
    const Scene::Data& scene = job.scene().data();
    std::call_once(learned->once, [&] {
        learned->radius =
            first_caustic_radius(*scene.kernel, job.data().camera_record, settings, scene.tables->ball_radius);
    });
    return learned->radius;
}

/// Per-thread state of a rendering pass.
struct Worker {
    std::vector<std::uint32_t> pixels;
    TileSums sums;
    LightPathResults light, probe_light;
    KernelCounters counters;
    std::uint64_t dropped = 0;
    std::optional<Film::SampleLocation> invalid_sample;

    /// Runs `work` and adds its time to the stages whose ticks the kernel recorded, or to `stage` if it recorded none.
    template <class Work>
    void measured(RenderStage stage, bool measure, const Work& work)
    {
        const auto start = std::chrono::steady_clock::now();
        counters.ticks = {};
        work();
        if (!measure) return;
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const double ticks = std::accumulate(counters.ticks.begin(), counters.ticks.end(), 0.0);
        std::array<double, render_stage_count>& to = counters.costs.seconds;
        if (ticks == 0) to[std::size_t(stage)] += seconds;
        for (std::size_t i = 0; ticks > 0 && i < to.size(); ++i) to[i] += seconds * (double(counters.ticks[i]) / ticks);
    }
    /// Counts the samples that the current task dropped.
    void count_dropped()
    {
        if (sums.dropped == 0) return;
        const std::uint32_t at = pixels[sums.first_dropped_pixel];
        if (dropped == 0)
            invalid_sample = Film::SampleLocation{int(at & 0xffffu), int(at >> 16), sums.first_dropped_sample};
        dropped += sums.dropped;
    }
};
using Workers = tbb::enumerable_thread_specific<Worker>;

/// A worker's pixel in `words`, the sums of a whole image.
std::uint32_t* pixel_words(const Worker& worker, std::uint32_t i, const Film::Data& film, std::uint32_t* words)
{
    const std::uint32_t pixel = worker.pixels[i];
    const std::size_t index = std::size_t(pixel >> 16) * std::size_t(film.width) + (pixel & 0xffff);
    return words + index * std::size_t(film.layout.words);
}

/// Adds the sums of the worker's tile to `words`.
void add_to_words(const Worker& worker, const Film::Data& film, std::uint32_t* words)
{
    for (std::uint32_t i = 0; i < worker.pixels.size(); ++i)
        worker.sums.add_to(i, pixel_words(worker, i, film, words), film.layout.sums, film.layout.ids);
    for (const TileSums::Slow& slow : worker.sums.slow()) {
        std::uint32_t* sums = pixel_words(worker, slow.pixel, film, words);
        for (int c = 0; c < 3; ++c) {
            ExactSum::add_number(radiance_sum(sums, c), slow.value[c]);
            ExactSquareSum::add_number(square_sum(sums, c), double(slow.value[c]) * slow.value[c]);
        }
    }
}

/// Adds the radiance of the worker's pixels, which are those of `probes`, to the sums of the probes in `words`.
void add_probes_to_words(const Worker& worker, const Probe* probes, const Film::Data& film, std::uint32_t* words)
{
    const auto sum_of = [&](std::uint32_t i, int channel) {
        const std::size_t index = probes[i].sums + std::size_t(channel);
        return other_sum(words + index * std::size_t(film.layout.words), film.layout.probe);
    };
    for (std::uint32_t i = 0; i < worker.pixels.size(); ++i) {
        std::array<std::uint32_t, other_words> pixel{};
        worker.sums.add_to(i, pixel.data(), 0, -1);
        for (int c = 0; c < 3; ++c) ExactSum::add(sum_of(i, c), radiance_sum(pixel.data(), c));
    }
    for (const TileSums::Slow& slow : worker.sums.slow())
        for (int c = 0; c < 3; ++c) ExactSum::add_number(sum_of(slow.pixel, c), slow.value[c]);
}

void check_range(SampleRange range)
{
    if (range.first > range.second)
        throw Error("", "", fmt::format("the sample range {}:{} ends before it begins", range.first, range.second));
    if (range.second > max_samples) throw Error("", "", fmt::format("the largest sample index is {}", max_samples - 1));
}

/// Checks before anything is added to the film, because sums can't be separated afterwards. Throws Error.
void check_new(SampleRange range, const Film& film)
{
    for (const SampleRange& r : film.samples())
        if (range.first < r.second && r.first < range.second)
            throw Error("", "", fmt::format("the film already contains samples of {}:{}", range.first, range.second));
}

/// State of one call of render(), and rendering of the tiles of a pass.
class Passes {
public:
    Passes(const RenderJob& job, Film::Data& film, const std::atomic<bool>* cancel)
        : scene_(job.scene().data()),
          film_(film),
          kernel_(kernel_settings(job.settings(), film.layout)),
          camera_(job.data().camera_record),
          crop_(job.settings().rendered_pixels()),
          arena_(job.settings().threads)
    {
        if (job.settings().error_probes) probes_ = probes_of(film.width, crop_);
        if (const std::string difference = film.key.difference(job.key()); !difference.empty())
            throw Error("", "", "the film belongs to another job: " + difference);
        if (scene_.tables->lights.empty()) kernel_.light_paths = 0;
        gathers_ = job.settings().gathers_caustics() && kernel_.light_paths > 0;
        const auto start = std::chrono::steady_clock::now();
        arena_.execute([&] {
            kernel_.light_targets = light_targets_of(job, kernel_, cancel);
            kernel_.guiding = guiding_of(job, kernel_, cancel);
            if (gathers_) caustic_radius_ = caustic_radius_of(job, kernel_);
        });
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        seen_pixels_ = pixels_with_surfaces(*scene_.kernel, camera_, kernel_);
        if (!seen_pixels_.empty()) kernel_.seen_pixels = seen_pixels_.data();
        if (kernel_.measure && (job.data().guiding || job.data().light_targets))
            learning_s_ = seconds * arena_.threads();
    }

    std::uint64_t pixels() const { return std::uint64_t(crop_.x1 - crop_.x0) * std::uint64_t(crop_.y1 - crop_.y0); }

    /// Limit on the samples of a pass: their photons and splats are in memory at once.
    std::uint64_t max_samples() const
    {
        constexpr std::uint64_t most_light_paths = 1'000'000;
        if (!gathers_) return max_pass_samples;
        return std::clamp<std::uint64_t>(most_light_paths / kernel_.light_paths, 1, max_pass_samples);
    }

    /// Traces the light paths of a pass whose camera paths gather photons. Asks stop() before each task.
    template <class Stop>
    void begin(SampleRange range, const Stop& stop)
    {
        if (!gathers_) return;
        caustics_ = map_caustics(range, kernel_, &Worker::light, stop);
        kernel_.caustics = &caustics_;
        // The error includes that of the photons only if probes have photons of their own.
        if (!probes_.empty()) probe_caustics_ = map_caustics(range, probe_settings(), &Worker::probe_light, stop);
    }

    /// Renders the tiles of a pass. Calls take(worker) after each tile; asks stop() before each tile.
    template <class Take, class Stop>
    void render(SampleRange range, const Take& take, const Stop& stop)
    {
        const Tiles tiles(crop_, tile_size(crop_, range.second - range.first, arena_.threads()));
        const auto render_tiles = [&](const tbb::blocked_range<std::size_t>& block) {
            Worker& worker = workers_.local();
            for (std::size_t tile = block.begin(); tile != block.end() && !stop(); ++tile) {
                tiles.pixels(tile, worker.pixels);
                worker.sums.reset(worker.pixels.size(), kernel_.film_words);
                const KernelJob job{worker.pixels.data(), std::uint32_t(worker.pixels.size()),
                                    std::uint32_t(range.first), std::uint32_t(range.second - range.first)};
                worker.measured(RenderStage::camera, kernel_.measure, [&] {
                    render_job(*scene_.kernel, camera_, kernel_, job, worker.sums, worker.counters);
                });
                worker.count_dropped();
                worker.measured(RenderStage::film, kernel_.measure, [&] { take(worker); });
            }
        };
        arena_.execute([&] {
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tiles.count(), 1), render_tiles,
                              tbb::simple_partitioner());
        });
    }

    /// Renders the probes of a pass and adds them to `words`, the sums of a whole image. Asks stop() before each task.
    template <class Stop>
    void render_probes(SampleRange range, std::uint32_t* words, const Stop& stop)
    {
        const KernelSettings settings = probe_settings();
        const auto samples = std::uint32_t(range.second - range.first);
        const auto render = [&](const tbb::blocked_range<std::size_t>& block) {
            if (stop()) return;
            Worker& worker = workers_.local();
            worker.pixels.clear();
            for (std::size_t i = block.begin(); i != block.end(); ++i)
                worker.pixels.push_back(std::uint32_t(probes_[i].y) << 16 | std::uint32_t(probes_[i].x));
            worker.sums.reset(worker.pixels.size(), settings.film_words);
            const KernelJob job{worker.pixels.data(), std::uint32_t(worker.pixels.size()), std::uint32_t(range.first),
                                samples};
            worker.measured(RenderStage::camera, kernel_.measure,
                            [&] { render_job(*scene_.kernel, camera_, settings, job, worker.sums, worker.counters); });
            worker.measured(RenderStage::film, kernel_.measure,
                            [&] { add_probes_to_words(worker, &probes_[block.begin()], film_, words); });
        };
        arena_.execute([&] {
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, probes_.size(), probes_per_job(samples)), render,
                              tbb::simple_partitioner());
        });
    }

    /// Adds what the light paths of a pass bring to `words`, the sums of a whole image, and traces them unless begin()
    /// did. Asks stop() before each task.
    template <class Stop>
    void add_light(SampleRange range, std::uint32_t* words, const Stop& stop)
    {
        if (kernel_.light_paths == 0) return;
        SplatAdder adder(film_, crop_, words);
        const auto add = [&](Worker& worker) {
            worker.measured(RenderStage::film, kernel_.measure,
                            [&] { worker.dropped += adder.add(worker.light.splats); });
            worker.light.splats.clear();
        };
        if (!gathers_) return trace_light(range, kernel_, &Worker::light, add, stop);
        for (Worker& worker : workers_) add(worker);
    }

    /// Records a pass whose sums are in the film; returns the total costs so far.
    RenderCosts finish(SampleRange range)
    {
        film_.add_range(range);
        RenderCosts costs;
        costs.seconds[std::size_t(RenderStage::learn)] = learning_s_;
        for (Worker& worker : workers_) {
            costs += worker.counters.costs;
            film_.dropped += worker.dropped;
            if (worker.dropped > 0 && !film_.invalid_sample) film_.invalid_sample = worker.invalid_sample;
            worker.dropped = 0;
        }
        return costs;
    }

    /// Calls body(first, last) over ranges of indices below `count`, on the job's threads.
    template <class Body>
    void for_ranges(std::size_t count, const Body& body)
    {
        arena_.execute([&] {
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 16),
                              [&](const auto& block) { body(block.begin(), block.end()); });
        });
    }

private:
    /// Traces the light paths of a pass, which append to a worker's results. Calls take(worker) after each task; asks
    /// stop() before each.
    template <class Take, class Stop>
    void trace_light(SampleRange range, const KernelSettings& settings, LightPathResults Worker::* results,
                     const Take& take, const Stop& stop)
    {
        const std::uint64_t tasks = (settings.light_paths + light_paths_per_job - 1) / light_paths_per_job;
        const auto trace = [&](const tbb::blocked_range<std::uint64_t>& block) {
            Worker& worker = workers_.local();
            (worker.*results).records_photons = gathers_;
            for (std::uint64_t i = block.begin(); i != block.end() && !stop(); ++i) {
                const std::uint32_t first = std::uint32_t(i % tasks) * light_paths_per_job;
                const LightPathJob job{std::uint32_t(range.first + i / tasks), first,
                                       std::min(light_paths_per_job, settings.light_paths - first)};
                worker.measured(RenderStage::camera, settings.measure, [&] {
                    trace_light_paths(*scene_.kernel, camera_, settings, job, worker.*results, worker.counters);
                });
                take(worker);
            }
        };
        arena_.execute([&] {
            tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, tasks * (range.second - range.first), 1), trace,
                              tbb::simple_partitioner());
        });
    }

    /// Traces the light paths of a pass, keeping their splats, and maps their photons.
    template <class Stop>
    CausticMap map_caustics(SampleRange range, const KernelSettings& settings, LightPathResults Worker::* results,
                            const Stop& stop)
    {
        trace_light(range, settings, results, [](Worker&) {}, stop);
        std::vector<CausticPhoton> photons;
        for (Worker& worker : workers_) {
            std::vector<CausticPhoton>& own = (worker.*results).photons;
            photons.insert(photons.end(), own.begin(), own.end());
            own.clear();
        }
        CausticMap map;
        arena_.execute([&] {
            map = make_caustic_map(std::move(photons), std::uint32_t(range.first),
                                   std::uint32_t(range.second - range.first), caustic_radius_);
        });
        return map;
    }

    KernelSettings probe_settings() const
    {
        KernelSettings settings = kernel_;
        settings.seed = probe_seed(kernel_.seed);
        settings.aovs = {};
        settings.film_words = std::size_t(other_words);
        if (gathers_) settings.caustics = &probe_caustics_;
        return settings;
    }

    /// Returns the number of probes per task: enough samples to fill the kernel's pool, and a task for each thread.
    std::size_t probes_per_job(std::uint32_t samples) const
    {
        const std::size_t most = std::max<std::size_t>(samples_per_job / samples, 1);
        return std::clamp<std::size_t>(probes_.size() / std::size_t(4 * arena_.threads()), 1, most);
    }

    const Scene::Data& scene_;
    Film::Data& film_;
    KernelSettings kernel_;
    const CameraRecord& camera_;
    Crop crop_;
    std::vector<Probe> probes_;
    std::vector<std::uint32_t> seen_pixels_;  ///< KernelSettings::seen_pixels
    ThreadArena arena_;
    Workers workers_;
    double learning_s_ = 0;  ///< learning time, summed over threads
    bool gathers_ = false;   ///< camera paths gather photons of caustics
    float caustic_radius_ = 0;
    CausticMap caustics_, probe_caustics_;  ///< photons of the pass, if gathers_
};

/// Allocates the sums of a pass beside those of the film; returns false if memory is short.
bool make_pass_words(Film::Data& data, bool is_cropped)
{
    // Pixels outside a crop must be copied too.
    if (data.pass_words.size() == data.words.size() && !is_cropped) return true;
    // Leaves memory for later copies of the film and for images.
    const std::uint64_t bytes = data.words.size() * sizeof(std::uint32_t);
    if (data.pass_words.empty() && 4 * bytes > available_memory_bytes()) return false;
    try {
        data.pass_words = data.words;
    } catch (const std::bad_alloc&) {
        return false;
    }
    return true;
}

/// Renders a pass into the film. Returns false if `cancel` became true and the pass was discarded; the film is then
/// unchanged. Short passes are always completed.
bool render_into(Film& film, const RenderJob& job, Passes& passes, SampleRange range, const std::atomic<bool>* cancel)
{
    Film::Data& data = film.data();
    // A cancelled first pass can be cleared from the film. Long later passes accumulate in separate words, which
    // replace the film's at the end.
    const bool is_first = data.samples.empty();
    const bool is_long = cancel && !is_first && data.sample_s.value_or(longest_pass_s) >= longest_pass_s;
    const bool is_apart = is_long && make_pass_words(data, job.settings().crop.has_value());
    std::uint32_t* const sums = is_apart ? data.pass_words.data() : data.words.data();
    const auto words = std::size_t(data.layout.words);
    std::atomic<bool> dropped = false;
    const auto stop = [&] {
        if (cancel && (is_first || is_apart) && cancel->load(std::memory_order_relaxed))
            dropped.store(true, std::memory_order_relaxed);
        return dropped.load(std::memory_order_relaxed);
    };
    passes.begin(range, stop);
    passes.render(
        range,
        [&](const Worker& worker) {
            for (std::uint32_t i = 0; is_apart && i < worker.pixels.size(); ++i)
                std::copy_n(pixel_words(worker, i, data, data.words.data()), words, pixel_words(worker, i, data, sums));
            add_to_words(worker, data, sums);
        },
        stop);
    passes.render_probes(range, sums, stop);
    passes.add_light(range, sums, stop);
    if (dropped) {
        if (is_first) film.reset(job);
        return false;
    }
    if (is_apart) std::swap(data.words, data.pass_words);
    return true;
}

}  // namespace

bool render(const RenderJob& job, SampleRange range, Film& film, const std::atomic<bool>* cancel,
            const std::function<void(const Progress&, const Film&)>& on_pass)
try {
    check_range(range);
    Film::Data& data = film.data();
    Passes passes(job, data, cancel);
    check_new(range, film);
    Progress progress;
    progress.samples_total = passes.pixels() * (range.second - range.first);
    std::uint64_t next = range.first, pass = std::max<std::uint64_t>(1, 2000000 / passes.pixels());
    while (next < range.second) {
        if (cancel && *cancel) return false;
        const auto start = std::chrono::steady_clock::now();
        const std::uint64_t end = std::min(range.second, next + std::min(pass, passes.max_samples()));
        if (!render_into(film, job, passes, {next, end}, cancel)) return false;
        progress.costs = passes.finish({next, end});
        progress.samples_done += passes.pixels() * (end - next);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        data.sample_s = seconds / double(end - next);
        pass = std::max<std::uint64_t>(
            1, std::uint64_t(
                   std::min(pass_s / std::max(*data.sample_s, 1e-4 / double(end - next)), 8.0 * double(end - next))));
        next = end;
        if (on_pass) on_pass(progress, film);
    }
    return true;
} catch (const Cancelled&) {
    return false;
}

bool render_pass(const RenderJob& job, SampleRange range, Film& film, const std::atomic<bool>& cancel)
try {
    check_range(range);
    if (range.first >= range.second || range.second - range.first > max_pass_samples)
        throw Error("", "", fmt::format("a pass must have 1 to {} samples", max_pass_samples));
    Film::Data& data = film.data();
    Passes passes(job, data, &cancel);
    check_new(range, film);
    // A cancelled first pass can be cleared from the film. Later passes accumulate in separate words. Each pixel is
    // written once, so leftovers of an earlier pass need no clearing.
    const bool is_first = data.samples.empty();
    if (!is_first) data.pass_words.resize(data.words.size());
    std::uint32_t* const sums = is_first ? data.words.data() : data.pass_words.data();
    const std::size_t words = std::size_t(data.layout.words);
    const auto take = [&](const Worker& worker) {
        for (std::uint32_t i = 0; !is_first && i < worker.pixels.size(); ++i) {
            std::uint32_t* pixel = pixel_words(worker, i, data, sums);
            std::fill_n(pixel, words, 0u);
            if (data.layout.ids >= 0) pixel[data.layout.ids] = 0xffffffffu;
        }
        add_to_words(worker, data, sums);
    };
    std::atomic<bool> stopped = false;
    const auto stop = [&] {
        if (cancel.load(std::memory_order_relaxed)) stopped.store(true, std::memory_order_relaxed);
        return stopped.load(std::memory_order_relaxed);
    };
    passes.begin(range, stop);
    passes.render(range, take, stop);
    passes.render_probes(range, sums, stop);
    passes.add_light(range, sums, stop);
    if (stopped) {
        if (is_first) film.reset(job);
        return false;
    }
    if (is_first) {
        passes.finish(range);
        return true;
    }
    const RenderSettings& settings = job.settings();
    const Crop crop = settings.rendered_pixels();
    passes.for_ranges(std::size_t(crop.y1 - crop.y0), [&](std::size_t first, std::size_t last) {
        for (std::size_t row = first; row < last; ++row) {
            const std::size_t begin = (std::size_t(crop.y0) + row) * std::size_t(data.width);
            for (std::size_t i = begin + std::size_t(crop.x0); i < begin + std::size_t(crop.x1); ++i)
                data.add_pixel(i, &data.pass_words[i * words]);
        }
    });
    passes.finish(range);
    return true;
} catch (const Cancelled&) {
    return false;
}

std::optional<LightTracingTrial> try_light_tracing(const RenderJob& job, const std::atomic<bool>* cancel,
                                                   TrialEffort effort)
try {
    const RenderSettings& settings = job.settings();
    const Scene::Data& scene = job.scene().data();
    if (!settings.light_sampling || scene.tables->lights.empty()) return LightTracingTrial{};
    const Crop crop = settings.rendered_pixels();
    const double rendered =
        double(crop.x1 - crop.x0) * (crop.y1 - crop.y0) / (double(settings.width) * settings.height);
    ThreadArena arena(settings.threads);
    LightTracingTrial trial;
    arena.execute([&] {
        trial = run_light_trial(*scene.kernel, *scene.tables, job.data().camera_record,
                                kernel_settings(settings, FilmLayout({}, false)), rendered, effort, cancel);
    });
    return trial;
} catch (const Cancelled&) {
    return {};
}

double light_of_photons(const RenderJob& job, const std::atomic<bool>* cancel)
{
    const RenderSettings& settings = job.settings();
    const Scene::Data& scene = job.scene().data();
    if (!settings.light_sampling || settings.light_paths == 0 || scene.tables->lights.empty()) return 0;
    ThreadArena arena(settings.threads);
    double fraction = 0;
    arena.execute([&] {
        fraction =
            run_photon_trial(*scene.kernel, job.data().camera_record, kernel_settings(settings, FilmLayout({}, false)),
                             scene.tables->ball_radius, cancel);
    });
    return fraction;
}

Color render_sample(const RenderJob& job, int x, int y, std::uint64_t sample_index)
{
    const RenderSettings& settings = job.settings();
    check_range({sample_index, sample_index + 1});
    if (x < 0 || y < 0 || x >= settings.width || y >= settings.height)
        throw Error("", "",
                    fmt::format("there is no pixel {},{} in an image of {}x{}", x, y, settings.width, settings.height));
    KernelSettings kernel = kernel_settings(settings, FilmLayout({}, false));
    if (job.scene().data().tables->lights.empty()) kernel.light_paths = 0;
    kernel.light_targets = light_targets_of(job, kernel, nullptr);
    kernel.guiding = guiding_of(job, kernel, nullptr);
    CausticMap caustics;
    if (settings.gathers_caustics() && kernel.light_paths > 0) {
        const auto sample = std::uint32_t(sample_index);
        caustics = make_caustic_map(trace_photons(*job.scene().data().kernel, job.data().camera_record, kernel, sample),
                                    sample, 1, caustic_radius_of(job, kernel));
        kernel.caustics = &caustics;
    }
    const std::uint32_t pixel = std::uint32_t(y) << 16 | std::uint32_t(x);
    TileSums sums;
    sums.reset(1, kernel.film_words);
    sums.keep_values = true;
    KernelCounters counters;
    render_job(*job.scene().data().kernel, job.data().camera_record, kernel,
               {&pixel, 1, std::uint32_t(sample_index), 1}, sums, counters);
    const float* v = sums.value;
    return {v[0], v[1], v[2]};
}

}  // namespace fathom
