// SPDX-License-Identifier: Apache-2.0
// Reading of shapes and their transforms.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fathom/error.h"
#include "formats/common/texture_walk.h"
#include "formats/io/gunzip.h"
#include "formats/io/read_file.h"
#include "formats/mesh/mesh_cleanup.h"
#include "formats/mesh/mesh_sides.h"
#include "formats/mesh/vertex_normals.h"
#include "formats/pbrt/default_uvs.h"
#include "formats/pbrt/loop_subdivision.h"
#include "formats/pbrt/reader.h"
#include "formats/ply/ply.h"

namespace fathom::pbrt {

namespace {

constexpr std::size_t max_subdivided = 12'000'000;

void flip_v(Mesh& mesh)
{
    for (Vec2f& uv : mesh.uvs[0]) uv.y = 1 - uv.y;
}

std::vector<std::uint32_t> indices_of(const Parameters& shape, std::size_t vertices, std::size_t group)
{
    const std::vector<std::int32_t> said = shape.integers("indices");
    std::vector<std::uint32_t> indices;
    indices.reserve(said.size());
    if (said.size() % group != 0)
        shape.fail(fmt::format("'indices' has {} numbers: not a multiple of {}", said.size(), group));
    for (const std::int32_t i : said) {
        if (i < 0 || std::size_t(i) >= vertices)
            shape.fail(fmt::format("there is no vertex {}: 'P' has {}", i, vertices));
        indices.push_back(std::uint32_t(i));
    }
    if (said.empty() && !shape.has("indices") && vertices == group)
        for (std::uint32_t i = 0; i < group; ++i) indices.push_back(i);
    if (indices.empty()) shape.fail("it needs 'indices'");
    return indices;
}

/// Positions, normals and texture coordinates of a mesh, as in the file.
Mesh vertices_of(const Parameters& shape)
{
    Mesh mesh;
    mesh.positions = shape.vectors("P");
    if (mesh.positions.empty()) shape.fail("it needs 'P'");
    for (const Vec3f& p : mesh.positions)
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) shape.fail("'P' is not finite");
    mesh.normals = shape.vectors("N");
    mesh.uvs[0] = shape.points2("uv");
    for (const auto& [name, size] : {std::pair{"N", mesh.normals.size()}, std::pair{"uv", mesh.uvs[0].size()}})
        if (size != 0 && size != mesh.positions.size())
            shape.fail(fmt::format("'{}' has {} elements, 'P' {}", name, size, mesh.positions.size()));
    return mesh;
}

PlyData ply_data_of(InputFile file)
{
    if (!is_gzip(file.head())) return read_ply_data(file);
    InputFile unpacked(file.name(), gunzip(file.name(), file.bytes()));
    return read_ply_data(unpacked);
}

}  // namespace

Shape Reader::add_mesh(Mesh mesh, const std::string& file)
{
    // In pbrt a triangle faces the side of its vertex normals, independent of the order of its corners.
    orient_to_normals(mesh);
    if (state_.reverse) flip(mesh);
    clean_mesh(mesh, file, context_.mesh_faults);
    scene_.meshes.push_back(std::move(mesh));
    return {MeshInstance{int(scene_.meshes.size()) - 1}, -1, {}};
}

bool Reader::needs_uv(const Surface& surface)
{
    return reaches_uv(scene_, material(surface.material)) || !surface.alpha.empty() || !surface.displacement.empty() ||
           (surface.light && surface.light->has("filename"));
}

std::optional<Shape> Reader::triangle_mesh(const Parameters& shape, const Surface& surface)
{
    Mesh mesh = vertices_of(shape);
    mesh.indices = indices_of(shape, mesh.positions.size(), 3);
    flip_v(mesh);
    if (mesh.uvs[0].empty() && needs_uv(surface)) add_default_uvs(mesh, {});
    // Fathom derives tangents from texture coordinates.
    shape.ignore({"S", "faceIndices"});
    return add_mesh(std::move(mesh), *shape.place().file);
}

std::optional<Shape> Reader::ply_mesh(const Parameters& shape, Surface& surface)
{
    const std::string filename = shape.text("filename", "");
    if (filename.empty()) shape.fail("it needs a 'filename'");
    if (shape.has("displacement")) {
        surface.displacement = shape.text("displacement", "");
        surface.displacement_edge = float(shape.number("edgelength", 1));
    }
    shape.ignore({"edgelength"});
    const std::filesystem::path path = locate(shape, filename);
    const bool has_uv = needs_uv(surface);
    const std::string key = fmt::format("{}\n{}{}", path.string(), int(state_.reverse), int(has_uv));
    if (const auto known = models_.find(key); known != models_.end()) return Shape{MeshInstance{known->second}, -1, {}};
    try {
        PlyData data = ply_data_of(context_.open(path));
        if (data.mesh.indices.empty()) throw Error(path.string(), "", "it contains no faces");
        data.mesh.colors.clear();
        if (data.mesh.uvs[0].empty() && has_uv) add_default_uvs(data.mesh, data.quads);
        Shape result = add_mesh(std::move(data.mesh), path.string());
        models_[key] = std::get<MeshInstance>(result.geometry).mesh;
        return result;
    } catch (const Error& error) {
        shape.place().fail(error.what());
    }
}

std::optional<Shape> Reader::bilinear_mesh(const Parameters& shape)
{
    const Mesh corners = vertices_of(shape);
    const std::vector<std::uint32_t> indices = indices_of(shape, corners.positions.size(), 4);
    if (shape.has("emissionfilename")) {
        report(shape, "'emissionfilename' is ignored");
        shape.ignore({"emissionfilename"});
    }
    shape.ignore({"faceIndices"});
    Mesh mesh;
    for (std::size_t i = 0; i + 3 < indices.size(); i += 4) {
        const std::uint32_t* const q = &indices[i];
        const auto mixed = [&](const auto& of, double u, double v) {
            return of(q[0]) * ((1 - u) * (1 - v)) + of(q[1]) * (u * (1 - v)) + of(q[2]) * ((1 - u) * v) +
                   of(q[3]) * (u * v);
        };
        const auto position = [&](std::uint32_t k) { return to_double(corners.positions[k]); };
        const Vec3d twist = position(q[0]) - position(q[1]) - position(q[2]) + position(q[3]);
        const bool is_flat = length(twist) < 1e-6 * (length(position(q[3]) - position(q[0])) + 1e-30);
        const std::uint32_t steps = is_flat ? 1 : 16, first = std::uint32_t(mesh.positions.size());
        for (std::uint32_t y = 0; y <= steps; ++y)
            for (std::uint32_t x = 0; x <= steps; ++x) {
                const double u = double(x) / steps, v = double(y) / steps;
                mesh.positions.push_back(to_float(mixed(position, u, v)));
                const auto uv = [&](std::uint32_t k) { return Vec3d{corners.uvs[0][k].x, corners.uvs[0][k].y, 0}; };
                const Vec3d at = corners.uvs[0].empty() ? Vec3d{u, v, 0} : mixed(uv, u, v);
                mesh.uvs[0].push_back({float(at.x), 1 - float(at.y)});
                const Vec3d du = (position(q[1]) - position(q[0])) * (1 - v) + (position(q[3]) - position(q[2])) * v,
                            dv = (position(q[2]) - position(q[0])) * (1 - u) + (position(q[3]) - position(q[1])) * u;
                const auto normal = [&](std::uint32_t k) { return to_double(corners.normals[k]); };
                mesh.normals.push_back(
                    to_float(normalize(corners.normals.empty() ? cross(du, dv) : mixed(normal, u, v))));
            }
        for (std::uint32_t y = 0; y < steps; ++y)
            for (std::uint32_t x = 0; x < steps; ++x) {
                const std::uint32_t a = first + y * (steps + 1) + x, b = a + steps + 1;
                for (std::uint32_t corner : {a, a + 1, b + 1, a, b + 1, b}) mesh.indices.push_back(corner);
            }
    }
    return add_mesh(std::move(mesh), *shape.place().file);
}

std::optional<Shape> Reader::loop_mesh(const Parameters& shape, const Surface& surface)
{
    const Mesh base = vertices_of(shape);
    const std::vector<std::uint32_t> indices = indices_of(shape, base.positions.size(), 3);
    const int levels = shape.integer("levels", 3);
    if (levels < 0 || levels > 12 || double(indices.size()) * std::pow(4, levels) > double(max_subdivided))
        shape.fail(fmt::format("'levels' is too large: more than {} corners of triangles", max_subdivided));
    shape.ignore({"scheme"});
    Mesh mesh = loop_subdivided(base.positions, indices, levels);
    set_vertex_normals(mesh, NormalWeight::area);
    if (needs_uv(surface)) add_default_uvs(mesh, {});
    return add_mesh(std::move(mesh), *shape.place().file);
}

namespace {

/// Converts a quadratic B-spline to Bezier segments, which join at the midpoints of the control polygon.
std::vector<Vec3f> quadratic_bezier(const Parameters& shape, const std::vector<Vec3f>& points)
{
    if (points.size() < 3) shape.fail("a quadratic 'bspline' needs at least three points");
    const auto middle = [&](std::size_t i) {
        return to_float((to_double(points[i]) + to_double(points[i + 1])) * 0.5);
    };
    std::vector<Vec3f> result{middle(0)};
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        result.push_back(points[i]);
        result.push_back(middle(i));
    }
    return result;
}

/// Converts a cubic B-spline to Bezier segments.
std::vector<Vec3f> cubic_bezier(const Parameters& shape, const std::vector<Vec3f>& points)
{
    if (points.size() < 4) shape.fail("a 'bspline' needs at least four points");
    const auto at = [&](std::size_t i) { return to_double(points[i]); };
    std::vector<Vec3f> result{to_float((at(0) + at(1) * 4 + at(2)) * (1.0 / 6))};
    for (std::size_t i = 1; i + 2 < points.size(); ++i) {
        result.push_back(to_float((at(i) * 2 + at(i + 1)) * (1.0 / 3)));
        result.push_back(to_float((at(i) + at(i + 1) * 2) * (1.0 / 3)));
        result.push_back(to_float((at(i) + at(i + 1) * 4 + at(i + 2)) * (1.0 / 6)));
    }
    return result;
}

}  // namespace

std::optional<Shape> Reader::curve(const Parameters& shape)
{
    Curves curves;
    curves.points = shape.vectors("P");
    const int degree = shape.integer("degree", 3);
    const std::string basis = shape.text("basis", "bezier"), type = shape.text("type", "flat");
    if (degree != 2 && degree != 3) shape.fail("'degree' must be 2 or 3");
    if (basis != "bezier" && basis != "bspline") shape.fail("'basis' must be 'bezier' or 'bspline'");
    const double width = shape.number("width", 1), first = shape.number("width0", width),
                 last = shape.number("width1", width);
    // Widths vary linearly along the curve, which B-spline control points can't express unless they are constant.
    const bool is_bezier = basis == "bezier" || degree == 2 || first != last;
    if (basis == "bspline" && is_bezier)
        curves.points = degree == 2 ? quadratic_bezier(shape, curves.points) : cubic_bezier(shape, curves.points);
    if (degree == 2) {
        // Degree elevation from quadratic to cubic.
        std::vector<Vec3f> cubic;
        for (std::size_t i = 0; i + 2 < curves.points.size(); i += 2) {
            const Vec3d a = to_double(curves.points[i]), b = to_double(curves.points[i + 1]),
                        c = to_double(curves.points[i + 2]);
            if (i == 0) cubic.push_back(to_float(a));
            cubic.push_back(to_float(a + (b - a) * (2.0 / 3)));
            cubic.push_back(to_float(c + (b - c) * (2.0 / 3)));
            cubic.push_back(to_float(c));
        }
        if (curves.points.size() % 2 != 1) shape.fail("a quadratic curve must have 3, 5, 7, ... points");
        curves.points = std::move(cubic);
    }
    const std::size_t n = curves.points.size();
    if (n < 4 || (is_bezier && n % 3 != 1))
        shape.fail(fmt::format("a curve has {} points, but needs 4, 7, 10, ..., or at least 4 for a 'bspline'", n));
    curves.basis = is_bezier ? CurveBasis::bezier : CurveBasis::bspline;
    curves.ribbons = type != "cylinder";
    if (type == "ribbon") {
        report(shape, "'N' of a ribbon is ignored: ribbons face each ray");
        shape.ignore({"N"});
    }
    for (std::size_t i = 0; i < n; ++i)
        curves.radii.push_back(float((first + (last - first) * double(i) / double(n - 1)) / 2));
    curves.counts = {std::uint32_t(n)};
    shape.ignore({"splitdepth"});
    scene_.curves.push_back(std::move(curves));
    return Shape{CurvesInstance{int(scene_.curves.size()) - 1}, -1, {}};
}

std::optional<Shape> Reader::geometry(const Parameters& shape, Surface& surface)
{
    const std::string& type = shape.plugin();
    if (type == "trianglemesh") return triangle_mesh(shape, surface);
    if (type == "plymesh") return ply_mesh(shape, surface);
    if (type == "bilinearmesh") return bilinear_mesh(shape);
    if (type == "loopsubdiv") return loop_mesh(shape, surface);
    if (type == "curve") return curve(shape);
    const bool has_textures = needs_uv(surface);
    if (type == "sphere") return sphere(shape, has_textures);
    if (type == "disk") return disk(shape, has_textures);
    if (type == "cylinder") return cylinder(shape);
    report(shape, "is not supported and is ignored");
    return std::nullopt;
}

double Reader::area_of(const Shape& shape, const Transform& world) const
{
    const double scale = std::pow(std::abs(world.determinant()), 2.0 / 3);
    if (const auto* sphere = std::get_if<Sphere>(&shape.geometry))
        return 4 * std::numbers::pi * sphere->radius * sphere->radius * scale;
    if (const auto* disk = std::get_if<Disk>(&shape.geometry))
        return std::numbers::pi * disk->radius * disk->radius * scale;
    const auto* instance = std::get_if<MeshInstance>(&shape.geometry);
    if (!instance) return 0;
    const Mesh& mesh = scene_.meshes[std::size_t(instance->mesh)];
    double sum = 0;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        Vec3d p[3];
        for (std::size_t k = 0; k < 3; ++k) p[k] = world.point(to_double(mesh.positions[mesh.indices[i + k]]));
        sum += length(cross(p[1] - p[0], p[2] - p[0])) / 2;
    }
    return sum;
}

const Parameters* Reader::medium(const Place& place, const std::string& name) const
{
    if (name.empty()) return nullptr;
    const auto found = media_.find(name);
    if (found == media_.end()) place.fail(fmt::format("there is no medium '{}'", printable(name)));
    return found->second.get();
}

/// Fathom derives the medium outside from the interiors of other shapes and the camera's medium.
void Reader::set_media(const Place& place, Surface& surface)
{
    const Parameters *const inside = medium(place, state_.inside), *const outside = medium(place, state_.outside);
    media_of_shapes_.add(inside, outside);
    if (inside == outside) return;
    surface.medium = inside;
    surface.is_vacuum_interior = !inside;
}

/// Adds a node with the current transform to the current object or to the scene's roots.
void Reader::place(Node node)
{
    const auto& [start, end] = state_.ctm;
    node.parent_from_node = start;
    if (start.m != end.m && times_[1] > times_[0]) {
        const double a = start.determinant(), b = end.determinant();
        if (std::isnormal(a) && std::isnormal(b) && (a < 0) == (b < 0))
            node.motion = {{times_[0], start}, {times_[1], end}};
    }
    (current_object_ ? *current_object_ : scene_.roots).push_back(add_node(std::move(node)));
}

void Reader::read_shape(const Parameters& shape)
{
    if (!in_world_) shape.fail("shapes must follow WorldBegin");
    Surface surface;
    surface.material = state_material(shape.place());
    set_media(shape.place(), surface);
    surface.light = state_.area_light.get();
    if (surface.light && current_object_) {
        report(shape, "pbrt ignores area lights in object instances: the shape does not emit light");
        surface.light = nullptr;
    }
    FloatInput alpha{1, -1, 1};
    if (shape.has("alpha")) {
        alpha = number_or_texture(shape, "alpha", 1);
        surface.alpha = fmt::format("{} {}", alpha.value, alpha.texture);
    }
    std::optional<Shape> found = geometry(shape, surface);
    shape.finish(reporter_);
    if (!found) return;
    if (surface.light) {
        const double power = surface.light->number("power", -1);
        const double sides = surface.light->boolean("twosided", false) ? 2 : 1;
        const double area = area_of(*found, state_.ctm[0]);
        if (power > 0 && area > 0) surface.power_factor = float(power / (sides * std::numbers::pi * area));
    }
    const bool is_new = !surfaces_.contains(surface);
    found->material = surface_material(surface);
    Material& material = scene_.materials[std::size_t(found->material)];
    const bool is_unseen = alpha.texture < 0 && alpha.value == 0;
    if (is_new && surface.light && is_unseen) {
        // An emissive shape of alpha 0 illuminates the scene in pbrt, but no ray hits it.
        material.visibility.invisible_light = true;
    } else if (is_new && !surface.alpha.empty() && (alpha.texture >= 0 || alpha.value < 1)) {
        material.opacity.mode = AlphaMode::blend;
        material.opacity.alpha = alpha;
    }
    if (is_new && !surface.displacement.empty()) {
        const FloatInput height = number_or_texture(shape, "displacement", 0);
        material.displacement.height = height;
        material.displacement.edge_length = surface.displacement_edge;
    }
    Node node;
    node.shapes.push_back(*std::move(found));
    place(std::move(node));
}

}  // namespace fathom::pbrt
