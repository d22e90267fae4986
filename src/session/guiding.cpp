// SPDX-License-Identifier: Apache-2.0
#include "session/guiding.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "film/film_data.h"
#include "session/efficiency_roulette.h"
#include "session/guiding_shares.h"
#include "session/guiding_tables.h"
#include "session/variance_estimate.h"

namespace fathom {

namespace {

/// Limits on the number of training paths, which is half the number of pixels. Fewer paths miss much light in
/// interiors; a million take some 100 MB temporarily.
constexpr std::size_t min_paths = std::size_t(1) << 18, max_paths = std::size_t(1) << 20;
/// Each training pixel has several sets of stratified samples with independent random numbers, from which the remaining
/// noise is estimated. Small images have more sets, and then more samples.
constexpr std::size_t min_samples = 8, min_sets = 2, max_sets = 256;
constexpr std::size_t paths_per_job = 4096;
/// The trial of guided paths uses every n-th training pixel.
constexpr std::size_t trial_step = 2;
/// Measured cost of guiding for a vertex, relative to an unguided vertex. The absolute cost is about 14 ns in both
/// cases, but vertices are cheaper without a BVH.
constexpr double guidance_cost = 0.08, guidance_cost_without_tree = 0.22;
/// Minimum estimated gain for which guiding is used. The estimate is a tenth too low in most scenes
/// (docs/measurements/guiding.md), so this is close to no loss.
constexpr double min_gain = 0.95;
/// If next event estimation would be done at more than this fraction of vertices, it is done at all of them, because
/// the decision takes time, too.
constexpr double max_light_samples = 0.5;

/// Selects about `count` pixels (or all) on a regular grid over the image.
std::vector<std::uint32_t> spread_pixels(int width, int height, std::size_t count)
{
    const double step = std::sqrt(std::max(1.0, double(width) * height / double(count)));
    std::vector<std::uint32_t> pixels;
    for (double y = step / 2; y < height; y += step)
        for (double x = step / 2; x < width; x += step) pixels.push_back(std::uint32_t(y) << 16 | std::uint32_t(x));
    return pixels;
}

/// Records and costs of the paths of one training pass.
struct Pass {
    std::vector<GuidingRecords> parts;   ///< records of the jobs of the first set, followed by those of each other set
    std::vector<PixelVariance> spreads;  ///< indexed by pixel
    std::size_t samples = 0;             ///< number of paths per pixel and set
    std::uint64_t paths = 0;
    std::uint64_t vertices = 0, light_samples = 0;

    void append_to(std::vector<const GuidingRecords*>& list) const
    {
        for (const GuidingRecords& part : parts) list.push_back(&part);
    }
    /// Cost in units of unguided vertices. guidance: relative cost of guiding per vertex.
    double cost(double guidance) const
    {
        return (1 - nee_cost + guidance) * double(vertices) + nee_cost * double(light_samples);
    }
};

/// Pixels and samples that a training pass traces.
struct PassPlan {
    std::vector<std::uint32_t> pixels;
    std::size_t sets, samples;  ///< independent sets of samples, and samples per pixel and set
    std::uint32_t salt;         ///< makes random numbers independent of other passes and of the final image's
};

/// Traces a training pass.
Pass trace(const KernelScene& scene, const CameraRecord& camera, KernelSettings settings, const PassPlan& plan,
           const std::atomic<bool>* cancel)
{
    const auto& [pixels, sets, samples, salt] = plan;
    const auto is_cancelled = [&] { return cancel && cancel->load(std::memory_order_relaxed); };
    settings.measure = false;
    const FilmLayout layout({}, false);
    settings.aovs = layout;
    settings.film_words = std::size_t(layout.words);
    const std::size_t step = std::clamp<std::size_t>(paths_per_job / samples, 1, max_job_pixels);
    Pass all;
    all.samples = samples;
    all.paths = pixels.size() * sets * samples;
    const std::size_t parts = (pixels.size() + step - 1) / step;
    all.parts.resize(sets * parts);
    std::vector<RenderCosts> costs(all.parts.size());
    tbb::parallel_for(std::size_t(0), all.parts.size(), [&](std::size_t part) {
        if (is_cancelled()) return;
        const std::size_t first = part % parts * step, count = std::min(step, pixels.size() - first);
        KernelSettings salted = settings;
        salted.seed ^= salt + 0x9e3779b9u * std::uint32_t(part / parts);
        TileSums sums;
        sums.reset(count, settings.film_words);
        KernelCounters counters;
        render_job(scene, camera, salted,
                   {&pixels[first], std::uint32_t(count), 0, std::uint32_t(samples), &all.parts[part]}, sums, counters);
        costs[part] = counters.costs;
    });
    if (is_cancelled()) throw Cancelled();
    std::vector<std::vector<float>> radiance(sets);
    for (std::size_t part = 0; part < all.parts.size(); ++part) {
        const std::vector<float>& some = all.parts[part].radiance;
        radiance[part / parts].insert(radiance[part / parts].end(), some.begin(), some.end());
    }
    all.spreads = pixel_variances(radiance, samples);
    for (const RenderCosts& c : costs) all.vertices += c.vertices, all.light_samples += c.light_samples;
    return all;
}

/// Mean relative variance of paths, that is, of their variance over squared brightness.
double mean_relative_variance(const std::vector<PixelVariance>& spreads, const std::vector<double>& squares)
{
    std::vector<double> noise(spreads.size());
    for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = squares[i] > 0 ? spreads[i].variance / squares[i] : 0;
    return mean_without_outliers(std::move(noise));
}

/// Combines a pass with the squared brightness of its pixels, to which the result is relative.
PathStatistics path_statistics(const Pass& pass, const std::vector<double>& squares)
{
    PathStatistics met;
    std::size_t pixel = 0;
    for (const GuidingRecords& part : pass.parts) {
        met.parts.push_back({&part, &squares[pixel]});
        pixel = (pixel + part.counts.size() / pass.samples) % squares.size();
    }
    met.samples = pass.samples;
    met.vertices = double(pass.vertices) / double(pass.paths);
    met.variance = mean_relative_variance(pass.spreads, squares);
    return met;
}

/// Returns every step-th element.
template <class T>
std::vector<T> every_nth(const std::vector<T>& all, std::size_t step)
{
    std::vector<T> some;
    for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
    return some;
}

/// Sets the shares of tables by cross-validation: histograms of one half of the plain paths are tried on the other
/// half. The histograms, which are those of all `parts`, stay as they are.
void choose_shares(const PathStatistics& plain, const std::vector<const GuidingRecords*>& parts, GuidingTables& tables)
{
    const std::size_t half = plain.parts.size() / 2;
    PathStatistics others = plain;
    others.parts.erase(others.parts.begin(), others.parts.begin() + std::ptrdiff_t(half));
    LargeVector<float> of_all = tables.histograms;
    learn_histograms({parts.begin(), parts.begin() + std::ptrdiff_t(half)}, tables);
    set_shares(others, tables);
    tables.histograms = std::move(of_all);
}

/// Plain paths that were learned from, and guided paths through every trial_step-th of their pixels.
struct Trial {
    Pass plain, guided;
    std::vector<double> squares;  ///< squared brightness of the plain paths' pixels
    bool samples_all = false;     ///< whether guided paths sample a light at every vertex
};

/// Ratio of variance times cost without and with guiding, over the trial's pixels. guidance: as in Pass::cost.
double gain(const Trial& trial, double guidance)
{
    const Pass &plain = trial.plain, &guided = trial.guided;
    const std::vector<PixelVariance>& after = guided.spreads;
    const std::vector<PixelVariance> before = every_nth(plain.spreads, trial_step);
    std::vector<PixelVariance> both(after.size());
    for (std::size_t i = 0; i < after.size(); ++i) both[i].mean = 0.5 * (before[i].mean + after[i].mean);
    const std::vector<double> squares = squared_brightness(both);
    const double share = double(guided.spreads.size()) / double(plain.spreads.size());
    return mean_relative_variance(before, squares) / std::max(mean_relative_variance(after, squares), 1e-30) * share *
           plain.cost(0) / std::max(guided.cost(guidance), 1.0);
}

/// Tables for the trial, from its plain paths; nullptr if they found too little light.
std::shared_ptr<GuidingTables> tables_to_try(const Trial& trial)
{
    std::vector<const GuidingRecords*> parts;
    trial.plain.append_to(parts);
    std::shared_ptr<GuidingTables> tables = make_guiding(parts);
    if (!tables) return nullptr;
    const PathStatistics met = path_statistics(trial.plain, trial.squares);
    choose_shares(met, parts, *tables);
    if (trial.plain.light_samples > 0) set_nee_factors(met, *tables);
    set_survival_factors(met, *tables);
    return tables;
}

/// Tables for the image, from all paths of the trial.
std::shared_ptr<const GuidingTables> final_tables(const Trial& trial)
{
    std::vector<const GuidingRecords*> parts;
    trial.plain.append_to(parts);
    trial.guided.append_to(parts);
    const std::shared_ptr<GuidingTables> tables = make_guiding(parts);
    if (!tables) return nullptr;
    const PathStatistics met = path_statistics(trial.plain, trial.squares);
    choose_shares(met, parts, *tables);
    const bool samples_lights = trial.plain.light_samples > 0;
    if (samples_lights && !trial.samples_all) set_nee_factors(met, *tables);
    // All later paths are guided, so costs and contributions are those of the guided paths.
    const std::vector<double> tried_squares = every_nth(trial.squares, trial_step);
    PathStatistics met_by_all = path_statistics(trial.guided, tried_squares);
    met_by_all.parts.insert(met_by_all.parts.begin(), met.parts.begin(), met.parts.end());
    set_survival_factors(met_by_all, *tables);
    if (samples_lights) set_shadow_ray_factors(met_by_all, *tables);
    return tables;
}

}  // namespace

std::shared_ptr<const GuidingTables> train_guiding(const KernelScene& scene, const CameraRecord& camera,
                                                   const KernelSettings& settings, const std::atomic<bool>* cancel)
{
    const std::size_t picture = std::size_t(settings.width) * std::size_t(settings.height);
    const std::size_t paths = std::clamp(picture / 2, min_paths, max_paths);
    const std::vector<std::uint32_t> pixels =
        spread_pixels(settings.width, settings.height, paths / (min_sets * min_samples));
    const std::size_t sets = std::clamp(paths / (min_samples * pixels.size()), min_sets, max_sets);
    const std::size_t samples = std::max(min_samples, paths / (sets * pixels.size()));
    Trial trial;
    trial.plain = trace(scene, camera, settings, {pixels, sets, samples, 0x9e3779b9u}, cancel);
    trial.squares = squared_brightness(trial.plain.spreads);
    const std::shared_ptr<GuidingTables> first = tables_to_try(trial);
    if (!first) return nullptr;
    KernelSettings with_first = settings;
    with_first.guiding = first.get();
    const std::vector<std::uint32_t> tried = every_nth(pixels, trial_step);
    trial.guided = trace(scene, camera, with_first, {tried, sets, samples, 0x85ebca6bu}, cancel);
    trial.samples_all = double(trial.guided.light_samples) > max_light_samples * double(trial.guided.vertices);
    if (trial.samples_all) trial.guided.light_samples = trial.guided.vertices;
    if (gain(trial, scene.has_tree() ? guidance_cost : guidance_cost_without_tree) < min_gain) return nullptr;
    return final_tables(trial);
}

}  // namespace fathom
