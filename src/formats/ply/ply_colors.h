// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "formats/ply/ply_header.h"

namespace fathom {

/// A color attribute of vertices or faces, named as in Mitsuba.
///
/// It consists of the properties name_0, name_1, name_2 or name_x, name_y, name_z (also name_1 to name_3), or of a
/// single number. For a name that ends in `_color`, properties may also be the rest of the name with _r, _g and _b. The
/// attribute `color` may also be red, green, blue and alpha; r, g, b and a; or diffuse_red, ...
struct PlyAttribute {
    std::string name = "color";
    bool of_faces = false;
};

/// The color channel that a property supplies.
struct PlyChannel {
    int index = -1;           ///< number of the channel; 3 is alpha, -1 is none
    bool is_encoded = false;  ///< an integer that encodes a display color
};

/// The channel of each property of the element.
std::vector<PlyChannel> channels_of(const PlyElement& element, std::string_view attribute);

}  // namespace fathom
