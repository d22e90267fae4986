// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <memory>

#include "kernel/kernel.h"

namespace fathom {

/// Thrown by train_guiding when it is cancelled.
struct Cancelled {};

/// Learns the guiding distributions from paths over the whole image, even if a crop will be rendered: the result
/// depends on scene, camera and settings only. Runs in the caller's task arena. Returns nullptr if guiding would not
/// reduce noise at equal time. Throws Cancelled when `cancel` becomes true.
std::shared_ptr<const GuidingTables> train_guiding(const KernelScene& scene, const CameraRecord& camera,
                                                   const KernelSettings& settings, const std::atomic<bool>* cancel);

}  // namespace fathom
