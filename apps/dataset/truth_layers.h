// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "fathom/ground_truth.h"
#include "fathom/image.h"
#include "options/dataset_options.h"

namespace fathom::cli {

/// Image layers of ground truth, named "truth.depth" and so on; without flow.
std::vector<Image::Layer> truth_layers(const GroundTruth& truth, const std::vector<TruthLayer>& wanted);
/// A layer of optical flow.
Image::Layer flow_layer(const char* name, const std::vector<Vec2f>& flow);

}  // namespace fathom::cli
