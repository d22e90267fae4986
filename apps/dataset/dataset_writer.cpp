// SPDX-License-Identifier: Apache-2.0
#include "dataset/dataset_writer.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <variant>

#include "fathom/denoise.h"
#include "fathom/error.h"

namespace fathom::cli {

namespace fs = std::filesystem;

std::unique_ptr<DatasetWriter> make_dataset_writer(DatasetFormat format, const fs::path& folder, std::size_t views,
                                                   const RenderPlan& plan, const SceneDescription& scene)
{
    switch (format) {
        case DatasetFormat::nerf:
            return make_nerf_writer(folder, views, plan);
        case DatasetFormat::nerfstudio:
            return make_nerfstudio_writer(folder, plan);
        case DatasetFormat::bop:
            return make_bop_writer(folder, plan, scene);
        case DatasetFormat::coco:
            return make_coco_writer(folder, plan, scene);
        case DatasetFormat::npz:
        case DatasetFormat::none:
            break;
    }
    return make_npz_writer(folder, plan);
}

void write_view_image(const fs::path& file, const View& view, const RenderPlan& plan)
{
    fs::create_directories(file.parent_path());
    write_image(file, display_image(view.image), plan.write);
}

void write_json(const fs::path& file, const nlohmann::ordered_json& json)
{
    std::ofstream stream(file, std::ios::binary);
    // Names in models need not be UTF-8.
    stream << json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
    stream.close();
    if (!stream) throw Error(file.string(), "", std::string("can't write: ") + std::strerror(errno));
}

nlohmann::ordered_json matrix_rows(const Transform& t)
{
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const auto& row : t.m) rows.push_back(row);
    rows.push_back({0.0, 0.0, 0.0, 1.0});
    return rows;
}

int ObjectKinds::number_of(const SceneObject& object)
{
    const auto known = std::find_if(firsts_.begin(), firsts_.end(),
                                    [&](const SceneObject& first) { return are_equal(first, object); });
    if (known != firsts_.end()) return int(known - firsts_.begin()) + 1;
    firsts_.push_back(object);
    return int(firsts_.size());
}

bool ObjectKinds::are_equal(const SceneObject& a, const SceneObject& b) const
{
    if (a.node == b.node) return true;
    const std::vector<Shape>& shapes = scene_.nodes[std::size_t(a.node)].shapes;
    const std::vector<Shape>& others = scene_.nodes[std::size_t(b.node)].shapes;
    const auto same_mesh = [](const Shape& s, const Shape& t) {
        const auto* mesh = std::get_if<MeshInstance>(&s.geometry);
        const auto* other = std::get_if<MeshInstance>(&t.geometry);
        return mesh && other && mesh->mesh == other->mesh && s.material == t.material;
    };
    if (!std::equal(shapes.begin(), shapes.end(), others.begin(), others.end(), same_mesh)) return false;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c)
            if (std::abs(a.stretch.m[r][c] - b.stretch.m[r][c]) > 1e-6 * std::abs(a.stretch.m[r][r])) return false;
    return true;
}

std::array<int, 4> box_around(const std::vector<std::uint32_t>& pixels, int width)
{
    int x0 = width, x1 = 0;
    for (const std::uint32_t pixel : pixels) {
        const int x = int(pixel % std::uint32_t(width));
        x0 = std::min(x0, x), x1 = std::max(x1, x);
    }
    const int y0 = int(pixels.front() / std::uint32_t(width)), y1 = int(pixels.back() / std::uint32_t(width));
    return {x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

}  // namespace fathom::cli
