// Spheres, disks, cylinders, and parts of them.
#include "import/pbrt/round_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "import/pbrt/reader.h"

namespace fathom::pbrt {

namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr int sides_of_circle = 256;

double phi_max_of(const Parameters& shape)
{
    return std::clamp(shape.number("phimax", 360), 0.0, 360.0) * degree;
}

int sides_of(double phi_max)
{
    return std::max(3, int(std::ceil(sides_of_circle * phi_max / (2 * std::numbers::pi))));
}

}  // namespace

Mesh turned(const std::vector<ProfilePoint>& profile, double phi_max, int sides)
{
    Mesh mesh;
    const auto rows = std::uint32_t(profile.size());
    for (int i = 0; i <= sides; ++i) {
        const double phi = phi_max * i / sides, c = std::cos(phi), s = std::sin(phi);
        for (const ProfilePoint& p : profile) {
            mesh.positions.push_back({float(p.radius * c), float(p.radius * s), float(p.z)});
            mesh.normals.push_back({float(p.normal_radius * c), float(p.normal_radius * s), float(p.normal_z)});
            mesh.uvs[0].push_back({float(i) / float(sides), 1 - float(p.v)});
        }
    }
    for (std::uint32_t i = 0; i < std::uint32_t(sides); ++i)
        for (std::uint32_t j = 0; j + 1 < rows; ++j) {
            const std::uint32_t a = i * rows + j, b = a + rows;
            for (std::uint32_t corner : {a, b, b + 1, a, b + 1, a + 1}) mesh.indices.push_back(corner);
        }
    return mesh;
}

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
        profile.push_back({radius * s, radius * c, s, c, double(i) / rows});
    }
    return add_mesh(turned(profile, phi_max, sides_of(phi_max)), shape.title());
}

std::optional<Shape> Reader::disk(const Parameters& shape, bool has_textures)
{
    const double radius = shape.number("radius", 1), inner = shape.number("innerradius", 0),
                 height = shape.number("height", 0), phi_max = phi_max_of(shape);
    if (!(radius > 0)) shape.fail("the radius must be above 0");
    if (inner <= 0 && phi_max >= 2 * std::numbers::pi * (1 - 1e-6) && !has_textures)
        return Shape{Disk{{0, 0, height}, {0, 0, state_.reverse ? -1.0 : 1.0}, radius}, -1, {}};
    // v is 0 at the rim.
    const std::vector<ProfilePoint> profile = {{radius, height, 0, 1, 0}, {std::max(0.0, inner), height, 0, 1, 1}};
    return add_mesh(turned(profile, phi_max, sides_of(phi_max)), shape.title());
}

std::optional<Shape> Reader::cylinder(const Parameters& shape)
{
    const double radius = shape.number("radius", 1), z_min = shape.number("zmin", -1), z_max = shape.number("zmax", 1),
                 phi_max = phi_max_of(shape);
    if (!(radius > 0) || z_min == z_max) shape.fail("a cylinder has a radius and a height above 0");
    const std::vector<ProfilePoint> profile = {{radius, std::min(z_min, z_max), 1, 0, 0},
                                               {radius, std::max(z_min, z_max), 1, 0, 1}};
    return add_mesh(turned(profile, phi_max, sides_of(phi_max)), shape.title());
}

}  // namespace fathom::pbrt
