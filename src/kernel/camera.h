// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/camera_record.h"
#include "sampling/warp.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Camera rays in render space: origin, unit direction, and time within the shutter interval.
struct CameraRay {
    Vec3 o, d;
    Float time;
};

/// Direction of the point (x, y) of an equirectangular image; x and y in [0, 1], y downward. Components: right, up,
/// forward.
inline Vec3 spherical_direction(Float x, Float y)
{
    const SinCos theta = sincos_2pi(Float(0.5f) * clamp(y, Float(0), Float(1))), phi = sincos_2pi(x - floor(x));
    return {-theta.sin * phi.sin, theta.cos, -theta.sin * phi.cos};
}

/// Direction of the point (x, y) of a square equal-area image: Clarberg 2008, "Fast Equal-Area Mapping of the
/// (Hemi)Sphere using SIMD". Arguments and components are those of spherical_direction().
inline Vec3 equal_area_direction(Float x, Float y)
{
    const Float u = fma(clamp(x, Float(0), Float(1)), Float(2), Float(-1)),
                v = fma(clamp(y, Float(0), Float(1)), Float(2), Float(-1));
    const Float above = Float(1) - abs(u) - abs(v), r = Float(1) - abs(above);
    // The azimuth within a quadrant, in eighths of a turn (0 to 2).
    const Float eighths = select(r > Float(0), (abs(v) - abs(u)) / max(r, Float(1e-30f)) + Float(1), Float(1));
    const SinCos phi = sincos_2pi(eighths * Float(0.125f));
    const Float across = r * sqrt(max(fma(-r, r, Float(2)), Float(0)));
    const Float up = fma(-r, r, Float(1));
    return {flip_sign(phi.cos * across, u), flip_sign(up, above), -flip_sign(phi.sin * across, v)};
}

/// Camera ray through the point (x, y) of the image; x and y in [0, 1], y downward. lens: uniform sample for the
/// aperture; time: uniform sample for the shutter interval.
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
    if (camera.spherical) {
        const Vec3 d = camera.equal_area ? equal_area_direction(x, y) : spherical_direction(x, y);
        ray.d = fma(right, d.x, fma(up, d.y, forward * d.z));
    } else if (camera.orthographic) {
        ray.o = ray.o + across;
        ray.d = forward;
    } else {
        ray.d = across + forward;
    }
    if (camera.lens_radius > 0) {
        const DiskPoint p = sample_disk(lens);
        const Vec3 shift = fma(right, p.x * Float(camera.lens_radius), up * (p.y * Float(camera.lens_radius)));
        // ray.d has length 1 along the view axis here, so this is the point in focus.
        const Vec3 focus = fma(ray.d, Float(camera.focus_distance), ray.o);
        ray.o = ray.o + shift;
        ray.d = focus - ray.o;
    }
    ray.d = normalize(ray.d);
    return ray;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
