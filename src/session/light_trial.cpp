// SPDX-License-Identifier: Apache-2.0
#include "session/light_trial.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "session/guiding.h"
#include "session/light_targets.h"
#include "session/trial_image.h"

namespace fathom {

namespace {

/// Sets of stratified samples with independent random numbers, in trials of both efforts.
constexpr std::size_t quick_sets = 2, full_sets = 8;
/// Numbers of light paths per pixel among which the trial chooses.
constexpr double choices[] = {0.0625, 0.25, 1, 4};
/// Measured cost of a ray of a light path, with its part of shading and splats, relative to one of a camera path.
/// Without a BVH rays cost little, so that the rest counts for more.
constexpr double light_ray_cost = 1.8, light_ray_cost_without_tree = 2.5;
/// Cost of a ray of the loop for quads alone, which does without the weights that light tracing needs.
constexpr double quad_ray_cost = 0.3;
/// Light tracing must promise this gain: the estimate is up to three times too high, and that of a quick trial noisy.
constexpr double least_gain = 2.5, least_quick_gain = 5;
/// Fraction of the image's light, missing without light tracing, for which it is always used.
constexpr double max_missing = 1e-3;

/// First and second moments of what path tracing finds.
struct Moments {
    double first = 0, second = 0;

    void add(double value, double square) { first += value, second += square; }
    /// Variance per sample, from sums over n samples.
    double variance(double n) const { return second / n - first / n * (first / n); }
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
        // Roulette of connections divided the value by the probability to survive, which is also that of its square.
        const double survival = std::min(1 / (1 + ratio) / double(weight_of_sure_connection), 1.0);
        const double square = all * all * survival, by_path = ratio > 0 ? square / std::sqrt(ratio) : 0;
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
                            std::size_t sets, const std::atomic<bool>* cancel)
{
    const LightSamples samples = trace_light_samples(scene, camera, image, sets, sets * set_samples, {}, cancel);
    LightStatistics result{std::vector<SplatSums>(image.pixels.size()), samples.rays};
    for (const LightPathResults& job : samples.jobs)
        for (const LightSplat& splat : job.splats)
            if (std::isfinite(brightness(splat.value))) result.pixels[image.index(splat.pixel)].add(splat);
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

LightTracingTrial run_light_trial(const KernelScene& scene, const LightTables& lights, const CameraRecord& camera,
                                  const KernelSettings& settings, double rendered, TrialEffort effort,
                                  const std::atomic<bool>* cancel)
{
    const bool is_full = effort == TrialEffort::full;
    const std::size_t sets = is_full ? full_sets : quick_sets;
    const auto samples = double(sets * set_samples);
    std::unique_ptr<const LightTargets> targets;
    if (is_full) targets = learn_light_targets(scene, lights, camera, settings, false, cancel);
    TrialImage image(settings);
    image.settings.light_targets = targets.get();
    const CameraStatistics paths = trace_camera_paths(scene, camera, image, sets, cancel);
    const LightStatistics light = trace_light(scene, camera, image, sets, cancel);
    if (cancel && *cancel) throw Cancelled();
    double total = 0, missing = 0;
    std::vector<PixelVariance> bright = paths.pixels;
    for (std::size_t i = 0; i < bright.size(); ++i) {
        bright[i].mean += light.pixels[i].found / samples;
        total += bright[i].mean, missing += light.pixels[i].missing / samples;
    }
    LightTracingTrial trial;
    if (!(total > 0)) return trial;
    trial.missing_light = missing / total;
    const std::vector<double> squares = squared_brightness(bright);
    constexpr std::size_t traced = 2;  // the choice that the trial's image was rendered with
    static_assert(choices[traced] == 1);
    const double ray_cost = scene.has_quad_loop() ? quad_ray_cost : 1,
                 light_cost = scene.has_tree() ? light_ray_cost : light_ray_cost_without_tree;
    const double alone = relative_noise(paths, light, squares, [&](const PixelVariance& p, const SplatSums& s) {
        return p.variance + s.alone.variance(samples) - s.left[traced].variance(samples);
    });
    for (std::size_t k = 0; k < std::size(choices); ++k) {
        const double both = relative_noise(paths, light, squares, [&](const PixelVariance& p, const SplatSums& s) {
            return p.variance + s.left[k].variance(samples) - s.left[traced].variance(samples) + s.light[k] / samples;
        });
        const double cost =
            (paths.rays * rendered + choices[k] * light_cost * light.rays) / (paths.rays * rendered * ray_cost);
        const double gain = alone / std::max(both * cost, 1e-30);
        if (trial.light_paths > 0 && gain <= trial.gain) continue;
        trial.gain = gain, trial.light_paths = choices[k];
    }
    if (trial.gain < (is_full ? least_gain : least_quick_gain) && trial.missing_light < max_missing)
        trial = {0, 1, trial.missing_light};
    return trial;
}

}  // namespace fathom
