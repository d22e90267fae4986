// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "fathom/image.h"
#include "fathom/load.h"
#include "fathom/render.h"

namespace fathom::view {

/// Content of the window: the image or another layer.
enum class View { image, albedo, normal, depth, position, instance, material, noise };
inline constexpr int view_count = 8;

const char* name_of(View view);
/// Sets the layers that must be rendered for the view.
void set_aovs(View view, RenderSettings& settings);
/// Marks pixels without a hit in views of ids: films give them the id 0, like the first object.
void mark_misses(View view, Image& image);
/// The layer that the view shows.
const Image::Layer& layer_of(View view, const Image& image);

/// Parameters that map layers to colors.
struct DisplayScale {
    DisplayTransform transform;  ///< for image and noise
    Bounds bounds;               ///< positions that are black and white
    double distance = 1;         ///< depth that is shown as middle gray
};
/// 8-bit RGBA of a layer.
std::vector<unsigned char> display_pixels(View view, const Image::Layer& layer, int width, int height,
                                          const DisplayScale& scale);

}  // namespace fathom::view
