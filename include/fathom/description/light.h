// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "fathom/api.h"
#include "fathom/description/camera.h"
#include "fathom/description/texture.h"
#include "fathom/vector.h"

namespace fathom {

/// Kind of a light without a surface.
enum class LightKind {
    point,        ///< Emits from a point with the same intensity in all directions.
    spot,         ///< Emits from a point into a cone.
    directional,  ///< Emits from infinitely far away, like the sun.
    projector,    ///< Projects an image from a point through a frustum.
    goniometric,  ///< Emits from a point, with an intensity given by an image of all directions or an IES file.
    beam,         ///< Emits parallel light from a flat area.
    tube,         ///< Emits diffusely from the side of a cylinder, like a fluorescent tube.
};
/// Name of a kind of light, as in scene files.
FATHOM_API const char* light_kind_name(LightKind kind);
/// How the intensity of a spot light falls from its inner to its outer cone.
enum class SpotFalloff {
    square,  ///< Square of the relative position of the cosine, as in KHR_lights_punctual.
    smooth,  ///< Smooth step of the relative position of the cosine, as in pbrt.
    linear,  ///< Linear in the angle, as in Mitsuba.
};

/// An image that multiplies the intensity of a light in each direction.
struct LightImage {
    int image = -1;                             ///< Index into SceneDescription::images; -1: none, which is white.
    ColorSpace color_space = ColorSpace::srgb;  ///< Encoding of 8- and 16-bit values.
    bool nearest = false;                       ///< Looks up the nearest pixel, not bilinearly.
};

/// A light that rays do not hit, at the origin of its node. All kinds except point and tube shine along -z of the node;
/// a tube lies along z, with its center at the origin. An image has its right at +x and its top at +y; it is mirrored
/// if the node's transform mirrors.
struct Light {
    std::string name;                   ///< Name for messages and scene files; may be empty.
    LightKind kind = LightKind::point;  ///< Kind, which decides which members apply.
    /// Directional and beam: irradiance at perpendicular incidence in lux. Tube: radiance in nits. Other kinds: radiant
    /// intensity in candela, multiplied by the image.
    Color intensity{1, 1, 1};
    /// Spot: half angles in radians of the cone of full intensity and of the whole cone.
    double inner_angle = 0, outer_angle = 0.7853981633974483;
    /// Directional: angular diameter in radians of the disk that the light comes from; 0: a delta light.
    double angle = 0;
    /// Spot: covers the square around the outer cone. Projector: the projected image, with square pixels. Goniometric:
    /// an equal-area square of all directions with -z in its middle, as EnvironmentKind::equal_area; or a file with the
    /// extension .ies (IES LM-63), in candela, with its nadir along -z and its 0 degree plane at +x.
    LightImage picture{};
    SpotFalloff falloff = SpotFalloff::square;  ///< Spot: shape of the falloff.
    double fov = 0.7853981633974483;      ///< Projector: full angle of the image in radians, above 0 and below pi.
    FovAxis fov_axis = FovAxis::smaller;  ///< Projector: axis that fov is measured across.
    /// Beam: size of the emitting area along x and y of the node, in units of the node's space. If the node shears it,
    /// light leaves along the normal of the area.
    double width = 1, height = 1;
    bool round = false;  ///< Beam: the area is an ellipse; otherwise a rectangle.
    /// Tube: length of the cylinder without its ends, which do not emit, and its radius, in units of the node's space.
    /// Where the node stretches the cross-section to an ellipse, the radius is that of a circle of the same area.
    double length = 1, radius = 0.013;
    /// Projector: the image is the illuminance in lux on a screen perpendicular to the axis at a distance of 1 m, not
    /// the intensity.
    bool flat_field = false;
    /// Projector, goniometric: intensity is the flux of all directions together in lumens, whatever the brightness of
    /// the image. Tube: intensity is its flux in lumens, whatever its size.
    bool intensity_is_flux = false;
};

}  // namespace fathom
