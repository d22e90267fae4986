// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Small renders of a whole image that decide how it is rendered. What they bring depends on scene, camera and settings
/// only.
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernel/kernel.h"
#include "session/variance_estimate.h"

namespace fathom {

/// An image of about 5,000 pixels with the aspect of the image that will be rendered.
struct TrialImage {
    KernelSettings settings;
    std::vector<std::uint32_t> pixels;

    explicit TrialImage(const KernelSettings& of);
    std::size_t index(std::uint32_t pixel) const
    {
        return std::size_t(pixel >> 16) * std::size_t(settings.width) + (pixel & 0xffff);
    }
    /// The settings with independent random numbers for each set.
    KernelSettings salted(std::size_t set) const;
};

/// Samples per set of stratified samples.
inline constexpr std::size_t set_samples = 4;

/// Mean over the channels.
double brightness(const float* value);

/// Statistics of camera paths, by pixel: mean, and variance of a sample.
struct CameraStatistics {
    std::vector<PixelVariance> pixels;
    double rays = 0;  ///< per sample of the image
};
/// Traces `sets` sets of camera paths. Runs in the caller's task arena.
CameraStatistics trace_camera_paths(const KernelScene& scene, const CameraRecord& camera, const TrialImage& image,
                                    std::size_t sets, const std::atomic<bool>* cancel);

/// Light paths, as many as pixels for each sample.
struct LightSamples {
    std::vector<LightPathResults> jobs;  ///< those of a sample follow one another
    double rays = 0;                     ///< per sample of the image
    std::size_t jobs_per_sample = 1;
};
/// Traces the light paths of `samples` samples with the random numbers of a set. wanted: an empty result that tells
/// what is recorded. Runs in the caller's task arena.
LightSamples trace_light_samples(const KernelScene& scene, const CameraRecord& camera, const TrialImage& image,
                                 std::size_t set, std::size_t samples, const LightPathResults& wanted,
                                 const std::atomic<bool>* cancel);

}  // namespace fathom
