// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <mutex>

#include "compile/scene_data.h"
#include "guiding/records.h"
#include "lights/targets.h"

namespace fathom {

/// Guiding tables of a job, learned when its first samples are rendered.
struct TrainedGuiding {
    std::once_flag once;
    std::shared_ptr<const GuidingTables> tables;
};

/// Targets of the light paths of a job, learned when its first samples are rendered.
struct LearnedLightTargets {
    std::once_flag once;
    std::unique_ptr<const LightTargets> targets;
};

/// Radius of caustic photons of a job, learned when its first samples are rendered.
struct LearnedCausticRadius {
    std::once_flag once;
    float radius = 0;
};

/// A job: the scene, its camera and settings (in the key), and the guiding tables once they are learned.
struct RenderJob::Data {
    Scene scene;
    Camera camera;  ///< in world space
    CameraRecord camera_record;
    FilmKey key;
    std::unique_ptr<TrainedGuiding> guiding;               ///< null if the settings don't ask for guiding
    std::unique_ptr<LearnedLightTargets> light_targets;    ///< null without light paths
    std::unique_ptr<LearnedCausticRadius> caustic_radius;  ///< null if caustics are not gathered
};

}  // namespace fathom
