#pragma once
#include <memory>
#include <string>

#include "fathom/render.h"
#include "kernel/kernel.h"

namespace fathom {

struct Scene::Data {
    SceneStatistics statistics;
    Camera camera;  ///< that it was compiled for, in world space
    std::shared_ptr<const SceneTables> tables;
    std::unique_ptr<KernelScene> kernel;
    std::uint64_t fingerprint = 0;  ///< of the tables, the camera left out

    CameraRecord camera_record(const Camera& seen_by, int width, int height) const;
    /// What two films must share to be merged: scene and camera.
    std::string key(const CameraRecord& seen_by) const;
};

}  // namespace fathom
