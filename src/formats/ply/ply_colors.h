#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "formats/ply/ply_header.h"

namespace fathom {

/// What stands for the colours of a mesh: of vertices (or of faces), an attribute of a name as Mitsuba has them. It is
/// made of properties name_0, name_1, name_2 or name_x, ... (name_1 to name_3, too), or of one such, a number; one that
/// ends with `_color` may be of name_r, name_g, name_b less that end, and `color` itself of red, green, blue and alpha,
/// r, g, b and a, or diffuse_red, ...
struct PlyAttribute {
    std::string name = "color";
    bool of_faces = false;
};

/// Where a property of an element goes in a colour.
struct PlyChannel {
    int index = -1;           ///< 3: alpha; -1: no part of it
    bool is_encoded = false;  ///< an integer stands for the colour of a display
};

/// Of each property of the element.
std::vector<PlyChannel> channels_of(const PlyElement& element, std::string_view attribute);

}  // namespace fathom
