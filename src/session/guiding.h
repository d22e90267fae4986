#pragma once
#include <atomic>
#include <memory>

#include "kernel/kernel.h"

namespace fathom {

/// What learning throws when it is no longer wanted.
struct Cancelled {};

/// Learns where light comes from, by paths all over the picture, whatever will be rendered of it: always the same for a
/// scene, a camera and settings. To be called where the threads that may work are. nullptr: it would be of no use.
/// Throws Cancelled when `cancel` becomes true.
std::shared_ptr<const GuidingTables> learn_guiding(const KernelScene& scene, const CameraRecord& camera,
                                                   const KernelSettings& settings, const std::atomic<bool>* cancel);

}  // namespace fathom
