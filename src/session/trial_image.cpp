// SPDX-License-Identifier: Apache-2.0
#include "session/trial_image.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "film/film_data.h"

namespace fathom {

namespace {

constexpr double trial_pixels = 5000;
constexpr std::uint32_t trial_pixels_per_job = 512, trial_light_paths_per_job = 4096;

}  // namespace

TrialImage::TrialImage(const KernelSettings& of) : settings(of)
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

KernelSettings TrialImage::salted(std::size_t set) const
{
    KernelSettings s = settings;
    s.seed ^= 0x2545f491u + 0x9e3779b9u * std::uint32_t(set);
    return s;
}

double brightness(const float* value)
{
    return (double(value[0]) + double(value[1]) + double(value[2])) / 3;
}

CameraStatistics trace_camera_paths(const KernelScene& scene, const CameraRecord& camera, const TrialImage& image,
                                    std::size_t sets, const std::atomic<bool>* cancel)
{
    const std::size_t count = image.pixels.size(), jobs = (count + trial_pixels_per_job - 1) / trial_pixels_per_job;
    std::vector<std::vector<float>> means(sets, std::vector<float>(count));
    std::vector<double> rays(sets * jobs);
    tbb::parallel_for(std::size_t(0), sets * jobs, [&](std::size_t i) {
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
    for (const double r : rays) result.rays += r / double(sets * set_samples);
    return result;
}

LightSamples trace_light_samples(const KernelScene& scene, const CameraRecord& camera, const TrialImage& image,
                                 std::size_t set, std::size_t samples, const LightPathResults& wanted,
                                 const std::atomic<bool>* cancel)
{
    const std::uint32_t paths = image.settings.light_paths,
                        jobs = (paths + trial_light_paths_per_job - 1) / trial_light_paths_per_job;
    LightSamples result;
    result.jobs_per_sample = jobs;
    result.jobs.resize(samples * jobs);
    std::vector<double> rays(result.jobs.size());
    tbb::parallel_for(std::size_t(0), result.jobs.size(), [&](std::size_t i) {
        if (cancel && *cancel) return;
        const std::uint32_t first = std::uint32_t(i) % jobs * trial_light_paths_per_job;
        KernelCounters counters;
        result.jobs[i] = wanted;
        trace_light_paths(scene, camera, image.salted(set),
                          {std::uint32_t(i) / jobs, first, std::min(trial_light_paths_per_job, paths - first)},
                          result.jobs[i], counters);
        rays[i] = double(counters.costs.all_rays());
    });
    for (const double r : rays) result.rays += r / double(samples);
    return result;
}

}  // namespace fathom
