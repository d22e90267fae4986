// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/description.h"

namespace fathom::view {

/// A camera that is moved with mouse and keys, around a pivot that is also in focus. Without moves, it is bit for bit
/// the camera of the scene.
class CameraControl {
public:
    explicit CameraControl(const Camera& start);

    const Camera& camera() const { return camera_; }
    Vec3d pivot() const { return pivot_; }
    /// Metres from the camera to the pivot, along the view axis; above 0.
    double distance() const;

    /// Rotates the camera around the pivot, as if the scene were turned to the right and towards the viewer; radians.
    /// The view direction stays away from the rotation axis.
    void orbit(double right, double down);
    /// Rotates the camera at its position, to the right and up; radians.
    void look(double right, double up);
    /// Moves the scene to the right and down, in image heights at the distance of the pivot.
    void pan(double right, double down);
    /// Moves towards the pivot (steps > 0) or away from it; an orthographic camera changes its height instead.
    void zoom(double steps);
    /// Moves camera and pivot, in units of the distance to the pivot.
    void fly(double right, double up, double forward);
    /// A pinhole camera for an image of a single pixel that covers one pixel of this image.
    ///
    /// x, y   position in the image, 0 to 1, y down
    /// pixel  height of a pixel over that of the image
    Camera through(double x, double y, double aspect, double pixel) const;
    /// Moves pivot and focus to the point at this depth of the camera through(x, y). Returns whether the image changes,
    /// which it does not for a pinhole camera.
    bool focus(double x, double y, double aspect, double depth);
    /// Returns to the scene's camera.
    void reset();

private:
    struct Frame {
        Vec3d right, up, forward;
    };
    Frame frame() const;
    /// The ray through a point of the image: shift of the origin, and direction with length 1 along the view axis.
    struct ImageRay {
        Vec3d shift, direction;
    };
    ImageRay ray(double x, double y, double aspect) const;
    /// Sets position and view direction, with the pivot in focus.
    void set_view(Vec3d position, Vec3d forward);

    Camera start_, camera_;
    Vec3d pivot_, axis_;
};

}  // namespace fathom::view
