// SPDX-License-Identifier: Apache-2.0
#include "dataset/bop_models.h"

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <variant>

#include "dataset/dataset_writer.h"
#include "fathom/error.h"

namespace fathom::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Model {
    std::vector<Vec3f> positions;  ///< in millimeters
    std::vector<std::uint32_t> indices;
};

Model model_of(const SceneDescription& scene, const SceneObject& object)
{
    Model model;
    for (const Shape& shape : scene.nodes[std::size_t(object.node)].shapes) {
        const auto* placed = std::get_if<MeshInstance>(&shape.geometry);
        if (!placed) continue;
        const Mesh& mesh = scene.meshes[std::size_t(placed->mesh)];
        const auto first = std::uint32_t(model.positions.size());
        for (const Vec3f& p : mesh.positions)
            model.positions.push_back(to_float(object.stretch.point(to_double(p)) * 1000));
        for (const std::uint32_t i : mesh.indices) model.indices.push_back(first + i);
    }
    return model;
}

void write_ply(const fs::path& file, const Model& model)
{
    std::ofstream stream(file, std::ios::binary);
    stream << fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
        "z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        model.positions.size(), model.indices.size() / 3);
    stream.write(reinterpret_cast<const char*>(model.positions.data()),
                 std::streamsize(model.positions.size() * sizeof(Vec3f)));
    for (std::size_t i = 0; i + 2 < model.indices.size(); i += 3) {
        stream.put(3);
        stream.write(reinterpret_cast<const char*>(&model.indices[i]), 12);
    }
    stream.close();
    if (!stream) throw Error(file.string(), "", std::string("can't write: ") + std::strerror(errno));
}

/// Largest distance of two points. Exact for up to 2,000 points; for others among the outermost ones along 500
/// directions, which is too small by 1 % at most.
double diameter(const std::vector<Vec3f>& points)
{
    std::vector<Vec3d> candidates;
    if (points.size() <= 2000) {
        for (const Vec3f& p : points) candidates.push_back(to_double(p));
    } else {
        for (int i = 0; i < 500; ++i) {
            const double height = 1 - (i + 0.5) / 250, across = std::sqrt(1 - height * height), angle = 2.399963 * i;
            const Vec3d axis{across * std::cos(angle), height, across * std::sin(angle)};
            const auto end = std::max_element(points.begin(), points.end(), [&](const Vec3f& a, const Vec3f& b) {
                return dot(to_double(a), axis) < dot(to_double(b), axis);
            });
            candidates.push_back(to_double(*end));
        }
    }
    double largest = 0;
    for (const Vec3d& a : candidates)
        for (const Vec3d& b : candidates) largest = std::max(largest, length(a - b));
    return largest;
}

Json info_of(const Model& model, const std::string& name)
{
    Vec3f lo = model.positions.front(), hi = lo;
    for (const Vec3f& p : model.positions) {
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
    return {{"diameter", diameter(model.positions)},
            {"min_x", lo.x},
            {"min_y", lo.y},
            {"min_z", lo.z},
            {"size_x", hi.x - lo.x},
            {"size_y", hi.y - lo.y},
            {"size_z", hi.z - lo.z},
            {"name", name}};
}

}  // namespace

void write_bop_models(const fs::path& folder, const SceneDescription& scene, const std::vector<SceneObject>& objects)
{
    fs::create_directories(folder);
    Json infos = Json::object();
    for (std::size_t i = 0; i < objects.size(); ++i) {
        const Model model = model_of(scene, objects[i]);
        if (model.positions.empty()) continue;
        write_ply(folder / fmt::format("obj_{:06}.ply", i + 1), model);
        infos[fmt::format("{}", i + 1)] = info_of(model, objects[i].name);
    }
    write_json(folder / "models_info.json", infos);
}

}  // namespace fathom::cli
