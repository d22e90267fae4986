#pragma once
#include "integrate/camera_record.h"
#include "sampling/warp.h"

namespace fathom::inline FATHOM_LANES {

struct CameraRay {
    Vec3 o, d;
    Float time;
};

/// The ray through the point (x, y) of the picture, from 0 to 1 and y downwards; lens and time are random.
inline CameraRay camera_ray(const CameraRecord& camera, Float x, Float y, Sample2 lens, Float time)
{
    const Float sx = fma(x, Float(2), Float(-1)) * Float(camera.half_width) + Float(camera.shift_right);
    const Float sy = fma(y, Float(-2), Float(1)) * Float(camera.half_height) + Float(camera.shift_up);
    const auto axis = [](const float* a) { return Vec3{Float(a[0]), Float(a[1]), Float(a[2])}; };
    const Vec3 right = axis(camera.right), up = axis(camera.up), forward = axis(camera.forward);
    CameraRay ray;
    ray.o = axis(camera.position);
    ray.time = fma(time, Float(camera.shutter_close - camera.shutter_open), Float(camera.shutter_open));
    const Vec3 across = fma(right, sx, up * sy);
    if (camera.orthographic) {
        ray.o = ray.o + across;
        ray.d = forward;
    } else {
        ray.d = across + forward;
    }
    if (camera.lens_radius > 0) {
        const DiskPoint p = sample_disk(lens);
        const Vec3 shift = fma(right, p.x * Float(camera.lens_radius), up * (p.y * Float(camera.lens_radius)));
        // ray.d has length 1 along the view axis, so this is the point in focus.
        const Vec3 focus = fma(ray.d, Float(camera.focus_distance), ray.o);
        ray.o = ray.o + shift;
        ray.d = focus - ray.o;
    }
    ray.d = normalize(ray.d);
    return ray;
}

}  // namespace fathom::inline FATHOM_LANES
