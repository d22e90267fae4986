// SPDX-License-Identifier: Apache-2.0
#include "scene/light_table.h"

#include <numbers>

#include "scene/enum_names.h"
#include "scene/units.h"

namespace fathom {

namespace {

using P = Parameter<Light>;
using enum LightKind;

using std::numbers::pi;

/// Power refers to the whole sphere, also for spots: the cone only blocks light.
constexpr LightUnit intensities[] = {{"cd"}, {"lm", 1 / (4 * pi)}, {"W/sr", 1, true}, {"W", 1 / (4 * pi), true}};
/// The distribution of the image is normalized to the given flux.
constexpr LightUnit image_intensities[] = {{"cd"}, {"lm", 1, false, true}, {"W/sr", 1, true}, {"W", 1, true, true}};
constexpr LightUnit radiances[] = {{"nit"},
                                   {"lm/m2", 1 / pi},
                                   {"W/m2/sr", 1, true},
                                   {"W/m2", 1 / pi, true},
                                   {"lm", 1, false, true},
                                   {"W", 1, true, true}};
constexpr LightUnit irradiances[] = {{"lx"}, {"W/m2", 1, true}};

constexpr const char* over_the_sphere = "unit of intensity; lm and W: over the whole sphere";
constexpr const char* over_the_image = "unit of intensity; lm and W: the light of all directions together";
constexpr const char* of_irradiance = "unit of intensity, at perpendicular incidence";
constexpr const char* travels = "direction in which the light travels";
constexpr const char* top_of_image = "direction of the top of the image";

constexpr LightKindInfo kinds[] = {
    {.kind = {point, "point", "emits from a point with the same intensity in all directions"},
     .units = intensities,
     .unit_meaning = over_the_sphere},
    {.kind = {spot, "spot", "emits from a point into a cone"},
     .units = intensities,
     .unit_meaning = over_the_sphere,
     .direction_meaning = travels,
     .up_meaning = top_of_image,
     .image_meaning = "path, relative to this file, of an image that multiplies the intensity over the square around "
                      "the outer cone",
     .up_needs_image = true},
    {.kind = {directional, "directional", "emits from infinitely far away, like the sun"},
     .units = irradiances,
     .unit_meaning = of_irradiance,
     .has_position = false,
     .direction_meaning = travels},
    {.kind = {projector, "projector", "projects an image from a point"},
     .units = image_intensities,
     .unit_meaning = over_the_image,
     .direction_meaning = travels,
     .up_meaning = top_of_image,
     .image_meaning = "path, relative to this file, of the projected image; default: white"},
    {.kind = {goniometric, "goniometric", "emits from a point, with an intensity given by an image or an IES file"},
     .units = image_intensities,
     .unit_meaning = over_the_image,
     .direction_meaning = travels,
     .up_meaning = top_of_image,
     .image_meaning = "path, relative to this file, of a square equal-area image of all directions, or an IES file",
     .needs_image = true},
    {.kind = {beam, "beam", "emits parallel light from a flat area"},
     .units = irradiances,
     .unit_meaning = of_irradiance,
     .direction_meaning = travels,
     .up_meaning = "direction of the top of the area"},
    {.kind = {tube, "tube", "emits diffusely from the side of a cylinder, like a fluorescent tube"},
     .units = radiances,
     .unit_meaning = "unit of intensity; lm and W: of the whole tube, whatever its size",
     .direction_meaning = "direction of the axis"},
};

const P parameters[] = {
    {.key = "angle_deg",
     .kinds = kind_bits(directional),
     .member = field<&Light::angle>,
     .meaning = "angular diameter of the disk from which the light comes; 0: a delta light",
     .least = 0,
     .most = 180,
     .unit = radians_per_degree},
    {.key = "inner_angle_deg",
     .kinds = kind_bits(spot),
     .member = field<&Light::inner_angle>,
     .meaning = "half angle of the cone of full intensity",
     .least = 0,
     .most = 90,
     .unit = radians_per_degree},
    {.key = "outer_angle_deg",
     .kinds = kind_bits(spot),
     .member = field<&Light::outer_angle>,
     .meaning = "half angle outside of which there is no light",
     .least = 0,
     .most = 90,
     .unit = radians_per_degree},
    {.key = "falloff",
     .kinds = kind_bits(spot),
     .member = field<&Light::falloff>,
     .meaning = "between the two angles: the square of the linearly interpolated cosine, a smooth step of it, or the "
                "linearly interpolated angle",
     .words = words::spot_falloffs},
    {.key = "fov_deg",
     .kinds = kind_bits(projector),
     .member = field<&Light::fov>,
     .meaning = "full angle of the image",
     .least = 0,
     .most = 180,
     .unit = radians_per_degree,
     .excludes_limits = true},
    {.key = "fov_axis",
     .kinds = kind_bits(projector),
     .member = field<&Light::fov_axis>,
     .meaning = "axis of the image across which the angle is measured",
     .words = words::fov_axes},
    {.key = "flat_field",
     .kinds = kind_bits(projector),
     .member = field<&Light::flat_field>,
     .meaning = "the image is the illuminance on a screen perpendicular to the axis at 1 m, not the intensity"},
    {.key = "width",
     .kinds = kind_bits(beam),
     .member = field<&Light::width>,
     .meaning = "width of the area in meters",
     .least = 0,
     .excludes_limits = true},
    {.key = "height",
     .kinds = kind_bits(beam),
     .member = field<&Light::height>,
     .meaning = "height of the area in meters",
     .least = 0,
     .excludes_limits = true},
    {.key = "round",
     .kinds = kind_bits(beam),
     .member = field<&Light::round>,
     .meaning = "the area is an ellipse instead of a rectangle"},
    {.key = "length",
     .kinds = kind_bits(tube),
     .member = field<&Light::length>,
     .meaning = "length of the cylinder in meters",
     .least = 0,
     .excludes_limits = true},
    {.key = "radius",
     .kinds = kind_bits(tube),
     .member = field<&Light::radius>,
     .meaning = "radius of the cylinder in meters",
     .least = 0,
     .excludes_limits = true},
};

}  // namespace

const char* light_kind_name(LightKind kind)
{
    return info_of(kind).kind.name;
}
std::span<const LightKindInfo> light_kinds()
{
    return kinds;
}
std::span<const Parameter<Light>> light_parameters()
{
    return parameters;
}

}  // namespace fathom
