#pragma once
#include "compile/scene_data.h"

namespace fathom {

struct RenderJob::Data {
    Scene scene;
    Camera camera;  ///< in world space
    CameraRecord camera_record;
    FilmKey key;
};

}  // namespace fathom
