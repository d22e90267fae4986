// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>

#include "fathom/render.h"
#include "kernel/kernel.h"

namespace fathom {

/// A compiled scene: tables, kernel and camera.
struct Scene::Data {
    CompileStatistics statistics;
    Camera camera;  ///< the camera that render space was made for, in world space
    std::shared_ptr<const SceneTables> tables;
    std::unique_ptr<KernelScene> kernel;
    std::uint64_t fingerprint = 0;  ///< fingerprint of the tables, without the camera

    /// The kernel's record of a camera (world space) for an image of the given size.
    CameraRecord camera_record(const Camera& seen_by, int width, int height) const;
    /// Scene and camera as a string, which films must share to be merged.
    std::string key(const CameraRecord& seen_by) const;
};

}  // namespace fathom
