// SPDX-License-Identifier: Apache-2.0
/// The layout of COCO (Lin et al. 2014): images and one file of annotations with run lengths.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dataset/dataset_writer.h"
#include "dataset/mask_codes.h"

namespace fathom::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

class CocoWriter : public DatasetWriter {
public:
    CocoWriter(fs::path folder, const RenderPlan& plan, const SceneDescription& scene)
        : folder_(std::move(folder)), plan_(plan), kinds_(scene)
    {
    }

    TruthRequest request() const override { return {.masks = true}; }

    void add(const View& view) override
    {
        const std::string name = fmt::format("{:06}.png", view.index);
        write_view_image(folder_ / "images" / name, view, plan_);
        images_.push_back({{"id", view.index + 1},
                           {"file_name", "images/" + name},
                           {"width", plan_.settings.width},
                           {"height", plan_.settings.height}});
        for (const ObjectMask& mask : view.masks)
            if (!mask.visible.empty()) annotations_.push_back(annotation(view, mask));
    }

    void finish() override
    {
        Json categories = Json::array();
        for (const SceneObject& first : kinds_.firsts())
            categories.push_back({{"id", categories.size() + 1}, {"name", first.name}, {"supercategory", "object"}});
        write_json(folder_ / "annotations.json", {{"info", {{"description", plan_.scene_options.file.string()}}},
                                                  {"images", images_},
                                                  {"annotations", annotations_},
                                                  {"categories", categories}});
    }

private:
    Json annotation(const View& view, const ObjectMask& mask)
    {
        const SceneObject& object = view.objects[mask.instance - 1];
        return {{"id", annotations_.size() + 1},
                {"image_id", view.index + 1},
                {"category_id", kinds_.number_of(object)},
                {"iscrowd", 0},
                {"area", mask.visible.size()},
                {"bbox", box_around(mask.visible, plan_.settings.width)},
                {"segmentation", encoded(mask.visible)},
                {"instance", mask.instance},
                {"whole_area", mask.whole.size()},
                {"whole_bbox", box_around(mask.whole, plan_.settings.width)},
                {"whole_segmentation", encoded(mask.whole)}};
    }

    Json encoded(const std::vector<std::uint32_t>& pixels) const
    {
        const int width = plan_.settings.width, height = plan_.settings.height;
        return {{"size", {height, width}}, {"counts", coco_run_lengths(pixels, width, height)}};
    }

    fs::path folder_;
    const RenderPlan& plan_;
    ObjectKinds kinds_;
    Json images_ = Json::array(), annotations_ = Json::array();
};

}  // namespace

std::unique_ptr<DatasetWriter> make_coco_writer(const fs::path& folder, const RenderPlan& plan,
                                                const SceneDescription& scene)
{
    return std::make_unique<CocoWriter>(folder, plan, scene);
}

}  // namespace fathom::cli
