// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <memory>

#include "kernel/kernel.h"
#include "lights/records.h"

namespace fathom {

/// Learns where light paths should be aimed, so that most of them bring what path tracing finds with much noise.
/// Grittmann, Perard-Gayot, Slusallek and Krivanek 2018, "Efficient Caustic Rendering with Lightweight Photon Mapping",
/// learn distributions over the directions from a light; spheres in the scene serve lights of all kinds and sizes at
/// once.
///
/// gathers: whether camera paths gather photons, which then count as light that paths bring.
///
/// Light paths that follow the lights' own emission are traced over the whole image, even if a crop will be rendered:
/// the result depends on scene, camera and settings only. Runs in the caller's task arena. Returns nullptr if it would
/// not help to aim. Throws Cancelled when `cancel` becomes true.
std::unique_ptr<const LightTargets> learn_light_targets(const KernelScene& scene, const LightTables& lights,
                                                        const CameraRecord& camera, const KernelSettings& settings,
                                                        bool gathers, const std::atomic<bool>* cancel);

}  // namespace fathom
