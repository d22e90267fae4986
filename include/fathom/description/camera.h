// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "fathom/vector.h"

namespace fathom {

/// Axis of the image across which an angle of view is measured.
enum class FovAxis {
    smaller,  ///< Smaller of width and height of the image.
    larger,   ///< Larger of width and height of the image.
    width,    ///< Width of the image.
    height,   ///< Height of the image.
    diagonal  ///< Diagonal of the image.
};

/// Projection of a camera.
enum class CameraKind {
    perspective,   ///< Perspective projection, optionally with a thin lens.
    orthographic,  ///< Parallel projection.
    spherical,     ///< All directions, equirectangular: `up` at the top, the direction of look_at in the middle.
    equal_area  ///< All directions, in a square where equal solid angles have equal areas, as in pbrt-v4: `up` in the
                ///< middle, the direction of look_at at the top, its opposite in all corners.
};

/// A camera in the space of its node. It looks from position to look_at.
struct Camera {
    std::string name;                           ///< Name by which it can be selected; may be empty.
    CameraKind kind = CameraKind::perspective;  ///< Projection of the camera.
    /// Position of the eye, a point in the middle of the image, and the up direction, which need not be perpendicular
    /// to the view direction.
    Vec3d position{0, 0, 0}, look_at{0, 0, -1}, up{0, 1, 0};
    /// perspective: full vertical angle of view in radians (40 degrees by default).
    double fov_y = 0.6981317007977318;
    double height = 2;  ///< orthographic: meters from the bottom to the top of the image.
    /// If above 0, fov_y and height are for an image of this aspect ratio (width / height). For an image of another
    /// aspect ratio, the angle or length across fov_axis is kept.
    double fov_aspect = 0;
    FovAxis fov_axis = FovAxis::height;  ///< Axis that is kept if fov_aspect is above 0.
    double aspect = 0;                   ///< Recommended width / height of the image; 0: any.
    /// perspective, orthographic: lens shift. Moves the contents to the right and up, in widths and heights of the
    /// image, without turning the camera.
    double shift_x = 0, shift_y = 0;
    double aperture = 0;        ///< perspective: diameter of the lens in meters; 0: a pinhole, everything is in focus.
    double focus_distance = 0;  ///< Distance of the focal plane along the view axis in meters; 0: that of look_at.
    double shutter_open = 0, shutter_close = 0;  ///< Shutter times in seconds; equal: no motion blur.
};

}  // namespace fathom
