// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "options/command.h"

namespace fathom::cli {

/// Layout of the files of a data set.
enum class DatasetFormat { none, nerf, nerfstudio, bop, coco, npz };
/// Names of each DatasetFormat except none, in order.
extern const std::vector<std::string> dataset_format_names;

/// Where --views places cameras around a model.
enum class ViewPlacement { sphere, hemisphere, ring };
extern const std::vector<std::string> view_placement_names;

/// Layers from one ray through each pixel's center.
enum class TruthLayer { depth, distance, normal, camera_normal, position, instance, material, flow };

/// Options for data sets: many views of one or more models, with ground truth.
struct DatasetOptions {
    DatasetFormat format = DatasetFormat::none;
    std::uint64_t views = 0;  ///< number of cameras around the model; 0: none
    ViewPlacement placement = ViewPlacement::hemisphere;
    bool is_placed = false;          ///< whether --on was given
    std::filesystem::path cameras;   ///< file with cameras; empty: none
    std::filesystem::path models;    ///< file with a list of models; empty: the scene alone
    std::vector<TruthLayer> layers;  ///< ground truth in EXR files

    bool has_views() const { return views > 0 || !cameras.empty(); }
};

void add_dataset_options(Command& command, DatasetOptions& options);

}  // namespace fathom::cli
