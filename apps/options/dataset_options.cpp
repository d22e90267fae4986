// SPDX-License-Identifier: Apache-2.0
#include "options/dataset_options.h"

#include <algorithm>

#include "options/arguments.h"

namespace fathom::cli {

namespace {

const std::vector<std::string> truth_layer_names = {"depth",    "distance", "normal",   "camera-normal",
                                                    "position", "instance", "material", "flow"};

void parse_layers(DatasetOptions& o, const std::string& text)
{
    for (const std::string& name : split(text, ',')) {
        const auto layer = TruthLayer(parse_choice(name, truth_layer_names));
        if (std::find(o.layers.begin(), o.layers.end(), layer) == o.layers.end()) o.layers.push_back(layer);
    }
}

}  // namespace

const std::vector<std::string> dataset_format_names = {"nerf", "nerfstudio", "bop", "coco", "npz"};
const std::vector<std::string> view_placement_names = {"sphere", "hemisphere", "ring"};

void add_dataset_options(Command& command, DatasetOptions& o)
{
    command.begin_group("Data sets");
    command.add_value(
        {"--views", "N",
         "render N images from around the model; ### in the names of -o becomes the image number, from 0", ""},
        [&](const std::string& text) { o.views = parse_integer(text, 1, 1'000'000); });
    command.add_value({"--on", "sphere|hemisphere|ring",
                       "where --views places cameras: evenly over all directions, over those from above, or in a "
                       "circle at the elevation of --orbit; --seed turns them about the vertical axis",
                       "hemisphere"},
                      [&](const std::string& text) {
                          o.placement = ViewPlacement(parse_choice(text, view_placement_names));
                          o.is_placed = true;
                      });
    command.add_value({"--cameras", "FILE", "render the views of a transforms.json (NeRF, nerfstudio) instead", ""},
                      [&](const std::string& text) { o.cameras = text; });
    command.add_value(
        {"--dataset", "nerf|nerfstudio|bop|coco|npz",
         "write the views of --views, --cameras or --frames to the folder -o in this layout, with "
         "cameras and ground truth (docs/datasets.md)",
         ""},
        [&](const std::string& text) { o.format = DatasetFormat(1 + parse_choice(text, dataset_format_names)); });
    command.add_value({"--models", "LIST",
                       "render all models of a text file, one path a line, each to a folder of its own in -o; models "
                       "that fail are recorded in log.jsonl, finished ones are skipped, --part K/N renders a part",
                       ""},
                      [&](const std::string& text) { o.models = text == "-" ? "/dev/stdin" : text; });
    command.add_value({"--ground-truth", "LIST",
                       "further layers of EXR from one ray through each pixel's center, unfiltered in contrast to "
                       "--aov: depth, distance, normal, camera-normal, position, instance, material, and with "
                       "--dataset flow",
                       "none"},
                      [&](const std::string& text) { parse_layers(o, text); });
}

}  // namespace fathom::cli
