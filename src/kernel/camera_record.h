// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace fathom {

/// Camera parameters in render space.
struct CameraRecord {
    std::uint32_t orthographic = 0;
    std::uint32_t
        spherical = 0,
        equal_area = 0;  ///< 1 if the camera sees all directions by an equirectangular or an equal-area mapping, else 0
    float position[3] = {};
    float right[3] = {}, up[3] = {}, forward[3] = {};  ///< orthonormal camera axes
    float half_width = 1, half_height = 1;  ///< half size of the image plane: at distance 1 (perspective), or in render
                                            ///< space (orthographic)
    float lens_radius = 0, focus_distance = 1;
    float shutter_open = 0, shutter_close = 0;
    float shift_right = 0, shift_up = 0;  ///< offset of the image center, in the units of half_width and half_height
};

}  // namespace fathom
