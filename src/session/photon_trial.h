// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>

#include "kernel/kernel.h"

namespace fathom {

/// Estimates from a small image which fraction of the light only photons show (light_of_photons()). Runs in the
/// caller's task arena.
double run_photon_trial(const KernelScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                        float ball_radius, const std::atomic<bool>* cancel);

}  // namespace fathom
