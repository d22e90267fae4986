// SPDX-License-Identifier: Apache-2.0
// Reading of spheres, disks and cylinders, including partial ones.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/mesh/surface_of_revolution.h"
#include "formats/pbrt/reader.h"
#include "scene/units.h"

namespace fathom::pbrt {

namespace {

double phi_max_of(const Parameters& shape)
{
    return std::clamp(shape.number("phimax", 360), 0.0, 360.0) * radians_per_degree;
}

int sides_of(double phi_max)
{
    return std::max(3, int(std::ceil(sides_of_circle * phi_max / (2 * std::numbers::pi))));
}

}  // namespace

std::optional<Shape> Reader::sphere(const Parameters& shape, bool has_textures)
{
    const double radius = shape.number("radius", 1), z_min = shape.number("zmin", -radius),
                 z_max = shape.number("zmax", radius), phi_max = phi_max_of(shape);
    if (!(radius > 0)) shape.fail("the radius must be above 0");
    const bool is_whole = z_min <= -radius && z_max >= radius && phi_max >= 2 * std::numbers::pi * (1 - 1e-6);
    if (is_whole && !has_textures) return Shape{Sphere{{0, 0, 0}, state_.reverse ? -radius : radius, {}}, -1, {}};
    const double low = std::acos(std::clamp(std::min(z_min, z_max) / radius, -1.0, 1.0)),
                 high = std::acos(std::clamp(std::max(z_min, z_max) / radius, -1.0, 1.0));
    std::vector<ProfilePoint> profile;
    constexpr int rows = sides_of_circle / 2;
    for (int i = 0; i <= rows; ++i) {
        const double theta = low + (high - low) * i / rows, s = std::sin(theta), c = std::cos(theta);
        profile.push_back({radius * s, radius * c, s, c, 1 - double(i) / rows});
    }
    return add_mesh(turned(profile, phi_max, sides_of(phi_max)), *shape.place().file);
}

std::optional<Shape> Reader::disk(const Parameters& shape, bool has_textures)
{
    const double radius = shape.number("radius", 1), inner = shape.number("innerradius", 0),
                 height = shape.number("height", 0), phi_max = phi_max_of(shape);
    if (!(radius > 0)) shape.fail("the radius must be above 0");
    if (inner <= 0 && phi_max >= 2 * std::numbers::pi * (1 - 1e-6) && !has_textures)
        return Shape{Disk{{0, 0, height}, {0, 0, state_.reverse ? -1.0 : 1.0}, radius}, -1, {}};
    // On disks pbrt's v is 0 at the rim; v is flipped here, because Fathom's v grows downward.
    const std::vector<ProfilePoint> profile = {{radius, height, 0, 1, 1}, {std::max(0.0, inner), height, 0, 1, 0}};
    return add_mesh(turned(profile, phi_max, sides_of(phi_max)), *shape.place().file);
}

std::optional<Shape> Reader::cylinder(const Parameters& shape)
{
    const double radius = shape.number("radius", 1), z_min = shape.number("zmin", -1), z_max = shape.number("zmax", 1),
                 phi_max = phi_max_of(shape);
    if (!(radius > 0) || z_min == z_max) shape.fail("a cylinder needs a radius and a height above 0");
    const std::vector<ProfilePoint> profile = {{radius, std::min(z_min, z_max), 1, 0, 1},
                                               {radius, std::max(z_min, z_max), 1, 0, 0}};
    return add_mesh(turned(profile, phi_max, sides_of(phi_max)), *shape.place().file);
}

}  // namespace fathom::pbrt
