// SPDX-License-Identifier: Apache-2.0
/// The layouts of NeRF's synthetic scenes (Mildenhall et al. 2020) and of nerfstudio.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "dataset/dataset_writer.h"
#include "dataset/view_cameras.h"
#include "fathom/gray_image.h"

namespace fathom::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json frame_matrix(const View& view)
{
    return matrix_rows(z_up_from_world() * view.camera.world_from_camera);
}

class NerfWriter : public DatasetWriter {
public:
    NerfWriter(fs::path folder, std::size_t views, const RenderPlan& plan)
        : folder_(std::move(folder)), views_(views), plan_(plan)
    {
        for (const char* split : splits) frames_[split] = Json::array();
    }

    TruthRequest request() const override { return {}; }

    void add(const View& view) override
    {
        const char* const split = split_of(view.index);
        const std::string name = fmt::format("{}/r_{}", split, view.index);
        write_view_image(folder_ / (name + ".png"), view, plan_);
        angle_ = 2 * std::atan(0.5 * plan_.settings.width / view.camera.fx);
        frames_[split].push_back({{"file_path", "./" + name}, {"transform_matrix", frame_matrix(view)}});
    }

    void finish() override
    {
        for (const char* split : splits)
            write_json(folder_ / fmt::format("transforms_{}.json", split),
                       {{"camera_angle_x", angle_}, {"frames", frames_[split]}});
    }

private:
    static constexpr const char* splits[] = {"train", "val", "test"};

    /// Of each ten views, the last two are for validation and for tests. With fewer than ten, all are for training.
    const char* split_of(std::size_t i) const
    {
        if (views_ < 10 || i % 10 < 8) return "train";
        return i % 10 == 8 ? "val" : "test";
    }

    fs::path folder_;
    std::size_t views_;
    const RenderPlan& plan_;
    double angle_ = 0;
    Json frames_;
};

class NerfstudioWriter : public DatasetWriter {
public:
    NerfstudioWriter(fs::path folder, const RenderPlan& plan) : folder_(std::move(folder)), plan_(plan) {}

    TruthRequest request() const override { return {.layers = true}; }

    void add(const View& view) override
    {
        const std::string image = fmt::format("images/frame_{:05}.png", view.index + 1);
        const std::string depth = fmt::format("depth/frame_{:05}.png", view.index + 1);
        write_view_image(folder_ / image, view, plan_);
        write_depth(folder_ / depth, view.truth);
        frames_.push_back({{"file_path", image},
                           {"depth_file_path", depth},
                           {"fl_x", view.camera.fx},
                           {"fl_y", view.camera.fy},
                           {"cx", view.camera.cx},
                           {"cy", view.camera.cy},
                           {"w", plan_.settings.width},
                           {"h", plan_.settings.height},
                           {"transform_matrix", frame_matrix(view)}});
    }

    void finish() override
    {
        Json all{{"camera_model", "OPENCV"}, {"k1", 0.0}, {"k2", 0.0}, {"p1", 0.0}, {"p2", 0.0}};
        if (!frames_.empty())
            for (const char* key : {"fl_x", "fl_y", "cx", "cy", "w", "h"}) all[key] = frames_[0][key];
        all["frames"] = frames_;
        write_json(folder_ / "transforms.json", all);
    }

private:
    /// Depth in millimeters; 0 where nothing is hit, or farther than 65.535 m.
    static void write_depth(const fs::path& file, const GroundTruth& truth)
    {
        std::vector<std::uint16_t> millimeters;
        for (const float depth : truth.depth) {
            const double value = std::round(1000.0 * double(depth));
            millimeters.push_back(value <= 65535 ? std::uint16_t(value) : 0);
        }
        fs::create_directories(file.parent_path());
        write_gray_png(file, truth.width, truth.height, 16, millimeters);
    }

    fs::path folder_;
    const RenderPlan& plan_;
    Json frames_ = Json::array();
};

}  // namespace

std::unique_ptr<DatasetWriter> make_nerf_writer(const fs::path& folder, std::size_t views, const RenderPlan& plan)
{
    return std::make_unique<NerfWriter>(folder, views, plan);
}

std::unique_ptr<DatasetWriter> make_nerfstudio_writer(const fs::path& folder, const RenderPlan& plan)
{
    return std::make_unique<NerfstudioWriter>(folder, plan);
}

}  // namespace fathom::cli
