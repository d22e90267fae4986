// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/image.h"

/// Names of enumerators in scene files, in the order of the enumerators; used for reading and writing.

namespace fathom::words {

inline constexpr const char* camera_kinds[] = {"perspective", "orthographic", "spherical", "equal-area"};
inline constexpr const char* spot_falloffs[] = {"square", "smooth", "linear"};
inline constexpr const char* fov_axes[] = {"smaller", "larger", "width", "height", "diagonal"};
inline constexpr const char* color_spaces[] = {"srgb", "linear"};
inline constexpr const char* lookups[] = {"bilinear", "nearest"};
inline constexpr const char* environment_kinds[] = {"none", "constant", "gradient",   "image",       "studio",
                                                    "sky",  "cube",     "equal-area", "hosek-wilkie"};
inline constexpr const char* curve_bases[] = {"linear", "bezier", "bspline", "catmull-rom"};
inline constexpr const char* curve_styles[] = {"round", "ribbon"};
inline constexpr const char* channels[] = {"r", "g", "b", "a", "luminance"};
inline constexpr const char* filters[] = {"box", "gaussian", "blackman-harris", "tent"};
inline constexpr auto& tonemaps = tonemap_names;
inline constexpr const char* builds[] = {"fast", "standard", "high", "compact"};

}  // namespace fathom::words
