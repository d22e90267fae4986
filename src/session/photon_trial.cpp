// SPDX-License-Identifier: Apache-2.0
#include "session/photon_trial.h"

#include <algorithm>

#include "session/caustic_map.h"
#include "session/trial_image.h"

namespace fathom {

namespace {

double total(const CameraStatistics& paths)
{
    double sum = 0;
    for (const PixelVariance& pixel : paths.pixels) sum += pixel.mean;
    return sum;
}

}  // namespace

double run_photon_trial(const KernelScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                        float ball_radius, const std::atomic<bool>* cancel)
{
    constexpr std::size_t sets = 1;
    TrialImage image(settings);
    std::vector<CausticPhoton> photons;
    for (std::uint32_t sample = 0; sample < set_samples; ++sample) {
        if (cancel && *cancel) return 0;
        const std::vector<CausticPhoton> more = trace_photons(scene, camera, image.settings, sample);
        photons.insert(photons.end(), more.begin(), more.end());
    }
    if (photons.empty()) return 0;
    const double without = total(trace_camera_paths(scene, camera, image, sets, cancel));
    const float radius = first_caustic_radius(photons, std::uint32_t(set_samples), 0.01f * ball_radius);
    const CausticMap map = make_caustic_map(std::move(photons), 0, std::uint32_t(set_samples), radius);
    image.settings.caustics = &map;
    const double with = total(trace_camera_paths(scene, camera, image, sets, cancel));
    if (!(with > 0) || (cancel && *cancel)) return 0;
    return std::clamp((with - without) / with, 0., 1.);
}

}  // namespace fathom
