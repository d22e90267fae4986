// SPDX-License-Identifier: Apache-2.0
#include "scene/tessellate.h"

#include <cmath>
#include <numbers>

namespace fathom {

namespace {

constexpr int around = 256, from_pole_to_pole = 128;

Mesh sphere_mesh(const Sphere& sphere)
{
    Mesh mesh;
    for (int j = 0; j <= from_pole_to_pole; ++j)
        for (int i = 0; i <= around; ++i) {
            const double u = double(i) / around, v = double(j) / from_pole_to_pole;
            // Vertices at the seam and at the poles must coincide exactly: otherwise displacement would open cracks.
            const double phi = 2 * std::numbers::pi * (i % around) / around, theta = std::numbers::pi * v;
            const double sine = j % from_pole_to_pole == 0 ? 0 : std::sin(theta);
            const Vec3d n{sine * std::cos(phi), std::cos(theta), -sine * std::sin(phi)};
            mesh.positions.push_back(to_float(sphere.center + n * std::abs(sphere.radius)));
            mesh.normals.push_back(to_float(sphere.radius < 0 ? -n : n));
            mesh.uvs[0].push_back({float(u), float(v)});
        }
    for (std::uint32_t j = 0; j < from_pole_to_pole; ++j)
        for (std::uint32_t i = 0; i < around; ++i) {
            const std::uint32_t a = j * (around + 1) + i, b = a + 1, c = a + around + 1, d = c + 1;
            const auto add = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
                if (sphere.radius < 0) std::swap(q, r);
                mesh.indices.insert(mesh.indices.end(), {p, q, r});
            };
            if (j > 0) add(a, c, b);
            if (j + 1 < from_pole_to_pole) add(b, c, d);
        }
    return mesh;
}

Mesh disk_mesh(const Disk& disk)
{
    Mesh mesh;
    const Vec3d n = normalize(disk.normal);
    // This is the basis of Frame, whose axes define uv on an analytic disk.
    const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
    const Vec3d s{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, t{b, sign + n.y * n.y * a, -n.y};
    mesh.positions.push_back(to_float(disk.center));
    mesh.uvs[0].push_back({0.5f, 0.5f});
    for (std::uint32_t i = 0; i < around; ++i) {
        const double phi = 2 * std::numbers::pi * i / around;
        mesh.positions.push_back(to_float(disk.center + (s * std::cos(phi) + t * std::sin(phi)) * disk.radius));
        mesh.uvs[0].push_back({float(0.5 + 0.5 * std::cos(phi)), float(0.5 - 0.5 * std::sin(phi))});
        mesh.indices.insert(mesh.indices.end(), {0, i + 1, (i + 1) % around + 1});
    }
    return mesh;
}

/// Adds a rectangle whose images are upright: edge_v points up, v grows downward.
void add_rectangle(Mesh& mesh, const Rectangle& r)
{
    const auto first = std::uint32_t(mesh.positions.size());
    for (const Vec3d& p : {r.corner, r.corner + r.edge_u, r.corner + r.edge_u + r.edge_v, r.corner + r.edge_v})
        mesh.positions.push_back(to_float(p));
    mesh.uvs[0].insert(mesh.uvs[0].end(), {{0, 1}, {1, 1}, {1, 0}, {0, 0}});
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + i);
}

/// A box whose faces have the order and the edges of the analytic box.
Mesh box_mesh(const Box& box)
{
    const Vec3d d = box.max - box.min, x{d.x, 0, 0}, y{0, d.y, 0}, z{0, 0, d.z};
    Mesh mesh;
    for (const Rectangle& face : {Rectangle{box.min, z, y}, Rectangle{box.min + x, y, z}, Rectangle{box.min, x, z},
                                  Rectangle{box.min + y, z, x}, Rectangle{box.min, y, x}, Rectangle{box.min + z, x, y}})
        add_rectangle(mesh, face);
    return mesh;
}

}  // namespace

Mesh tessellate(const decltype(Shape::geometry)& geometry)
{
    if (const auto* sphere = std::get_if<Sphere>(&geometry)) return sphere_mesh(*sphere);
    if (const auto* disk = std::get_if<Disk>(&geometry)) return disk_mesh(*disk);
    if (const auto* box = std::get_if<Box>(&geometry)) return box_mesh(*box);
    Mesh mesh;
    if (const auto* rectangle = std::get_if<Rectangle>(&geometry)) add_rectangle(mesh, *rectangle);
    return mesh;
}

}  // namespace fathom
