// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "fathom/load.h"
#include "options/arguments.h"
#include "options/dataset_options.h"

namespace fathom::cli {

/// Cameras around a model.
struct CameraRing {
    std::uint64_t count = 1;
    ViewPlacement placement = ViewPlacement::hemisphere;
    double azimuth_deg = 0, elevation_deg = 20;  ///< of the first camera of a ring
    std::uint32_t seed = 0;                      ///< turns all cameras about the vertical axis; 0: not
};
/// Cameras that look at the middle of `bounds` from equal distances, from which a sphere around the box fills the
/// image. `lens` gives the angle of view.
///
/// aspect  width / height of the image
std::vector<Camera> cameras_around(const Bounds& bounds, const CameraRing& ring, const Camera& lens, double aspect);

/// Cameras of a file, and the size of their images if the file says it.
struct CameraFile {
    std::vector<Camera> cameras;
    std::optional<Size> size;
};
/// Reads the cameras of a transforms.json, as NeRF's and nerfstudio's data sets have it: camera-to-world matrices with
/// OpenGL axes, in a world whose z axis points up.
///
/// size  of the images, if an option says it
///
/// Throws Error for what can't be rendered, such as lens distortion.
CameraFile read_camera_file(const std::filesystem::path& file, const std::optional<Size>& size);

/// Maps Fathom's world, where y is up, to that of Blender, NeRF and nerfstudio, where z is up.
Transform z_up_from_world();

}  // namespace fathom::cli
