// SPDX-License-Identifier: Apache-2.0
/// One archive of NumPy arrays for each view.
#include <fmt/format.h>
#include <limits>

#include "dataset/dataset_writer.h"
#include "dataset/mask_codes.h"
#include "dataset/npz_file.h"
#include "fathom/denoise.h"

namespace fathom::cli {

namespace {

namespace fs = std::filesystem;

class NpzWriter : public DatasetWriter {
public:
    NpzWriter(fs::path folder, const RenderPlan& plan) : folder_(std::move(folder)), plan_(plan) {}

    TruthRequest request() const override { return {.layers = true, .masks = true, .flow = true}; }

    void add(const View& view) override
    {
        NpzFile file(folder_ / fmt::format("{:06}.npz", view.index));
        const std::size_t height = std::size_t(plan_.settings.height), width = std::size_t(plan_.settings.width);
        const Image shown = display_image(view.image);
        file.add("rgba", "|u1", {height, width, 4},
                 to_display(shown.layers.front(), shown.width, shown.height, plan_.write.display));
        const GroundTruth& truth = view.truth;
        file.add("depth", "<f4", {height, width}, truth.depth);
        file.add("distance", "<f4", {height, width}, truth.distance);
        file.add("normal", "<f4", {height, width, 3}, truth.normal);
        file.add("camera_normal", "<f4", {height, width, 3}, truth.camera_normal);
        file.add("position", "<f4", {height, width, 3}, truth.position);
        file.add("instance", "<u4", {height, width}, truth.instance);
        file.add("material", "<u4", {height, width}, truth.material);
        if (!view.flow_forward.empty()) file.add("flow_forward", "<f4", {height, width, 2}, view.flow_forward);
        if (!view.flow_backward.empty()) file.add("flow_backward", "<f4", {height, width, 2}, view.flow_backward);
        add_masks(file, view);
        add_camera(file, view.camera);
        file.finish();
    }
    void finish() override {}

private:
    void add_masks(NpzFile& file, const View& view) const
    {
        const int width = plan_.settings.width, height = plan_.settings.height;
        std::vector<std::uint32_t> ids;
        std::vector<std::uint8_t> whole;
        for (const ObjectMask& mask : view.masks) {
            ids.push_back(mask.instance);
            const std::vector<std::uint16_t> values = mask_values(mask.whole, width, height, 1);
            whole.insert(whole.end(), values.begin(), values.end());
        }
        file.add("mask_instance", "<u4", {ids.size()}, ids);
        file.add("mask_whole", "|b1", {ids.size(), std::size_t(height), std::size_t(width)}, whole);
    }

    static void add_camera(NpzFile& file, const PinholeCamera& c)
    {
        const std::vector<double> intrinsics = {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1};
        std::vector<double> pose;
        for (const auto& row : c.world_from_camera.m) pose.insert(pose.end(), row.begin(), row.end());
        pose.insert(pose.end(), {0, 0, 0, 1});
        file.add("intrinsics", "<f8", {3, 3}, intrinsics);
        file.add("world_from_camera", "<f8", {4, 4}, pose);
    }

    fs::path folder_;
    const RenderPlan& plan_;
};

}  // namespace

std::unique_ptr<DatasetWriter> make_npz_writer(const fs::path& folder, const RenderPlan& plan)
{
    return std::make_unique<NpzWriter>(folder, plan);
}

}  // namespace fathom::cli
