// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "fathom/vector.h"

namespace fathom {

/// Kind of an environment.
enum class EnvironmentKind {
    none,          ///< Black.
    constant,      ///< The same radiance from all directions.
    gradient,      ///< Linear in the up component of the direction.
    image,         ///< Equirectangular image.
    studio,        ///< Three soft lights and a dim room, for a camera that looks along -z.
    sky,           ///< Clear sky, computed by a model of the atmosphere, over gray ground; with the sun if sun_disk.
    cube,          ///< Six images on the faces of a cube.
    equal_area,    ///< Square image in which equal solid angles have equal areas, as in pbrt-v4.
    hosek_wilkie,  ///< Clear sky by the formula of Hosek and Wilkie (2012), without sun and ground.
};

/// Light from outside the scene, and what rays see that leave it.
struct Environment {
    EnvironmentKind kind = EnvironmentKind::none;  ///< Kind, which decides which members apply.
    Color color{1, 1, 1};                          ///< constant: radiance in nits; other kinds: factor of the radiance.
    /// gradient: radiance, interpolated by (1 + y) / 2 of the direction's up component.
    Color bottom{1, 1, 1}, top{0.5f, 0.7f, 1};
    int image = -1;  ///< image, equal_area: index into SceneDescription::images; linear (8-bit files: sRGB).
    /// image, cube, equal_area: if above 0, the image is scaled so that it gives this illuminance in lux to a surface
    /// that faces its top (equal_area: its middle). `color` is applied afterwards.
    double illuminance = 0;
    /// cube: images towards +x, -x, +y, -y, +z, -z, oriented as in OpenGL; linear (8-bit files: sRGB). Colors are
    /// divided by alpha.
    std::array<int, 6> faces{-1, -1, -1, -1, -1, -1};
    /// Rotation. An equirectangular image has +x in its middle and +y at its top. An equal_area image has +z in its
    /// middle, +x at its right and +y at its bottom.
    Transform world_from_environment;
    /// sky, hosek_wilkie: direction to the sun, of any length above 0; +y is up. In a sky, a white surface that faces
    /// the sun above the atmosphere has a radiance of 1; a `color` of 42,400 gives nits.
    Vec3d to_sun{-0.4, 0.6, 0.7};
    bool sun_disk = true;  ///< sky: includes the sun itself.
    /// hosek_wilkie: turbidity from 1 (clear) to 10 (hazy), and albedo from 0 to 1 of the ground that lights the air.
    /// The radiance is in W/m^2/sr/nm, about 0.1.
    double turbidity = 3, ground_albedo = 0.3;
    bool sky_ground = true;  ///< sky: gray ground below the horizon, lit by sun and sky; otherwise black.
};

}  // namespace fathom
