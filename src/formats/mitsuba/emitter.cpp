// SPDX-License-Identifier: Apache-2.0
// Reading of emitters that have no surface.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/common/lights.h"
#include "formats/io/read_file.h"
#include "formats/mitsuba/reader.h"
#include "formats/mitsuba/sun_of_date.h"
#include "formats/mitsuba/sun_table.h"
#include "scene/units.h"

namespace fathom::mitsuba {

namespace {

/// Maps directions of Fathom's environments, whose image has +x at its center and +z to the right, to Mitsuba's, whose
/// image has +z at its center and -x to the right.
Transform mitsuba_from_environment()
{
    Transform t;
    t.m = {{{0, 0, -1, 0}, {0, 1, 0, 0}, {1, 0, 0, 0}}};
    return t;
}

Transform rotation_of(Transform t)
{
    for (auto& row : t.m) row[3] = 0;
    return t;
}

Color sun_at(double turbidity, double height_deg)
{
    const double t = std::clamp(turbidity - 1, 0.0, 9.0);
    const auto row = std::min<std::size_t>(std::size_t(t), 8);
    constexpr std::size_t last = std::size(sun_heights_deg) - 1;
    std::size_t i = 0;
    while (i + 1 < last && sun_heights_deg[i + 1] < height_deg) ++i;
    const double begin = sun_heights_deg[i], end = sun_heights_deg[i + 1],
                 x = std::clamp((height_deg - begin) / (end - begin), 0.0, 1.0), y = t - double(row);
    const auto channel = [&](std::size_t c) {
        const auto at = [&](std::size_t r) {
            return (1 - x) * double(sun_irradiance[r][i][c]) + x * double(sun_irradiance[r][i + 1][c]);
        };
        return float(std::max((1 - y) * at(row) + y * at(row + 1), 0.0));
    };
    return {channel(0), channel(1), channel(2)};
}

}  // namespace

void Reader::add_light(Light light, const Transform& world_from_light)
{
    Node node;
    node.name = light.name;
    // Fathom's lights shine along -z, Mitsuba's along +z.
    node.parent_from_node = world_from_light * Transform::scale({-1, 1, -1});
    node.light = int(scene_.lights.size());
    scene_.lights.push_back(std::move(light));
    scene_.roots.push_back(add_node(std::move(node)));
}

void Reader::add_beam(const Element& element, Object& shape, Node& node)
{
    const std::string& type = shape.type();
    if (type != "rectangle" && type != "disk")
        return report(element, "'directionalarea' is supported on rectangles and disks only: it is ignored");
    Object emitter(element, document_);
    Light light;
    light.name = element.attribute("id");
    light.kind = LightKind::beam;
    // A `directionalarea` emits into one direction, so its `radiance` is power per area.
    light.intensity = plain_color(emitter, "radiance", {1, 1, 1});
    light.width = light.height = 2;
    light.round = type == "disk";
    emitter.finish(context_.warnings);
    Node beam;
    if (!shape.boolean("flip_normals", false)) beam.parent_from_node = Transform::scale({1, 1, -1});
    beam.light = int(scene_.lights.size());
    scene_.lights.push_back(std::move(light));
    node.children.push_back(add_node(std::move(beam)));
}

void Reader::read_emitter(const Element& element)
{
    Object emitter(element, document_);
    const std::string& type = emitter.type();
    Light light;
    light.name = element.attribute("id");
    // The medium around a light is derived from the enclosing shapes.
    emitter.child("medium");
    if (type == "constant") {
        scene_.environment.kind = EnvironmentKind::constant;
        scene_.environment.color = plain_color(emitter, "radiance", {1, 1, 1});
    } else if (type == "envmap") {
        read_environment_map(emitter);
    } else if (type == "sunsky" || type == "sky" || type == "sun") {
        read_sky(emitter);
    } else if (type == "point") {
        light.intensity = plain_color(emitter, "intensity", {1, 1, 1});
        Transform place = emitter.transform("to_world");
        if (const auto position = emitter.vector("position")) place = Transform::translate(*position);
        add_light(light, place);
    } else if (type == "spot") {
        light.kind = LightKind::spot;
        light.intensity = plain_color(emitter, "intensity", {1, 1, 1});
        const double cutoff = emitter.number("cutoff_angle", 20);
        light.outer_angle = cutoff * radians_per_degree;
        light.inner_angle = emitter.number("beam_width", cutoff * 3 / 4) * radians_per_degree;
        light.falloff = SpotFalloff::linear;
        // Mitsuba's spot texture has its right at +x and its bottom at +y: rotated by half a turn relative to a
        // projector.
        Transform place = emitter.transform("to_world");
        if (const Element* const texture = emitter.child("texture")) {
            if (cutoff >= 90) element.fail("the cone of a spot with a texture must be below 90 degrees");
            if (const auto picture = light_picture(*texture)) light.picture = *picture;
            place = place * Transform::scale({-1, -1, 1});
        }
        add_light(light, place);
    } else if (type == "projector") {
        read_projector(emitter, light);
    } else if (type == "directional") {
        light.kind = LightKind::directional;
        light.intensity = plain_color(emitter, "irradiance", {1, 1, 1});
        const auto direction = emitter.vector("direction");
        add_light(light, direction ? rotation_from_z(*direction) : rotation_of(emitter.transform("to_world")));
    } else {
        report(element, "is not supported and is ignored");
        return;
    }
    emitter.ignore({"sampling_weight"});
    emitter.finish(context_.warnings);
}

/// The image of a bitmap texture; nothing for another texture, which is reported.
std::optional<LightImage> Reader::light_picture(const Element& texture)
{
    Object object(texture, document_);
    if (texture.tag != "texture" || object.type() != "bitmap") {
        report(texture, "a light's image must be a bitmap: other textures are ignored");
        return std::nullopt;
    }
    Texture read = scene_.textures[std::size_t(this->texture(texture, false))];
    const bool is_moved =
        read.uv_scale.x != 1 || read.uv_scale.y != 1 || read.uv_offset.x != 0 || read.uv_offset.y != 0;
    if (is_moved || read.uv_rotation != 0) report(texture, "'to_uv' of a light's image is ignored");
    return LightImage{read.image, read.color_space, read.nearest};
}

/// Mitsuba's `irradiance` is the irradiance at distance 1 divided by pi, as it follows from the importance of its
/// cameras.
void Reader::read_projector(Object& emitter, Light& light)
{
    light.kind = LightKind::projector;
    light.flat_field = true;
    light.intensity = scaled({1, 1, 1}, std::numbers::pi * emitter.number("scale", 1));
    if (const Element* const irradiance = emitter.child("irradiance")) {
        if (const auto color = color_of(*irradiance)) {
            light.intensity = scaled(*color, double(light.intensity.r));
        } else if (const auto picture = light_picture(*irradiance)) {
            light.picture = *picture;
        }
    }
    const FieldOfView view = field_of_view(emitter);
    light.fov = view.angle, light.fov_axis = view.axis;
    add_light(light, emitter.transform("to_world"));
}

void Reader::read_environment_map(Object& emitter)
{
    const std::string filename = emitter.text("filename", "");
    if (filename.empty()) emitter.element().fail("an envmap needs a 'filename'");
    const std::filesystem::path file = document_.locate(filename, context_);
    Environment& environment = scene_.environment;
    environment.kind = EnvironmentKind::image;
    environment.image = int(scene_.images.size());
    scene_.images.push_back({filename, file, {}});
    const float scale = float(emitter.number("scale", 1));
    environment.color = {scale, scale, scale};
    environment.world_from_environment = rotation_of(emitter.transform("to_world")) * mitsuba_from_environment();
    emitter.ignore({"mis_compensation"});
}

void Reader::read_sky(Object& emitter)
{
    // Mitsuba's sky has +z up.
    Transform y_up;
    y_up.m = {{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}}};
    const Transform world = rotation_of(emitter.transform("to_world")), world_from_sky = world * y_up.inverse();
    const auto said = emitter.vector("sun_direction");
    const SunAngles sun = sun_of_date(
        emitter.element(), [&](std::string_view name, double otherwise) { return emitter.number(name, otherwise); });
    // Mitsuba's sky has +x in the south and +y in the west.
    const double flat = std::cos(sun.elevation);
    const Vec3d of_date{-std::cos(sun.azimuth) * flat, -std::sin(sun.azimuth) * flat, std::sin(sun.elevation)};
    // An explicit sun direction is in world space, independent of the sky's transform.
    const Vec3d to_sun = normalize(said ? world.inverse().vector(*said) : of_date);
    const double turbidity = std::clamp(emitter.number("turbidity", 3), 1.0, 10.0),
                 elevation_deg = std::asin(std::clamp(to_sun.z, 0.0, 1.0)) / radians_per_degree;
    if (emitter.type() != "sun") {
        Environment& environment = scene_.environment;
        environment.kind = EnvironmentKind::hosek_wilkie;
        environment.turbidity = turbidity;
        environment.ground_albedo = emitter.number("albedo", 0.3);
        environment.world_from_environment = world_from_sky;
        environment.to_sun = y_up.vector(to_sun);
        environment.color = scaled({1, 1, 1}, emitter.number("sky_scale", 1));
    }
    if (emitter.type() != "sky" && to_sun.z > 0) {
        Light light;
        light.name = "sun";
        light.kind = LightKind::directional;
        light.angle = emitter.number("sun_aperture", 0.5358) * radians_per_degree;
        light.intensity = scaled(sun_at(turbidity, elevation_deg), emitter.number("sun_scale", 1));
        add_light(light, rotation_from_z(world.vector(-to_sun)));
    }
    emitter.ignore({"turbidity", "albedo", "sun_aperture", "sun_scale", "sky_scale", "complex_sun"});
}

}  // namespace fathom::mitsuba
