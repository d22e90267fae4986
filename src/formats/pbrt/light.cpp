// SPDX-License-Identifier: Apache-2.0
// Reading of lights without a surface.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/common/lights.h"
#include "formats/io/read_file.h"
#include "formats/pbrt/reader.h"
#include "scene/units.h"

namespace fathom::pbrt {

namespace {

Transform rotation_of(const Transform& t)
{
    Transform result;
    const double scale = std::cbrt(std::abs(t.determinant()));
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column)
            result.m[row][column] = t.m[row][column] / (scale > 0 ? scale : 1);
    return result;
}

}  // namespace

void Reader::add_light(Light light, const Transform& world_from_light)
{
    // Fathom's lights shine along -z, pbrt's along +z.
    add_light_node(std::move(light), world_from_light * Transform::scale({-1, 1, -1}));
}

void Reader::add_light_node(Light light, const Transform& world_from_node)
{
    Node node;
    node.parent_from_node = world_from_node;
    node.light = int(scene_.lights.size());
    scene_.lights.push_back(std::move(light));
    scene_.roots.push_back(add_node(std::move(node)));
}

namespace {

/// A light's position and the point that it is directed at.
struct Aim {
    Vec3d from, to;
};

Aim aim_of(const Parameters& of)
{
    const Aim aim{of.vector("from").value_or(Vec3d{}), of.vector("to").value_or(Vec3d{0, 0, 1})};
    if (length(aim.to - aim.from) == 0) of.fail("'from' and 'to' are the same point");
    return aim;
}

}  // namespace

void Reader::read_light(const Parameters& of)
{
    if (state_.ctm[0].m != state_.ctm[1].m) report(of, "light motion is not supported: the first transform is used");
    const std::string& type = of.plugin();
    if (type == "infinite") return read_infinite(of);
    if (type == "point" || (type == "goniometric" && !of.has("filename")))
        read_point(of);
    else if (type == "goniometric")
        read_goniometric(of);
    else if (type == "projection")
        read_projection(of);
    else if (type == "spot")
        read_spot(of);
    else if (type == "distant")
        read_distant(of);
    else
        return report(of, "is not supported and is ignored");
    of.finish(reporter_);
}

/// Reads a point light, or a goniometric one without an image, which is a point at the origin.
void Reader::read_point(const Parameters& of)
{
    Light light;
    light.intensity = light_color(of, "I");
    const Vec3d from = of.plugin() == "point" ? of.vector("from").value_or(Vec3d{}) : Vec3d{};
    const double power = of.number("power", -1);
    if (power > 0) light.intensity = scaled(light.intensity, power / (4 * std::numbers::pi));
    add_light(light, state_.ctm[0] * Transform::translate(from));
}

void Reader::read_spot(const Parameters& of)
{
    const Aim aim = aim_of(of);
    Light light;
    light.kind = LightKind::spot;
    light.intensity = light_color(of, "I");
    const double cone = of.number("coneangle", 30);
    light.outer_angle = cone * radians_per_degree;
    light.falloff = SpotFalloff::smooth;
    light.inner_angle = std::max(0.0, cone - of.number("conedeltaangle", 5)) * radians_per_degree;
    if (!(cone > 0 && cone < 180)) of.fail("the cone's angle must be above 0 and below 180 degrees");
    const double inner = std::cos(light.inner_angle), outer = std::cos(light.outer_angle);
    if (const double power = of.number("power", -1); power > 0)
        light.intensity = scaled(light.intensity, power / (2 * std::numbers::pi * ((1 - inner) + (inner - outer) / 2)));
    add_light(light, state_.ctm[0] * Transform::translate(aim.from) * rotation_from_z(aim.to - aim.from));
}

void Reader::read_distant(const Parameters& of)
{
    const Aim aim = aim_of(of);
    Light light;
    light.kind = LightKind::directional;
    light.intensity = light_color(of, "L");
    if (const double lux = of.number("illuminance", -1); lux > 0) light.intensity = scaled(light.intensity, lux);
    of.ignore({"power"});
    add_light(light, rotation_of(state_.ctm[0]) * rotation_from_z(aim.to - aim.from));
}

/// The image's center is the direction +y, its right is +x and its bottom is +z.
void Reader::read_goniometric(const Parameters& of)
{
    Light light;
    light.kind = LightKind::goniometric;
    light.picture = {image(of), ColorSpace::srgb, true};
    light.intensity = light_color(of, "I");
    set_power(of, light);
    Transform light_from_node;
    light_from_node.m = {{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, -1, 0, 0}}};
    add_light_node(light, state_.ctm[0] * light_from_node);
}

/// Projects along +z; the image's right is +x and its top is +y.
void Reader::read_projection(const Parameters& of)
{
    Light light;
    light.kind = LightKind::projector;
    light.picture = {image(of), ColorSpace::srgb, true};
    const auto scale = float(of.number("scale", 1));
    light.intensity = {scale, scale, scale};
    set_power(of, light);
    const double fov = of.number("fov", 90);
    if (!(fov > 0 && fov < 180)) of.fail("'fov' must be above 0 and below 180 degrees");
    light.fov = fov * radians_per_degree;
    add_light_node(light, state_.ctm[0] * Transform::scale({1, 1, -1}));
}

/// Sets the power of a light that has an image.
void Reader::set_power(const Parameters& of, Light& light)
{
    const double power = of.number("power", -1);
    if (!(power > 0)) return;
    light.intensity = scaled(light.intensity, power);
    light.intensity_is_flux = true;
}

void Reader::read_infinite(const Parameters& of)
{
    Environment& environment = scene_.environment;
    const double lux = of.number("illuminance", -1);
    if (of.has("portal")) {
        report(of, "'portal' is ignored: the environment is not sampled through it");
        of.ignore({"portal"});
    }
    const bool is_first = environment.kind == EnvironmentKind::none;
    if (of.has("filename")) {
        if (of.has("L")) of.fail("it can't have both 'L' and 'filename'");
        if (!is_first) report(of, "several environment images are not supported: only the last one is used");
        environment.kind = EnvironmentKind::equal_area;
        environment.image = image(of);
        const auto scale = float(of.number("scale", 1));
        environment.color = {scale, scale, scale};
        // pbrt assumes half of each pixel's true solid angle when it normalizes to an illuminance, so its light is
        // twice as bright as specified.
        environment.illuminance = std::max(2 * lux, 0.0);
        environment.world_from_environment = rotation_of(state_.ctm[0]);
    } else {
        Color color = light_color(of, "L");
        if (lux > 0) color = scaled(color, lux / std::numbers::pi);
        if (is_first || environment.kind == EnvironmentKind::constant) {
            if (is_first) environment.color = {0, 0, 0};
            environment.kind = EnvironmentKind::constant;
            environment.color = {environment.color.r + color.r, environment.color.g + color.g,
                                 environment.color.b + color.b};
        } else {
            report(of, "a constant environment in addition to an environment image is ignored");
        }
    }
    of.finish(reporter_);
}

}  // namespace fathom::pbrt
