// SPDX-License-Identifier: Apache-2.0
/// The layout of the BOP benchmark of 6D object poses (Hodan et al. 2018): OpenCV axes, millimeters.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "dataset/bop_models.h"
#include "dataset/dataset_writer.h"
#include "dataset/mask_codes.h"
#include "fathom/gray_image.h"

namespace fathom::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The rotation of a transform, row by row.
Json rotation(const Transform& t)
{
    Json numbers = Json::array();
    for (const auto& row : t.m)
        for (std::size_t i = 0; i < 3; ++i) numbers.push_back(row[i]);
    return numbers;
}

/// The translation of a transform in millimeters.
Json translation(const Transform& t)
{
    return {1000 * t.m[0][3], 1000 * t.m[1][3], 1000 * t.m[2][3]};
}

/// Millimeters of a step of a 16-bit depth image: the smallest power of ten from 0.01 on that reaches the farthest
/// depth.
double depth_scale(const std::vector<float>& depth)
{
    double farthest = 0;
    for (const float d : depth)
        if (std::isfinite(d)) farthest = std::max(farthest, 1000.0 * double(d));
    double scale = 0.01;
    while (farthest / scale > 65535) scale *= 10;
    return scale;
}

class BopWriter : public DatasetWriter {
public:
    BopWriter(fs::path folder, const RenderPlan& plan, const SceneDescription& scene)
        : root_(std::move(folder)), folder_(root_ / "train_pbr" / "000000"), plan_(plan), scene_(scene), kinds_(scene)
    {
        for (const char* name : {"rgb", "depth", "mask", "mask_visib"}) fs::create_directories(folder_ / name);
    }

    TruthRequest request() const override { return {.layers = true, .masks = true}; }

    void add(const View& view) override
    {
        const std::string image = fmt::format("{:06}", view.index), key = fmt::format("{}", view.index);
        write_view_image(folder_ / "rgb" / (image + ".png"), view, plan_);
        const double scale = depth_scale(view.truth.depth);
        write_depth(image, view.truth, scale);
        const Transform camera_from_world = Transform::scale({1, -1, -1}) * view.camera.world_from_camera.inverse();
        cameras_[key] = {{"cam_K", intrinsics(view.camera)},
                         {"depth_scale", scale},
                         {"cam_R_w2c", rotation(camera_from_world)},
                         {"cam_t_w2c", translation(camera_from_world)}};
        poses_[key] = Json::array(), infos_[key] = Json::array();
        for (const ObjectMask& mask : view.masks) {
            const SceneObject& object = view.objects[mask.instance - 1];
            const Transform pose = camera_from_world * object.pose;
            const std::string name = fmt::format("{}_{:06}.png", image, poses_[key].size());
            write_mask(folder_ / "mask" / name, mask.whole);
            write_mask(folder_ / "mask_visib" / name, mask.visible);
            poses_[key].push_back({{"cam_R_m2c", rotation(pose)},
                                   {"cam_t_m2c", translation(pose)},
                                   {"obj_id", kinds_.number_of(object)}});
            infos_[key].push_back(info(mask));
        }
        camera_ = {{"cx", view.camera.cx - 0.5},   {"cy", view.camera.cy - 0.5}, {"depth_scale", scale},
                   {"fx", view.camera.fx},         {"fy", view.camera.fy},       {"height", plan_.settings.height},
                   {"width", plan_.settings.width}};
    }

    void finish() override
    {
        write_json(folder_ / "scene_camera.json", cameras_);
        write_json(folder_ / "scene_gt.json", poses_);
        write_json(folder_ / "scene_gt_info.json", infos_);
        write_json(root_ / "camera.json", camera_);
        write_bop_models(root_ / "models", scene_, kinds_.firsts());
    }

private:
    /// Pixel centers have whole coordinates in OpenCV.
    static Json intrinsics(const PinholeCamera& camera)
    {
        return {camera.fx, 0.0, camera.cx - 0.5, 0.0, camera.fy, camera.cy - 0.5, 0.0, 0.0, 1.0};
    }

    void write_depth(const std::string& image, const GroundTruth& truth, double scale) const
    {
        std::vector<std::uint16_t> steps;
        for (const float depth : truth.depth)
            steps.push_back(std::isfinite(depth) ? std::uint16_t(std::lround(1000.0 * double(depth) / scale)) : 0);
        write_gray_png(folder_ / "depth" / (image + ".png"), truth.width, truth.height, 16, steps);
    }

    void write_mask(const fs::path& file, const std::vector<std::uint32_t>& pixels) const
    {
        const int width = plan_.settings.width, height = plan_.settings.height;
        write_gray_png(file, width, height, 8, mask_values(pixels, width, height, 255));
    }

    Json info(const ObjectMask& mask) const
    {
        const int width = plan_.settings.width;
        const Json nowhere = {-1, -1, -1, -1};
        return {{"bbox_obj", box_around(mask.whole, width)},
                {"bbox_visib", mask.visible.empty() ? nowhere : Json(box_around(mask.visible, width))},
                {"px_count_all", mask.whole.size()},
                {"px_count_valid", mask.whole.size()},
                {"px_count_visib", mask.visible.size()},
                {"visib_fract", double(mask.visible.size()) / double(mask.whole.size())}};
    }

    fs::path root_, folder_;
    const RenderPlan& plan_;
    const SceneDescription& scene_;
    ObjectKinds kinds_;
    Json cameras_ = Json::object(), poses_ = Json::object(), infos_ = Json::object(), camera_;
};

}  // namespace

std::unique_ptr<DatasetWriter> make_bop_writer(const fs::path& folder, const RenderPlan& plan,
                                               const SceneDescription& scene)
{
    return std::make_unique<BopWriter>(folder, plan, scene);
}

}  // namespace fathom::cli
