#pragma once
#include <cstdint>

namespace fathom {

/// The camera in render space.
struct CameraRecord {
    std::uint32_t orthographic = 0;
    std::uint32_t spherical = 0, equal_area = 0;  ///< all directions; the latter only of those
    float position[3] = {};
    float right[3] = {}, up[3] = {}, forward[3] = {};  ///< unit
    float half_width = 1, half_height = 1;  ///< at distance 1 (perspective), or in render space (orthographic)
    float lens_radius = 0, focus_distance = 1;
    float shutter_open = 0, shutter_close = 0;
    float shift_right = 0, shift_up = 0;  ///< of the picture's middle, as half_width and half_height
};

}  // namespace fathom
