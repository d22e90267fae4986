// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/camera_record.h"
#include "kernel/kernel.h"
#include "math/elementary.h"
#include "sampling/warp.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Connects points of the scene to the camera: the inverse of camera_ray().
class CameraConnector {
public:
    CameraConnector(const CameraRecord& camera, const KernelSettings& settings)
        : camera_(camera),
          right_(axis(camera.right)),
          up_(axis(camera.up)),
          forward_(axis(camera.forward)),
          position_(axis(camera.position)),
          width_(float(settings.width)),
          height_(float(settings.height)),
          pixels_(width_ * height_)
    {
    }

    /// Pixels per unit of area perpendicular to a camera ray of direction d, at a distance from its origin.
    Float pixels_per_area(const Vec3& d, Float distance) const
    {
        if (camera_.spherical) {
            const Float r2 = distance * distance;
            if (camera_.equal_area) return Float(pixels_ * 0.25f * inv_pi) / r2;
            const Float cosine = dot(d, up_), sine = sqrt(max(fma(-cosine, cosine, Float(1)), Float(0)));
            return Float(pixels_ * 0.5f * inv_pi * inv_pi) / (sine * r2);
        }
        const Float cosine = dot(d, forward_);
        const Float per_area(pixels_ / (4 * camera_.half_width * camera_.half_height));
        if (camera_.orthographic) return per_area / cosine;
        return per_area / (cosine * cosine * cosine * distance * distance);
    }

    /// The camera as seen from a point.
    struct Connection {
        Vec3 lens;       ///< point of the lens, where the camera ray starts
        Vec3 d;          ///< unit, from the lens to the point
        Float distance;  ///< between both
        Float x, y;      ///< position in the image, in pixels, y downward
        Mask valid;      ///< the point is in front of the camera
    };
    /// Connects p to a point of the lens. lens: uniform sample.
    Connection connect(const Vec3& p, Sample2 lens) const
    {
        DiskPoint on_lens{Float(0), Float(0)};
        if (camera_.lens_radius > 0) {
            on_lens = sample_disk(lens);
            on_lens.x = on_lens.x * Float(camera_.lens_radius), on_lens.y = on_lens.y * Float(camera_.lens_radius);
        }
        const Vec3 shift = fma(right_, on_lens.x, up_ * on_lens.y), to = p - position_;
        const Float ahead = dot(to, forward_);
        Connection c;
        c.valid = Mask(true);
        Float sx(0), sy(0);
        if (camera_.spherical) {
            c.lens = position_;
        } else if (camera_.orthographic) {
            // A ray runs from (sx, sy) plus the shift to (sx, sy) on the plane in focus.
            const Float along = Float(1) - ahead * Float(1 / camera_.focus_distance);
            sx = fma(-on_lens.x, along, dot(to, right_)), sy = fma(-on_lens.y, along, dot(to, up_));
            c.lens = position_ + shift + fma(right_, sx, up_ * sy);
            c.valid = ahead > Float(0);
        } else {
            c.lens = position_ + shift;
            // The ray meets the plane in focus at the shift plus its slope times the distance of the plane.
            const Float scale = Float(1) / ahead;
            const Vec3 from_lens = to - shift;
            sx = fma(on_lens.x, Float(1 / camera_.focus_distance), dot(from_lens, right_) * scale);
            sy = fma(on_lens.y, Float(1 / camera_.focus_distance), dot(from_lens, up_) * scale);
            c.valid = ahead > Float(0);
        }
        const Vec3 way = p - c.lens;
        const Float distance2 = dot(way, way), inverse = inverse_sqrt(max(distance2, Float(1e-37f)));
        c.d = way * inverse;
        c.distance = distance2 * inverse;
        c.valid &= distance2 > Float(0);
        if (camera_.spherical) return on_sphere(c);
        c.x = fma((sx - Float(camera_.shift_right)) / Float(camera_.half_width), Float(0.5f), Float(0.5f)) *
              Float(width_);
        c.y = fma((sy - Float(camera_.shift_up)) / Float(camera_.half_height), Float(-0.5f), Float(0.5f)) *
              Float(height_);
        return c;
    }

private:
    static Vec3 axis(const float* a) { return {Float(a[0]), Float(a[1]), Float(a[2])}; }

    /// Sets the position in the image of a spherical camera.
    Connection on_sphere(Connection c) const
    {
        const Float right = dot(c.d, right_), up = dot(c.d, up_), forward = dot(c.d, forward_);
        if (camera_.equal_area) {
            // The inverse of equal_area_direction(): the camera's up is in the middle of the square.
            const SquarePoint p = equal_area_square(right, forward, up);
            c.x = fma(p.x, Float(0.5f), Float(0.5f)) * Float(width_);
            c.y = fma(-p.y, Float(0.5f), Float(0.5f)) * Float(height_);
            return c;
        }
        const Float phi = atan2(-right, -forward) * Float(0.5f * inv_pi);
        c.x = (phi - floor(phi)) * Float(width_);
        c.y = acos(clamp(up, Float(-1), Float(1))) * Float(inv_pi * height_);
        return c;
    }

    const CameraRecord& camera_;
    const Vec3 right_, up_, forward_, position_;
    const float width_, height_, pixels_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
