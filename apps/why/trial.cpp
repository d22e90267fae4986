// SPDX-License-Identifier: Apache-2.0
#include "why/trial.h"

#include <cmath>
#include <ctime>

#include "fathom/film.h"
#include "fathom/render.h"

namespace fathom::cli {

namespace {

/// Processor time of all threads, which other programs do not lengthen.
double processor_seconds()
{
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

double mean_of(const Film& film)
{
    const Image image = film.beauty(false);
    double sum = 0;
    for (const float value : image.layers.front().pixels) sum += double(value);
    return sum / double(image.layers.front().pixels.size());
}

/// Standard deviation of the logarithm of an estimated squared error.
double spread_of(const ImageError& e)
{
    constexpr double widths = 2 * 1.96;
    return e.low > 0 ? 2 * std::log(e.high / e.low) / widths : 1;
}

}  // namespace

std::optional<Trial> run_trial(const RenderJob& job, int samples, const std::atomic<bool>& cancel)
{
    RenderSettings settings = job.settings();
    settings.error_probes = true;
    settings.aovs.clear();
    const RenderJob own(job.scene(), job.camera(), settings);
    Film film(own);
    // The first sample includes learning, which a long render does once.
    if (!render(own, {0, 1}, film, &cancel)) return {};
    const double start = processor_seconds();
    if (!render(own, {1, std::uint64_t(samples) + 1}, film, &cancel)) return {};
    Trial trial;
    trial.seconds = processor_seconds() - start;
    trial.brightness = mean_of(film);
    const std::optional<ImageError> error = estimate_error(film);
    if (!error || !(error->error > 0) || !(trial.seconds > 0) || !(trial.brightness > 0)) return {};
    trial.error = *error;
    return trial;
}

Gain gain_of(const Trial& before, const Trial& after)
{
    const double ratio = before.error.error / after.error.error;
    Gain gain;
    gain.value = ratio * ratio * before.seconds / after.seconds;
    const double factor = std::exp(1.96 * std::hypot(spread_of(before.error), spread_of(after.error)));
    gain.low = gain.value / factor, gain.high = gain.value * factor;
    gain.is_reliable = before.error.is_reliable() && after.error.is_reliable();
    return gain;
}

}  // namespace fathom::cli
