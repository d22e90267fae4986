#pragma once
#include <string>
#include <vector>

#include "fathom/image.h"
#include "fathom/load.h"
#include "fathom/render.h"

namespace fathom::view {

/// What the window can show: the picture, or one of the averages beside it.
enum class View { picture, albedo, normal, depth, position, instance, material, noise };
inline constexpr int views = 8;

const char* name_of(View view);
/// Adds what must be rendered for the view.
void add_aovs(View view, RenderSettings& settings);
/// Marks, where the view shows ids, the pixels that show nothing: films give them the id 0, as the first thing there
/// is.
void mark_misses(View view, Image& image);
/// The layer that the view shows.
const Image::Layer& layer_of(View view, const Image& image);

/// What numbers become colours by.
struct DisplayScale {
    DisplayTransform transform;  ///< of picture and noise
    Bounds bounds;               ///< black and white of positions
    double distance = 1;         ///< the depth that is shown as middle grey
};
/// 8-bit RGBA of a layer.
std::vector<unsigned char> display_pixels(View view, const Image::Layer& layer, int width, int height,
                                          const DisplayScale& scale);

}  // namespace fathom::view
