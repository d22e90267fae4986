#pragma once
#include "fathom/description.h"

namespace fathom::view {

/// A camera that a mouse and keys move: about a point, the pivot, which is also what is in focus. Where no move was
/// made it is the scene's camera, bit for bit.
class CameraControl {
public:
    explicit CameraControl(const Camera& start);

    const Camera& camera() const { return camera_; }
    Vec3d pivot() const { return pivot_; }
    /// Metres from the camera to the pivot, along the view axis; above 0.
    double distance() const;

    /// Turns the camera about the pivot, as if the scene were turned to the right and towards the viewer; radians. The
    /// camera stops short of looking along the axis that it turns about.
    void orbit(double right, double down);
    /// Turns the camera where it stands, to the right and up; radians.
    void look(double right, double up);
    /// Moves the scene in the picture to the right and down, in heights of the picture at the pivot's distance.
    void pan(double right, double down);
    /// Nearer to the pivot (steps > 0) or away from it; an orthographic camera sees less or more.
    void zoom(double steps);
    /// Moves camera and pivot, in distances to the pivot.
    void fly(double right, double up, double forward);
    /// A camera through one point of the picture, x and y from 0 to 1, y down; `pixel` is a pixel's height in pictures.
    /// For a picture of one pixel, sharp at any distance.
    Camera through(double x, double y, double aspect, double pixel) const;
    /// Makes what was hit there, at this distance (depth) of the camera through(), pivot and focus. Returns whether the
    /// picture changes: that of a pinhole doesn't.
    bool focus(double x, double y, double aspect, double depth);
    void reset();

private:
    struct Frame {
        Vec3d right, up, forward;
    };
    Frame frame() const;
    /// The direction, of length 1 along the view axis, and the shift of position, of the ray through a point.
    struct PictureRay {
        Vec3d shift, direction;
    };
    PictureRay ray(double x, double y, double aspect) const;
    /// Puts the camera where `position` says, looking along `forward`, with the pivot in focus.
    void place(Vec3d position, Vec3d forward);

    Camera start_, camera_;
    Vec3d pivot_, axis_;
};

}  // namespace fathom::view
