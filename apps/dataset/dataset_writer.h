// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "dataset/views.h"

namespace fathom::cli {

/// Writes the views of one model to a folder, in one of the layouts.
class DatasetWriter {
public:
    virtual ~DatasetWriter() = default;
    /// Ground truth that add() reads.
    virtual TruthRequest request() const = 0;
    /// Writes the files of a view. Throws Error.
    virtual void add(const View& view) = 0;
    /// Writes what describes all views.
    virtual void finish() = 0;
};

/// Makes the writer of the format in the options of `plan`.
///
/// folder  an existing folder
/// views   number of views
/// scene   the scene whose views are written; it must outlive the writer
std::unique_ptr<DatasetWriter> make_dataset_writer(DatasetFormat format, const std::filesystem::path& folder,
                                                   std::size_t views, const RenderPlan& plan,
                                                   const SceneDescription& scene);

/// Writers of the layouts; arguments as above.
std::unique_ptr<DatasetWriter> make_nerf_writer(const std::filesystem::path& folder, std::size_t views,
                                                const RenderPlan& plan);
std::unique_ptr<DatasetWriter> make_nerfstudio_writer(const std::filesystem::path& folder, const RenderPlan& plan);
std::unique_ptr<DatasetWriter> make_bop_writer(const std::filesystem::path& folder, const RenderPlan& plan,
                                               const SceneDescription& scene);
std::unique_ptr<DatasetWriter> make_coco_writer(const std::filesystem::path& folder, const RenderPlan& plan,
                                                const SceneDescription& scene);
std::unique_ptr<DatasetWriter> make_npz_writer(const std::filesystem::path& folder, const RenderPlan& plan);

/// Writes the image of a view as it is displayed.
void write_view_image(const std::filesystem::path& file, const View& view, const RenderPlan& plan);
/// Writes JSON with a final newline. Throws Error if that fails.
void write_json(const std::filesystem::path& file, const nlohmann::ordered_json& json);
/// A transform as the four rows of a matrix.
nlohmann::ordered_json matrix_rows(const Transform& t);

/// Kinds of objects for detection: objects of equal geometry and stretch are of one kind. Numbers count from 1.
class ObjectKinds {
public:
    explicit ObjectKinds(const SceneDescription& scene) : scene_(scene) {}
    int number_of(const SceneObject& object);
    /// The first object of each kind.
    const std::vector<SceneObject>& firsts() const { return firsts_; }

private:
    bool are_equal(const SceneObject& a, const SceneObject& b) const;

    const SceneDescription& scene_;
    std::vector<SceneObject> firsts_;
};

/// Smallest rectangle around pixels: x, y, width, height. `pixels` must not be empty.
std::array<int, 4> box_around(const std::vector<std::uint32_t>& pixels, int width);

}  // namespace fathom::cli
