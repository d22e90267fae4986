// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>

#include "fathom/render.h"
#include "kernel/kernel.h"
#include "lights/records.h"

namespace fathom {

/// Estimates from a small image whether light paths reduce the noise for the time that they take. Grittmann, Perard-
/// Gayot, Slusallek and Krivanek 2022, "Efficiency-Aware Multiple Importance Sampling for Bidirectional Rendering
/// Algorithms": the noise without light paths, and with other numbers of them, follows from the samples of one render.
/// Runs in the caller's task arena; the result depends on scene, camera and settings only.
///
/// settings  of the image that will be rendered
/// rendered  fraction of the image's pixels that will be rendered
///
/// Throws Cancelled when `cancel` becomes true.
LightTracingTrial run_light_trial(const KernelScene& scene, const LightTables& lights, const CameraRecord& camera,
                                  const KernelSettings& settings, double rendered, TrialEffort effort,
                                  const std::atomic<bool>* cancel);

}  // namespace fathom
