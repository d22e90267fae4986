// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "fathom/api.h"
#include "fathom/costs.h"
#include "fathom/film.h"
#include "fathom/job.h"
#include "fathom/scene.h"
#include "fathom/vector.h"

namespace fathom {

/// Progress of a call of render().
struct Progress {
    /// Samples rendered by this call so far and to be rendered by it, both summed over all pixels.
    std::uint64_t samples_done = 0, samples_total = 0;
    RenderCosts costs;  ///< Rays, vertices and times of this call so far.
};

/// Renders the samples [range.first, range.second) of every pixel and adds them to `film`.
///
/// A sample has the same value in every call, so splitting a range doesn't change the image. Rendering proceeds in
/// passes of about 0.4 seconds, each of which renders a few samples of all pixels.
///
/// job      What to render.
/// range    Sample indices below max_samples, none of which is in the film yet.
/// film     A film whose key equals job.key().
/// cancel   If not null and set to true by another thread, rendering stops soon. A pass with a single sample that takes
///          long is then dropped; for that the film temporarily needs twice its memory, if available.
/// on_pass  If not empty, called on the calling thread after each pass with the progress and the film so far.
///
/// Returns true if all samples were rendered; false if `cancel` became true: the film then contains the finished
/// passes, which Film::samples() lists. Throws Error if the film belongs to another job or the range exceeds
/// max_samples. It also throws Error if a sample is in the film already; the film must then be discarded.
FATHOM_API bool render(const RenderJob& job, SampleRange range, Film& film, const std::atomic<bool>* cancel = nullptr,
                       const std::function<void(const Progress&, const Film&)>& on_pass = {});

/// Renders the samples of `range`, 1 to 1024 of them, as a single pass that can be abandoned within milliseconds. It is
/// meant for interactive programs, such as a viewer whose camera moves.
///
/// Returns true if done, with the same bits as render(); false if `cancel` became true, which leaves the film
/// unchanged. If the film already has samples, it allocates as much memory again and keeps it. Throws Error, without
/// changing the film, if it belongs to another job, has some of the samples already, or the range is invalid.
FATHOM_API bool render_pass(const RenderJob& job, SampleRange range, Film& film, const std::atomic<bool>& cancel);

/// Result of try_light_tracing().
struct LightTracingTrial {
    double light_paths = 0;  ///< Recommended RenderSettings::light_paths; 0: light tracing does not pay.
    /// Efficiency with that number of light paths relative to path tracing alone: how much less time it takes to render
    /// with the same noise. The estimate is up to three times too high.
    double gain = 1;
    /// Fraction of the image's light that path tracing alone cannot find.
    double missing_light = 0;
};
/// How thorough a trial is.
enum class TrialEffort {
    quick,  ///< As long as some 80,000 samples. It finds large gains only, and does not aim light paths.
    full    ///< As long as some 500,000 samples.
};
/// Renders a small image with few samples to find out whether light tracing reduces the noise for the time that it
/// takes.
///
/// job     What would be rendered; its own number of light paths does not matter.
/// cancel  If not null and set to true by another thread, the trial stops soon.
/// effort  How thorough the trial is.
///
/// The result depends on scene, camera and settings only, so parts of an image agree on it. Returns nothing if `cancel`
/// became true.
FATHOM_API std::optional<LightTracingTrial> try_light_tracing(const RenderJob& job,
                                                              const std::atomic<bool>* cancel = nullptr,
                                                              TrialEffort effort = TrialEffort::full);

/// Estimates which fraction of the image's light reaches the camera only if photons are gathered
/// (RenderSettings::merge_caustics): caustics of lamps without size that are seen through glass or in mirrors. Renders
/// a small image twice, with 40,000 samples in all; the result depends on scene, camera and settings only.
///
/// job     What would be rendered, with light paths. Without them the result is 0.
/// cancel  If not null and set to true by another thread, the estimate stops soon; the result is then 0.
FATHOM_API double light_of_photons(const RenderJob& job, const std::atomic<bool>* cancel = nullptr);

/// Returns the linear Rec.709 radiance of one sample of pixel (x, y), which is the value that render() adds to a film.
/// It is meant for debugging. Throws Error if the pixel is not in the image or the index is not below max_samples.
FATHOM_API Color render_sample(const RenderJob& job, int x, int y, std::uint64_t sample_index);

/// Returns the number of lanes of the kernel in use: 32 (AVX-512), 16 (AVX2) or 1. This function and the next two throw
/// Error if there is no usable kernel library.
FATHOM_API int simd_width();
/// Returns the name of the instruction set of the kernel in use: "AVX-512", "AVX2" or "base".
FATHOM_API const char* simd_name();

/// The kernel library in use. It is selected once per process, when it is first needed: the best one that the processor
/// and the operating system support, or the one that the environment variable FATHOM_KERNEL names.
struct KernelChoice {
    std::string name;     ///< "avx512", "avx2" or "base"
    std::string reason;   ///< why it was selected
    std::string warning;  ///< for users, if this machine gets a kernel without AVX2 unrequested; otherwise empty
};
FATHOM_API KernelChoice kernel_choice();

}  // namespace fathom
