// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "formats/fathom/fathom_json_reader.h"
#include "scene/enum_names.h"

namespace fathom {

namespace {

Transform read_matrix(const JsonValue& v, bool flat)
{
    v.array(3);
    if (v.size() > 4) v.fail(fmt::format("expected 3 or 4 rows, found {}", v.size()));
    Transform t;
    for (std::size_t row = 0; row < v.size(); ++row) {
        const JsonValue numbers = v[row];
        numbers.array_of(4);
        for (std::size_t column = 0; column < 4; ++column) {
            const double value = numbers[column].number();
            if (row < 3)
                t.m[row][column] = value;
            else if (value != (column == 3 ? 1 : 0))
                numbers.fail("the fourth row must be [0, 0, 0, 1]");
        }
    }
    if (!flat && !std::isnormal(t.determinant())) v.fail("the matrix can't be inverted");
    return t;
}

Transform read_scale(const JsonValue& v)
{
    const Vec3d scale = v.is_number() ? Vec3d{1, 1, 1} * v.number() : v.vec3d();
    if (scale.x == 0 || scale.y == 0 || scale.z == 0)
        v.fail("a scale of 0 flattens the object; use a rectangle or disk");
    return Transform::scale(scale);
}

Sphere read_sphere(const JsonValue& v)
{
    Sphere sphere;
    JsonObject o(v);
    o.read("center", sphere.center);
    o.read("radius", sphere.radius);
    if (sphere.radius == 0) v["radius"].fail("must not be 0");
    if (auto end = o.get("center_end")) sphere.center_end = end->vec3d();
    o.done("in a sphere");
    return sphere;
}

Rectangle read_rectangle(const JsonValue& v)
{
    JsonObject o(v);
    Rectangle rectangle;
    rectangle.corner = o.require("corner").vec3d();
    rectangle.edge_u = o.require("edge_u").vec3d();
    rectangle.edge_v = o.require("edge_v").vec3d();
    if (length(cross(normalize(rectangle.edge_u), normalize(rectangle.edge_v))) < 1e-12)
        v.fail("the edges are parallel, or one of them has zero length");
    o.done("in a rectangle");
    return rectangle;
}

Box read_box(const JsonValue& v)
{
    JsonObject o(v);
    const Box box{o.require("min").vec3d(), o.require("max").vec3d()};
    if (!(box.min.x < box.max.x && box.min.y < box.max.y && box.min.z < box.max.z))
        v.fail("'min' must be less than 'max' along each axis");
    o.done("in a box");
    return box;
}

Disk read_disk(const JsonValue& v)
{
    JsonObject o(v);
    Disk disk;
    o.read("center", disk.center);
    disk.normal = o.require("normal").vec3d();
    if (length(disk.normal) == 0) v["normal"].fail("must not have zero length");
    o.read("radius", disk.radius);
    if (!(disk.radius > 0)) v["radius"].fail("must be greater than 0");
    o.done("in a disk");
    return disk;
}

template <class T>
void read_per_vertex(JsonObject& o, const char* key, T (JsonValue::*read)() const, std::size_t vertices,
                     std::vector<T>& out)
{
    const auto v = o.get(key);
    if (!v) return;
    v->array();
    if (v->size() != vertices)
        v->fail(fmt::format("expected {} elements, one for each of 'positions', found {}", vertices, v->size()));
    out.reserve(vertices);
    for (std::size_t i = 0; i < vertices; ++i) out.push_back(((*v)[i].*read)());
}

void read_indices(JsonObject& o, Mesh& mesh)
{
    const std::size_t vertices = mesh.positions.size();
    const auto v = o.get("indices");
    if (!v) {
        if (vertices % 3 != 0)
            o.value()["positions"].fail(fmt::format(
                "without 'indices', each three positions make a triangle; {} is not a multiple of 3", vertices));
        for (std::size_t i = 0; i < vertices; ++i) mesh.indices.push_back(std::uint32_t(i));
        return;
    }
    v->array(1);
    mesh.indices.reserve(3 * v->size());
    for (std::size_t i = 0; i < v->size(); ++i) {
        const JsonValue triangle = (*v)[i];
        triangle.array_of(3);
        for (std::size_t k = 0; k < 3; ++k) {
            const int index = triangle[k].integer();
            if (index < 0 || std::size_t(index) >= vertices)
                triangle[k].fail(fmt::format("index {} is out of range: there are {} positions", index, vertices));
            mesh.indices.push_back(std::uint32_t(index));
        }
    }
}

void read_mesh(JsonObject& o, Mesh& mesh)
{
    const JsonValue positions = o.require("positions");
    const std::size_t vertices = positions.array(3).size();
    read_per_vertex(o, "positions", &JsonValue::vec3f, vertices, mesh.positions);
    read_per_vertex(o, "normals", &JsonValue::vec3f, vertices, mesh.normals);
    read_per_vertex(o, "tangents", &JsonValue::vec4f, vertices, mesh.tangents);
    read_per_vertex(o, "uvs", &JsonValue::vec2f, vertices, mesh.uvs[0]);
    read_per_vertex(o, "uvs_1", &JsonValue::vec2f, vertices, mesh.uvs[1]);
    read_per_vertex(o, "colors", &JsonValue::vec4f, vertices, mesh.colors);
    read_indices(o, mesh);
}

}  // namespace

std::optional<PlyData> FathomJsonReader::read_data_file(JsonObject& o)
{
    const auto v = o.get("file");
    if (!v) return std::nullopt;
    if (v->string().empty()) v->fail("the path of a file is empty");
    const std::filesystem::path file = file_.parent_path() / v->string();
    InputFile input = context_.open(file);
    return read_ply_data(input);
}

void FathomJsonReader::read_mesh_motion(const JsonValue& v, Mesh& mesh)
{
    const std::size_t vertices = mesh.positions.size();
    read_motion_keys(v, "a mesh's", mesh.motion, [&](JsonObject& o, MeshKey& key) {
        const JsonValue& value = o.value();
        if (auto file = read_data_file(o)) {
            if (file->mesh.positions.size() != vertices)
                value["file"].fail(
                    fmt::format("has {} vertices, but the mesh has {}", file->mesh.positions.size(), vertices));
            key.positions = std::move(file->mesh.positions);
            key.normals = std::move(file->mesh.normals);
        } else {
            read_per_vertex(o, "positions", &JsonValue::vec3f, vertices, key.positions);
            read_per_vertex(o, "normals", &JsonValue::vec3f, vertices, key.normals);
        }
        if (!key.normals.empty() && mesh.normals.empty()) value["normals"].fail("the mesh itself has no 'normals'");
        if (!key.positions.empty() && key.normals.empty() && !mesh.normals.empty())
            value.fail("needs 'normals', since the mesh has them");
        if (key.positions.empty()) key.positions = mesh.positions;
        if (key.normals.empty()) key.normals = mesh.normals;
    });
}

namespace {

/// Reads [x, y, z, radius], or [x, y, z] with the default radius.
void read_ball(const JsonValue& v, float radius, std::vector<Vec3f>& centers, std::vector<float>& radii)
{
    if (v.array(3).size() == 3) {
        centers.push_back(v.vec3f());
        radii.push_back(radius);
        return;
    }
    const Vec4f p = v.vec4f();
    if (p.w < 0) v[3].fail("a radius must not be negative");
    centers.push_back({p.x, p.y, p.z});
    radii.push_back(p.w);
}

float read_radius(JsonObject& o, float radius)
{
    o.read("radius", radius);
    if (!(radius > 0)) o.value()["radius"].fail("must be greater than 0");
    return radius;
}

void read_curves(JsonObject& o, Curves& curves)
{
    const float radius = read_radius(o, 0.001f);
    const JsonValue all = o.require("curves");
    all.array();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const JsonValue curve = all[i];
        const bool linear = curves.basis == CurveBasis::linear;
        curve.array(linear ? 2 : 4);
        if (curves.basis == CurveBasis::bezier && curve.size() % 3 != 1)
            curve.fail(fmt::format("expected 4, 7, 10, ... points, found {}", curve.size()));
        for (std::size_t k = 0; k < curve.size(); ++k) read_ball(curve[k], radius, curves.points, curves.radii);
        curves.counts.push_back(std::uint32_t(curve.size()));
    }
}

/// Reads the points of a motion key. A point without a radius has the radius of the curves; if the file has fewer radii
/// than points, an error is reported later.
void read_curves_of_key(const JsonValue& all, const Curves& curves, CurvesKey& key)
{
    const auto radius_of = [&](std::size_t point) { return point < curves.radii.size() ? curves.radii[point] : 0; };
    if (all.array().size() != curves.counts.size())
        all.fail(fmt::format("has {} curves, but there are {}", all.size(), curves.counts.size()));
    for (std::size_t i = 0; i < all.size(); ++i) {
        const JsonValue curve = all[i];
        if (curve.array().size() != curves.counts[i])
            curve.fail(fmt::format("has {} points, but the curve has {}", curve.size(), curves.counts[i]));
        for (std::size_t k = 0; k < curve.size(); ++k)
            read_ball(curve[k], radius_of(key.radii.size()), key.points, key.radii);
    }
}

void read_points(JsonObject& o, Points& points)
{
    const float radius = read_radius(o, 0.01f);
    const JsonValue all = o.require("points");
    all.array();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const JsonValue point = all[i];
        read_ball(point, radius, points.centers, points.radii);
        if (points.radii.back() == 0) point[3].fail("a radius must be greater than 0");
    }
}

}  // namespace

void FathomJsonReader::read_curves_motion(const JsonValue& v, Curves& curves)
{
    read_motion_keys(v, "curves'", curves.motion, [&](JsonObject& o, CurvesKey& key) {
        if (auto file = read_data_file(o)) {
            if (file->mesh.positions.size() != curves.points.size())
                o.value()["file"].fail(fmt::format("has {} vertices, but the curves have {} points",
                                                   file->mesh.positions.size(), curves.points.size()));
            key.points = std::move(file->mesh.positions);
            key.radii = std::move(file->radii);
        } else if (auto all = o.get("curves")) {
            read_curves_of_key(*all, curves, key);
        } else {
            key.points = curves.points;
        }
        if (key.radii.empty()) key.radii = curves.radii;
    });
}

Transform read_rotation(const JsonValue& v)
{
    JsonObject o(v);
    const Vec3d axis = o.require("axis").vec3d();
    if (length(axis) == 0) v["axis"].fail("must not have zero length");
    const double angle = o.require("angle_deg").number() * std::numbers::pi / 180;
    o.done("in a rotation");
    return Transform::rotate(axis, angle);
}

Transform FathomJsonReader::transform(const JsonValue& v, int depth)
{
    Transform result;
    if (v.is_array()) {
        constexpr int deepest = 32;
        if (depth > deepest) v.fail(fmt::format("arrays of transforms are nested more than {} deep", deepest));
        for (std::size_t i = 0; i < v.size(); ++i) result = transform(v[i], depth + 1) * result;
        return result;
    }
    if (!v.is_object()) v.fail_type("a transform: an object, or an array of them");
    JsonObject o(v);
    if (auto matrix = o.get("matrix")) {
        bool flat = false;
        o.read("flat", flat);
        result = read_matrix(*matrix, flat);
        o.done("beside 'matrix'");
        return result;
    }
    if (auto scale = o.get("scale")) result = read_scale(*scale);
    if (auto rotation = o.get("rotate")) result = read_rotation(*rotation) * result;
    if (auto translation = o.get("translate")) result = Transform::translate(translation->vec3d()) * result;
    o.done("in a transform");
    return result;
}

std::optional<Shape> FathomJsonReader::read_shape(JsonObject& o)
{
    std::optional<Shape> shape;
    const auto set = [&](const JsonValue& v, auto geometry) {
        if (shape) v.fail("a node can have only one shape; put others into 'children'");
        shape.emplace();
        shape->geometry = geometry;
    };
    if (auto v = o.get("sphere")) set(*v, read_sphere(*v));
    if (auto v = o.get("rectangle")) set(*v, read_rectangle(*v));
    if (auto v = o.get("box")) set(*v, read_box(*v));
    if (auto v = o.get("disk")) set(*v, read_disk(*v));
    if (auto v = o.get("mesh")) set(*v, MeshInstance{data(*v, meshes_, "meshes", "mesh", &FathomJsonReader::add_mesh)});
    if (auto v = o.get("curves"))
        set(*v, CurvesInstance{data(*v, curves_, "curves", "curves", &FathomJsonReader::add_curves)});
    if (auto v = o.get("points"))
        set(*v, PointsInstance{data(*v, points_, "points", "points", &FathomJsonReader::add_points)});
    return shape;
}

int FathomJsonReader::data(const JsonValue& v, const std::map<std::string, int>& named, const char* table_name,
                           const char* what, Add add)
{
    if (v.is_object()) return (this->*add)(v, "");
    if (!v.is_string()) v.fail_type(fmt::format("the name of a {0}, or a {0}", what).c_str());
    if (const auto found = named.find(v.string()); found != named.end()) return found->second;
    find(table_name, what, v);
    return named.at(v.string());
}

int FathomJsonReader::add_mesh(const JsonValue& v, const std::string& name)
{
    Mesh mesh;
    mesh.name = name;
    JsonObject o(v);
    if (auto file = read_data_file(o)) {
        mesh = std::move(file->mesh);
        mesh.name = name;
    } else {
        read_mesh(o, mesh);
    }
    if (auto motion = o.get("motion")) read_mesh_motion(*motion, mesh);
    o.done("in a mesh");
    scene_.meshes.push_back(std::move(mesh));
    return int(scene_.meshes.size()) - 1;
}

int FathomJsonReader::add_curves(const JsonValue& v, const std::string& name)
{
    Curves curves;
    curves.name = name;
    JsonObject o(v);
    o.read_word("basis", words::curve_bases, curves.basis);
    o.read_word("style", words::curve_styles, curves.ribbons);
    if (auto file = read_data_file(o)) {
        curves.points = std::move(file->mesh.positions);
        curves.radii = std::move(file->radii);
        curves.counts = std::move(file->curve_counts);
    } else {
        read_curves(o, curves);
    }
    if (auto motion = o.get("motion")) read_curves_motion(*motion, curves);
    o.done("in curves");
    scene_.curves.push_back(std::move(curves));
    return int(scene_.curves.size()) - 1;
}

int FathomJsonReader::add_points(const JsonValue& v, const std::string& name)
{
    Points points;
    points.name = name;
    JsonObject o(v);
    if (auto file = read_data_file(o)) {
        points.centers = std::move(file->mesh.positions);
        points.radii = std::move(file->radii);
    } else {
        read_points(o, points);
    }
    o.done("in points");
    scene_.points.push_back(std::move(points));
    return int(scene_.points.size()) - 1;
}

}  // namespace fathom
