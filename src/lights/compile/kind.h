// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Types by which the kinds of lights are compiled and bounded; see lights/kinds/records.h.
#include <cmath>
#include <functional>

#include "fathom/description.h"
#include "lights/compile/light_pictures.h"
#include "lights/kinds/records.h"

namespace fathom {

/// The shutter interval, in units of time of moving spheres.
struct Shutter {
    double open, close;
};

struct LightBall {
    Vec3d center;
    double radius = 0;
};

/// Bounds of a light for the light tree.
struct LightBounds {
    LightBall ball;
    Vec3d axis;  ///< unit axis of its normals, or of a spot's directions; zero if it emits in all directions
    double cos_normals = -1;  ///< cosine of the largest angle between its normals and the axis
    double cos_emission = 0;  ///< cosine of the largest angle between emission and normal
    double intensity = 0;     ///< maximum over all directions
    bool emits_back = false;  ///< emits to both sides of its normals
};
/// Margins of bounds on normals, against rounding of the records and of the kernel's arithmetic.
constexpr double cosine_slack = 1e-6;

/// A light of the description with its transform.
struct PlacedLight {
    const Light& light;
    const Transform& render_from_node;  ///< transform at the time when the shutter opens
    double render_scale;                ///< length of a meter in render space
    double scene_radius;                ///< radius of the scene in render space
    const std::function<PicturedIntensity()>&
        add_picture;  ///< adds the light's image to the tables, and returns its properties
};

/// 1 - cos without cancellation for small angles.
inline double one_minus_cos(double angle)
{
    const double s = std::sin(angle / 2);
    return 2 * s * s;
}

inline void store(float* to, Vec3d v)
{
    to[0] = float(v.x), to[1] = float(v.y), to[2] = float(v.z);
}
inline Vec3d to_vector(const float* v)
{
    return {double(v[0]), double(v[1]), double(v[2])};
}
inline Vec3f to_place(const float* v)
{
    return {v[0], v[1], v[2]};
}

/// Converts the light's intensity, which refers to squared distances in world units, to render space.
void scale_intensity(const PlacedLight& at, LightRecord& light);
/// Power of a light that shines from a point.
double power_of_intensity(const LightRecord& light);

}  // namespace fathom
