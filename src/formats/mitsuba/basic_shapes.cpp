// SPDX-License-Identifier: Apache-2.0
// Analytic shapes. Textured ones become meshes with Mitsuba's texture coordinates.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "formats/common/texture_walk.h"
#include "formats/mesh/mesh_sides.h"
#include "formats/mesh/surface_of_revolution.h"
#include "formats/mitsuba/reader.h"

namespace fathom::mitsuba {

namespace {

constexpr double circle = 2 * std::numbers::pi;

/// Maps the unit cylinder from (0, 0, 0) to (0, 0, 1) to one between two points. The axes across, from which u is
/// measured, are Mitsuba's (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
Transform between(Vec3d a, Vec3d b, double radius)
{
    const Vec3d along = b - a, w = normalize(along);
    const double sign = std::copysign(1.0, w.z), scale = -1 / (sign + w.z), mixed = w.x * w.y * scale;
    const Vec3d u{1 + sign * w.x * w.x * scale, sign * mixed, -sign * w.x}, v{mixed, sign + w.y * w.y * scale, -w.y};
    Transform t;
    const Vec3d columns[] = {u * radius, v * radius, along, a};
    for (std::size_t c = 0; c < 4; ++c) t.m[0][c] = columns[c].x, t.m[1][c] = columns[c].y, t.m[2][c] = columns[c].z;
    return t;
}

bool has_normal_map(const SceneDescription& scene, const Material& m)
{
    if (m.kind != MaterialKind::mix && m.kind != MaterialKind::two_sided) return m.normal_map.texture >= 0;
    return has_normal_map(scene, scene.materials[std::size_t(m.mixture.material_a)]) ||
           has_normal_map(scene, scene.materials[std::size_t(m.mixture.material_b)]);
}

/// Adds tangents along increasing u, with the bitangent cross(normal, tangent) even if uv is mirrored: Mitsuba's
/// shading frame.
void add_tangents(Mesh& mesh)
{
    std::vector<Vec3d> sums(mesh.positions.size()), normals(mesh.positions.size());
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const std::uint32_t* const t = &mesh.indices[i];
        const auto p = [&](std::size_t k) { return to_double(mesh.positions[t[k]]); };
        const Vec3d a = p(1) - p(0), b = p(2) - p(0);
        const Vec2f o = mesh.uvs[0][t[0]], u = mesh.uvs[0][t[1]], v = mesh.uvs[0][t[2]];
        const double area = double((u.x - o.x) * (v.y - o.y) - (v.x - o.x) * (u.y - o.y));
        const Vec3d along = (a * double(v.y - o.y) - b * double(u.y - o.y)) * (area < 0 ? -1 : 1);
        for (std::size_t k = 0; k < 3; ++k) {
            sums[t[k]] = sums[t[k]] + normalize(along);
            normals[t[k]] = mesh.normals.empty() ? cross(a, b) : to_double(mesh.normals[t[k]]);
        }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const Vec3d n = normalize(normals[i]), t = normalize(sums[i] - n * dot(n, sums[i]));
        mesh.tangents.push_back({float(t.x), float(t.y), float(t.z), 1});
    }
}

}  // namespace

bool mirrors(Object& shape)
{
    return shape.transform("to_world").determinant() < 0;
}

bool Reader::needs_uv(Object& shape)
{
    return reaches_uv(scene_, scene_.materials[std::size_t(material_of_shape(shape))]);
}

Shape Reader::add_textured(Mesh mesh, Object& shape)
{
    if (has_normal_map(scene_, scene_.materials[std::size_t(material_of_shape(shape))])) add_tangents(mesh);
    return add_mesh(std::move(mesh));
}

Shape Reader::rectangle(Object& shape)
{
    const bool flipped = shape.boolean("flip_normals", false);
    if (!needs_uv(shape))
        return flipped ? Shape{Rectangle{{1, -1, 0}, {-2, 0, 0}, {0, 2, 0}}, -1, {}}
                       : Shape{Rectangle{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}, -1, {}};
    // The first image row is at y = -1, unlike on Fathom's rectangles.
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    if (flipped) flip(mesh);
    return add_textured(std::move(mesh), shape);
}

Shape Reader::sphere(Object& shape, Node& node)
{
    // Only spheres are turned inside out by a mirroring transform.
    const bool flipped = shape.boolean("flip_normals", false) != mirrors(shape);
    const double radius = shape.number("radius", 1);
    const Vec3d center = shape.vector("center").value_or(Vec3d{});
    if (!needs_uv(shape)) return Shape{Sphere{center, flipped ? -radius : radius, {}}, -1, {}};
    // u is the azimuth about z; v runs from +z downward.
    constexpr int rows = sides_of_circle / 2;
    std::vector<ProfilePoint> profile;
    for (int i = rows; i >= 0; --i) {
        const double theta = std::numbers::pi * i / rows, s = std::sin(theta), c = std::cos(theta);
        profile.push_back({radius * s, radius * c, s, c, double(i) / rows});
    }
    Mesh mesh = turned(profile, circle, sides_of_circle);
    if (flipped) flip(mesh);
    node.parent_from_node = node.parent_from_node * Transform::translate(center);
    return add_textured(std::move(mesh), shape);
}

Shape Reader::disk(Object& shape)
{
    const bool flipped = shape.boolean("flip_normals", false);
    if (!needs_uv(shape)) return Shape{Disk{{0, 0, 0}, {0, 0, flipped ? -1.0 : 1.0}, 1}, -1, {}};
    // u is the radius, v the azimuth.
    Mesh mesh = turned({{1, 0, 0, 1, 1}, {0, 0, 0, 1, 0}}, circle, sides_of_circle);
    for (Vec2f& uv : mesh.uvs[0]) std::swap(uv.x, uv.y);
    if (flipped) flip(mesh);
    return add_textured(std::move(mesh), shape);
}

Shape Reader::cube(Object& shape)
{
    const bool flipped = shape.boolean("flip_normals", false);
    if (!flipped && !needs_uv(shape)) return Shape{Box{{-1, -1, -1}, {1, 1, 1}}, -1, {}};
    // Each face shows the whole image; corners are listed from (u, v) = (0, 1), against the direction of v.
    constexpr Vec3f corners[6][4] = {
        {{1, -1, -1}, {1, -1, 1}, {-1, -1, 1}, {-1, -1, -1}}, {{1, 1, -1}, {-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}},
        {{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}},     {{1, -1, 1}, {1, 1, 1}, {-1, 1, 1}, {-1, -1, 1}},
        {{-1, -1, 1}, {-1, 1, 1}, {-1, 1, -1}, {-1, -1, -1}}, {{1, 1, -1}, {1, -1, -1}, {-1, -1, -1}, {-1, 1, -1}}};
    Mesh mesh;
    for (const auto& face : corners) {
        const auto first = std::uint32_t(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), std::begin(face), std::end(face));
        mesh.uvs[0].insert(mesh.uvs[0].end(), {{0, 1}, {1, 1}, {1, 0}, {0, 0}});
        for (const std::uint32_t corner : {0u, 1u, 2u, 3u, 0u, 2u}) mesh.indices.push_back(first + corner);
    }
    if (flipped) flip(mesh);
    return add_textured(std::move(mesh), shape);
}

Shape Reader::cylinder(Object& shape, Node& node)
{
    const Vec3d a = shape.vector("p0").value_or(Vec3d{0, 0, 0}), b = shape.vector("p1").value_or(Vec3d{0, 0, 1});
    const double radius = shape.number("radius", 1);
    if (length(b - a) == 0 || !(radius > 0))
        shape.element().fail("a cylinder needs two different points and a radius above 0");
    node.parent_from_node = node.parent_from_node * between(a, b, radius);
    Mesh mesh = turned({{1, 0, 1, 0, 0}, {1, 1, 1, 0, 1}}, circle, sides_of_circle);
    if (shape.boolean("flip_normals", false)) flip(mesh);
    return add_textured(std::move(mesh), shape);
}

}  // namespace fathom::mitsuba
