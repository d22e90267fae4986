// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <optional>

#include "fathom/image_error.h"
#include "fathom/job.h"

namespace fathom::cli {

/// Noise and time of a small render.
struct Trial {
    ImageError error;
    double seconds = 0;     ///< processor time of the samples, without learning and trials that precede them
    double brightness = 0;  ///< mean of the image's channels
};

/// Renders `samples` samples per pixel, with probes for the estimated error. Nothing if the image is too small for an
/// estimate, is black, or `cancel` became true.
std::optional<Trial> run_trial(const RenderJob& job, int samples, const std::atomic<bool>& cancel);

/// How much less time a change needs for the same noise.
struct Gain {
    double value = 1;
    double low = 1, high = 1;  ///< interval of 95 % confidence by the errors of both renders
    bool is_reliable = true;   ///< whether both errors can be trusted
};
Gain gain_of(const Trial& before, const Trial& after);

}  // namespace fathom::cli
