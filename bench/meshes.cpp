// SPDX-License-Identifier: Apache-2.0
#include "meshes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace fathom::bench {

namespace {

void finish(Mesh& mesh)
{
    GeometryTables& t = mesh.tables;
    t.shapes.emplace_back();
    t.world_triangles = t.triangle_count();
    t.shape_of_primitive.assign(t.triangle_count(), 0);
}

View framing(const GeometryTables& tables)
{
    Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    for (const Vec3f& p : tables.positions) {
        low = {std::min(low.x, double(p.x)), std::min(low.y, double(p.y)), std::min(low.z, double(p.z))};
        high = {std::max(high.x, double(p.x)), std::max(high.y, double(p.y)), std::max(high.z, double(p.z))};
    }
    const Vec3d center = (low + high) * 0.5;
    View view;
    view.look_at = center;
    view.position = center + Vec3d{0.5, 0.4, 0.76} * (length(high - low) * 0.9);
    return view;
}

struct Property {
    std::string name, type, count_type;  ///< type of a list's length
};

std::size_t size_of(const std::string& type)
{
    if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
    if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
    if (type == "double" || type == "float64") return 8;
    return 4;
}

double number(const char* p, const std::string& type)
{
    const auto as = [p](auto x) {
        std::memcpy(&x, p, sizeof x);
        return double(x);
    };
    if (type == "uchar" || type == "uint8") return as(std::uint8_t());
    if (type == "char" || type == "int8") return as(std::int8_t());
    if (type == "ushort" || type == "uint16") return as(std::uint16_t());
    if (type == "short" || type == "int16") return as(std::int16_t());
    if (type == "uint" || type == "uint32") return as(std::uint32_t());
    if (type == "int" || type == "int32") return as(std::int32_t());
    if (type == "double" || type == "float64") return as(double());
    return as(float());
}

double next_number(std::istream& in, const std::string& type)
{
    char bytes[8] = {};
    if (!in.read(bytes, std::streamsize(size_of(type)))) throw std::runtime_error("the file is truncated");
    return number(bytes, type);
}

std::string stem(const std::string& path)
{
    const std::size_t slash = path.find_last_of('/'), from = slash == std::string::npos ? 0 : slash + 1;
    return path.substr(from, path.find_last_of('.') - from);
}

/// Smooth noise of period 1, from hashed heights.
double noise(double x, double y, std::uint32_t seed)
{
    const auto hash = [seed](std::int64_t i, std::int64_t j) {
        auto h = std::uint32_t(i * 374761393 + j * 668265263) ^ seed * 2246822519u;
        h = (h ^ h >> 13) * 1274126177u;
        return double(h ^ h >> 16) / 4294967296.0;
    };
    const double i = std::floor(x), j = std::floor(y);
    const auto ease = [](double s) { return s * s * (3 - 2 * s); };
    const double u = ease(x - i), v = ease(y - j);
    const auto at = [&](int a, int b) { return hash(std::int64_t(i) + a, std::int64_t(j) + b); };
    return (at(0, 0) * (1 - u) + at(1, 0) * u) * (1 - v) + (at(0, 1) * (1 - u) + at(1, 1) * u) * v;
}

double height(double x, double y)
{
    double sum = 0, scale = 1;
    for (std::uint32_t octave = 0; octave < 9; ++octave, scale *= 0.5)
        sum += scale * noise(x * 6 / scale, y * 6 / scale, octave);
    return 200 * sum * sum / 4;
}

void make_terrain(Mesh& mesh, std::size_t triangles)
{
    GeometryTables& t = mesh.tables;
    const std::size_t n = std::size_t(std::sqrt(double(triangles) / 2));
    for (std::size_t i = 0; i <= n; ++i)
        for (std::size_t j = 0; j <= n; ++j) {
            const double x = double(i) / double(n), y = double(j) / double(n);
            t.positions.push_back({float(2000 * (x - 0.5)), float(height(x, y)), float(2000 * (y - 0.5))});
        }
    const auto at = [n](std::size_t i, std::size_t j) { return std::uint32_t(i * (n + 1) + j); };
    t.triangles.reserve(6 * n * n);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            for (std::uint32_t v : {at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1), at(i + 1, j), at(i, j + 1)})
                t.triangles.push_back(v);
    mesh.view = {{-700, 330, -800}, {0, 60, 0}, {0, 1, 0}, 60};
}

void make_boulder(Mesh& mesh, std::size_t triangles)
{
    GeometryTables& t = mesh.tables;
    const std::size_t n = std::size_t(std::sqrt(double(triangles) / 4));  // number of rows; there are twice as many
                                                                          // columns
    const double pi = 3.14159265358979;
    for (std::size_t i = 0; i <= n; ++i)
        for (std::size_t j = 0; j <= 2 * n; ++j) {
            const double theta = pi * double(i) / double(n), phi = pi * double(j % (2 * n)) / double(n);
            const Vec3d d{std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
            const double r = 30 + 0.1 * (height(d.x + 2 + d.y * 0.3, d.z + 2) + height(d.y + 3, d.z - d.x * 0.4 + 3));
            t.positions.push_back({float(r * d.x), float(0.8 * r * d.y), float(r * d.z)});
        }
    const auto at = [n](std::size_t i, std::size_t j) { return std::uint32_t(i * (2 * n + 1) + j); };
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < 2 * n; ++j)
            for (std::uint32_t v : {at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1), at(i, j + 1), at(i + 1, j)})
                t.triangles.push_back(v);
    mesh.view = framing(t);
}

void make_foliage(Mesh& mesh, std::size_t triangles)
{
    // The mesh has bunches of blades, each a strip of three slivers.
    GeometryTables& t = mesh.tables;
    std::uint64_t state = 99;
    const auto uniform = [&state](double low, double high) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return low + (high - low) * double(state >> 40) / double(1 << 24);
    };
    const std::size_t blades = triangles / 3;
    Vec3d root;
    for (std::size_t i = 0; i < blades; ++i) {
        if (i % 60 == 0) root = {uniform(-100, 100), uniform(0, 60), uniform(-100, 100)};
        Vec3d p = root + Vec3d{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        Vec3d along = normalize({uniform(-1, 1), uniform(-0.3, 1), uniform(-1, 1)}) * uniform(1.5, 4);
        const Vec3d across =
            normalize(cross(along, {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)})) * uniform(0.03, 0.12);
        const auto first = std::uint32_t(t.positions.size());
        for (int k = 0; k < 5; ++k) {
            const Vec3d q = p + across * (k % 2 ? 1 : -1) * (1 - k / 5.0);
            t.positions.push_back({float(q.x), float(q.y), float(q.z)});
            p = p + along * 0.25;
            along.y -= 0.15;
        }
        for (std::uint32_t k = 0; k < 3; ++k)
            for (std::uint32_t v : {0u, 1u, 2u}) t.triangles.push_back(first + k + v);
    }
    mesh.view = {{-130, 45, -150}, {0, 25, 0}, {0, 1, 0}, 60};
}

}  // namespace

Mesh read_ply(const std::string& path)
{
    std::ifstream in(path, std::ios::binary);
    if (!in) throw std::runtime_error(path + ": can't be read");
    std::string line, word;
    std::size_t vertices = 0, faces = 0;
    std::vector<Property> of_vertex, of_face;
    std::vector<Property>* properties = nullptr;
    while (std::getline(in, line) && line.substr(0, 10) != "end_header") {
        std::istringstream words(line);
        words >> word;
        if (word == "format" && (words >> word, word != "binary_little_endian"))
            throw std::runtime_error(path + ": only binary_little_endian is read here");
        if (word == "element") {
            std::size_t count = 0;
            words >> word >> count;
            (word == "vertex" ? vertices : faces) = count;
            properties = word == "vertex" ? &of_vertex : &of_face;
        }
        if (word == "property" && properties) {
            Property p;
            words >> p.type;
            if (p.type == "list") words >> p.count_type >> p.type;
            words >> p.name;
            properties->push_back(p);
        }
    }
    Mesh mesh;
    mesh.name = stem(path);
    for (std::size_t i = 0; i < vertices; ++i) {
        Vec3f p;
        for (const Property& property : of_vertex) {
            const auto x = float(next_number(in, property.type));
            if (property.name == "x") p.x = x;
            if (property.name == "y") p.y = x;
            if (property.name == "z") p.z = x;
        }
        mesh.tables.positions.push_back(p);
    }
    for (std::size_t i = 0; i < faces; ++i)
        for (const Property& property : of_face) {
            const std::size_t n = property.count_type.empty() ? 1 : std::size_t(next_number(in, property.count_type));
            std::vector<std::uint32_t> corners;
            for (std::size_t k = 0; k < n; ++k) corners.push_back(std::uint32_t(next_number(in, property.type)));
            for (std::size_t k = 2; k < n; ++k)
                for (std::size_t v : {std::size_t(0), k - 1, k}) {
                    if (corners[v] >= vertices)
                        throw std::runtime_error(path + ": a face names a vertex that there is not");
                    mesh.tables.triangles.push_back(corners[v]);
                }
        }
    finish(mesh);
    mesh.view = framing(mesh.tables);
    if (std::ifstream view(path.substr(0, path.find_last_of('.')) + ".json"); view) {
        const nlohmann::json json = nlohmann::json::parse(view);
        const auto vector = [&](const char* key) {
            return Vec3d{json.at(key).at(0), json.at(key).at(1), json.at(key).at(2)};
        };
        mesh.view = {vector("position"), vector("look_at"), vector("up"), json.at("x_fov_degrees")};
    }
    return mesh;
}

Mesh generate(const std::string& name)
{
    Mesh mesh;
    mesh.name = name;
    const std::size_t dash = name.find('-');
    const std::string kind = name.substr(0, dash);
    const double millions = dash == std::string::npos ? 1 : std::stod(name.substr(dash + 1));
    const std::size_t triangles = millions > 0 ? std::size_t(millions * 1e6) : 50'000;
    if (kind == "terrain")
        make_terrain(mesh, triangles);
    else if (kind == "foliage")
        make_foliage(mesh, triangles);
    else if (kind == "boulder")
        make_boulder(mesh, triangles);
    else
        throw std::runtime_error(name + ": known are terrain-N, foliage-N and boulder-N");
    finish(mesh);
    return mesh;
}

void write_ply(const Mesh& mesh, const std::string& path)
{
    const GeometryTables& t = mesh.tables;
    std::ofstream out(path, std::ios::binary);
    out << "ply\nformat binary_little_endian 1.0\nelement vertex " << t.positions.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << t.triangle_count()
        << "\nproperty list uchar int vertex_indices\nend_header\n";
    out.write(reinterpret_cast<const char*>(t.positions.data()), std::streamsize(t.positions.size() * sizeof(Vec3f)));
    for (std::size_t i = 0; i < t.triangles.size(); i += 3) {
        out.put(3);
        out.write(reinterpret_cast<const char*>(&t.triangles[i]), 12);
    }
    const View& view = mesh.view;
    const auto list = [](const Vec3d& v) { return nlohmann::json{v.x, v.y, v.z}; };
    std::ofstream(path.substr(0, path.find_last_of('.')) + ".json")
        << nlohmann::json{{"position", list(view.position)},
                          {"look_at", list(view.look_at)},
                          {"up", list(view.up)},
                          {"x_fov_degrees", view.x_fov_deg}};
    if (!out.flush()) throw std::runtime_error(path + ": can't be written");
}

}  // namespace fathom::bench
