// SPDX-License-Identifier: Apache-2.0
#include "session/light_trial.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <tbb/parallel_for.h>

#include "film/film_data.h"
#include "session/guiding.h"
#include "session/variance_estimate.h"

namespace fathom {

namespace {

/// The trial's image has about this number of pixels.
constexpr double trial_pixels = 5000;
/// Sets of stratified samples with independent random numbers, and samples per set.
constexpr std::size_t trial_sets = 8, set_samples = 4;
constexpr std::size_t trial_samples = trial_sets * set_samples;
constexpr std::uint32_t trial_pixels_per_job = 512, trial_light_paths_per_job = 4096;
/// Numbers of light paths per pixel among which the trial chooses.
constexpr double choices[] = {0.25, 1, 4};
/// Measured cost of a ray of a light path, with its part of shading and splats, relative to one of a camera path.
/// Without a BVH rays cost little, so that the rest counts for more.
constexpr double light_ray_cost = 1.8, light_ray_cost_without_tree = 4;
/// Cost of a ray of the loop for quads alone, which does without the weights that light tracing needs.
constexpr double quad_ray_cost = 0.3;
/// Light tracing must promise this gain: the estimate is up to three times too high.
constexpr double least_gain = 2.5;
/// Fraction of the image's light, missing without light tracing, for which it is always used.
constexpr double max_missing = 1e-3;

/// Costs and pixels of the trial's image.
struct TrialImage {
    KernelSettings settings;
    std::vector<std::uint32_t> pixels;

    explicit TrialImage(const KernelSettings& of) : settings(of)
    {
        const double aspect = double(of.width) / of.height;
        settings.width = std::clamp(int(std::lround(std::sqrt(trial_pixels * aspect))), 1, of.width);
        settings.height = std::clamp(int(std::lround(trial_pixels / settings.width)), 1, of.height);
        settings.aovs = {};
        settings.film_words = std::size_t(FilmLayout({}, false).words);
        settings.guiding = nullptr;
        settings.measure = false;
        settings.light_paths = std::uint32_t(settings.width) * std::uint32_t(settings.height);
        for (int y = 0; y < settings.height; ++y)
            for (int x = 0; x < settings.width; ++x) pixels.push_back(std::uint32_t(y) << 16 | std::uint32_t(x));
    }
    std::size_t index(std::uint32_t pixel) const
    {
        return std::size_t(pixel >> 16) * std::size_t(settings.width) + (pixel & 0xffff);
    }
    KernelSettings salted(std::size_t set) const
    {
        KernelSettings s = settings;
        s.seed ^= 0x2545f491u + 0x9e3779b9u * std::uint32_t(set);
        return s;
    }
};

/// Mean over the channels.
double brightness(const float* value)
{
    return (double(value[0]) + double(value[1]) + double(value[2])) / 3;
}

/// Statistics of camera paths, by pixel: mean, and variance of a sample.
struct CameraStatistics {
    std::vector<PixelVariance> pixels;
    double rays = 0;  ///< per sample of the image
};

CameraStatistics trace_camera_paths(const KernelScene& scene, const CameraRecord& camera, const TrialImage& image,
                                    const std::atomic<bool>* cancel)
{
    const std::size_t count = image.pixels.size(), jobs = (count + trial_pixels_per_job - 1) / trial_pixels_per_job;
    std::vector<std::vector<float>> means(trial_sets, std::vector<float>(count));
    std::vector<double> rays(trial_sets * jobs);
    tbb::parallel_for(std::size_t(0), trial_sets * jobs, [&](std::size_t i) {
        if (cancel && *cancel) return;
        const std::size_t set = i / jobs, first = i % jobs * trial_pixels_per_job,
                          size = std::min<std::size_t>(trial_pixels_per_job, count - first);
        TileSums sums;
        sums.reset(size, image.settings.film_words);
        KernelCounters counters;
        render_job(scene, camera, image.salted(set),
                   {&image.pixels[first], std::uint32_t(size), 0, std::uint32_t(set_samples)}, sums, counters);
        std::vector<std::uint32_t> words(image.settings.film_words);
        std::vector<double> slow(size);
        for (const TileSums::Slow& s : sums.slow()) slow[s.pixel] += brightness(s.value);
        for (std::size_t k = 0; k < size; ++k) {
            std::fill(words.begin(), words.end(), 0u);
            sums.add_to(std::uint32_t(k), words.data(), 0, -1);
            double sum = slow[k];
            for (int c = 0; c < 3; ++c) sum += ExactSum::value(radiance_sum(words.data(), c)) / 3;
            means[set][first + k] = float(sum / double(set_samples));
        }
        rays[i] = double(counters.costs.all_rays());
    });
    CameraStatistics result{pixel_variances(means, 1), 0};
    for (PixelVariance& p : result.pixels) p.variance *= double(set_samples);
    for (const double r : rays) result.rays += r / double(trial_samples);
    return result;
}

/// First and second moments of what path tracing finds.
struct Moments {
    double first = 0, second = 0;

    void add(double value, double square) { first += value, second += square; }
    /// Variance per sample, from sums over all samples of the trial.
    double variance() const
    {
        const double n = double(trial_samples);
        return second / n - first / n * (first / n);
    }
};

/// Sums over the splats of a pixel. C is what a light path would bring without a weight.
struct SplatSums {
    double found = 0;    ///< what light paths bring, weighted
    double missing = 0;  ///< of paths that path tracing cannot find
    Moments alone;       ///< of path tracing alone for these paths: C, and C^2 (light density / path density)
    Moments left[std::size(choices)];       ///< of path tracing beside light tracing
    double light[std::size(choices)] = {};  ///< second moment of light tracing

    void add(const LightSplat& splat)
    {
        const double value = brightness(splat.value), ratio = double(splat.path_ratio), all = value * (1 + ratio);
        found += value;
        const double square = all * all, by_path = ratio > 0 ? square / std::sqrt(ratio) : 0;
        if (ratio > 0)
            alone.add(all, by_path);
        else
            missing += value;
        for (std::size_t i = 0; i < std::size(choices); ++i) {
            const double now = ratio / (choices[i] * choices[i]), weight = 1 / (1 + now), rest = 1 - weight;
            left[i].add(all * rest, by_path * rest * rest);
            light[i] += square * weight * weight / choices[i];
        }
    }
};

struct LightStatistics {
    std::vector<SplatSums> pixels;
    double rays = 0;  ///< per sample of the image
};

LightStatistics trace_light(const KernelScene& scene, const CameraRecord& camera, const TrialImage& image,
                            const std::atomic<bool>* cancel)
{
    const std::uint32_t paths = image.settings.light_paths,
                        jobs = (paths + trial_light_paths_per_job - 1) / trial_light_paths_per_job;
    std::vector<std::vector<LightSplat>> splats(trial_samples * jobs);
    std::vector<double> rays(splats.size());
    tbb::parallel_for(std::size_t(0), splats.size(), [&](std::size_t i) {
        if (cancel && *cancel) return;
        const std::uint32_t first = std::uint32_t(i) % jobs * trial_light_paths_per_job;
        KernelCounters counters;
        trace_light_paths(scene, camera, image.salted(trial_sets),
                          {std::uint32_t(i) / jobs, first, std::min(trial_light_paths_per_job, paths - first)},
                          splats[i], counters);
        rays[i] = double(counters.costs.all_rays());
    });
    LightStatistics result{std::vector<SplatSums>(image.pixels.size()), 0};
    for (const std::vector<LightSplat>& list : splats)
        for (const LightSplat& splat : list)
            if (std::isfinite(brightness(splat.value))) result.pixels[image.index(splat.pixel)].add(splat);
    for (const double r : rays) result.rays += r / double(trial_samples);
    return result;
}

/// Mean over the pixels of variance(camera, light) relative to the squared brightness.
template <class Variance>
double relative_noise(const CameraStatistics& camera, const LightStatistics& light, const std::vector<double>& squares,
                      const Variance& variance)
{
    std::vector<double> noise(squares.size());
    for (std::size_t i = 0; i < noise.size(); ++i)
        noise[i] = std::max(variance(camera.pixels[i], light.pixels[i]), 0.0) / squares[i];
    return mean_without_outliers(std::move(noise));
}

}  // namespace

LightTracingTrial run_light_trial(const KernelScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                                  double rendered, const std::atomic<bool>* cancel)
{
    const TrialImage image(settings);
    const CameraStatistics paths = trace_camera_paths(scene, camera, image, cancel);
    const LightStatistics light = trace_light(scene, camera, image, cancel);
    if (cancel && *cancel) throw Cancelled();
    double total = 0, missing = 0;
    std::vector<PixelVariance> bright = paths.pixels;
    for (std::size_t i = 0; i < bright.size(); ++i) {
        bright[i].mean += light.pixels[i].found / double(trial_samples);
        total += bright[i].mean, missing += light.pixels[i].missing / double(trial_samples);
    }
    LightTracingTrial trial;
    if (!(total > 0)) return trial;
    trial.missing_light = missing / total;
    const std::vector<double> squares = squared_brightness(bright);
    constexpr std::size_t traced = 1;  // the choice that the trial's image was rendered with
    static_assert(choices[traced] == 1);
    const double ray_cost = scene.has_quad_loop() ? quad_ray_cost : 1,
                 light_cost = scene.has_tree() ? light_ray_cost : light_ray_cost_without_tree;
    const double alone = relative_noise(paths, light, squares, [&](const PixelVariance& p, const SplatSums& s) {
        return p.variance + s.alone.variance() - s.left[traced].variance();
    });
    for (std::size_t k = 0; k < std::size(choices); ++k) {
        const double both = relative_noise(paths, light, squares, [&](const PixelVariance& p, const SplatSums& s) {
            return p.variance + s.left[k].variance() - s.left[traced].variance() + s.light[k] / double(trial_samples);
        });
        const double cost =
            (paths.rays * rendered + choices[k] * light_cost * light.rays) / (paths.rays * rendered * ray_cost);
        const double gain = alone / std::max(both * cost, 1e-30);
        if (trial.light_paths > 0 && gain <= trial.gain) continue;
        trial.gain = gain, trial.light_paths = choices[k];
    }
    if (trial.gain < least_gain && trial.missing_light < max_missing) trial = {0, 1, trial.missing_light};
    return trial;
}

}  // namespace fathom
