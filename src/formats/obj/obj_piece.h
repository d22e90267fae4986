// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "fathom/description.h"
#include "formats/io/text_scanner.h"

namespace fathom {

/// Indices of a face corner as written: positive from 1, or negative relative to the end. Indices beyond the range of
/// 32 bits are clamped.
struct ObjCorner {
    static constexpr std::int32_t absent = std::numeric_limits<std::int32_t>::min();
    static constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
    std::int32_t position = absent, uv = absent, normal = absent;
};

/// Numbers of vertices defined so far, which corners may refer to.
struct ObjCounts {
    std::size_t positions = 0, uvs = 0, normals = 0;
    friend bool operator==(const ObjCounts&, const ObjCounts&) = default;
};

/// A part of an OBJ file, parsed independently of the lines before it: pieces are parsed in parallel and joined in
/// order.
struct ObjPiece {
    std::string text;       ///< whole lines, with their line ends
    std::size_t lines = 0;  ///< number of lines parsed

    std::vector<Vec3f> positions, normals;
    std::vector<Vec2f> uvs;
    /// Marks a vertex without a color in a piece where others have one.
    static constexpr Vec4f no_color{1, 1, 1, 0};
    std::vector<Vec4f> colors;  ///< empty, or the colors from vertex `first_color` to the last one
    std::size_t first_color = 0;

    std::vector<ObjCorner> corners;
    std::vector<std::uint32_t> face_ends;  ///< end of each face in `corners`
    /// A run of faces that share the numbers of vertices defined before them in this piece.
    struct Run {
        std::size_t first_face;
        ObjCounts counts;
    };
    std::vector<Run> runs;
    /// A line whose effect depends on earlier lines or extends to later faces.
    struct Event {
        enum Kind { object, material, library, points } kind;
        std::size_t face;  ///< the first face after the line
        ObjCounts counts;
        std::string_view rest;  ///< the rest of the line after its keyword
    };
    std::vector<Event> events;

    std::size_t drawn_lines = 0, free_forms = 0, unknown_lines = 0;
    bool is_damaged = false;  ///< parsing stopped at an invalid line

    ObjCounts counts() const { return {positions.size(), uvs.size(), normals.size()}; }
    /// Empties the piece and keeps its allocated memory.
    void clear();
};

/// Parses the lines of piece.text. Throws Error with the line number, where first_line is the number of the first line.
void read_obj_piece(ObjPiece& piece, const std::string& file, std::size_t first_line);

/// Parses a face corner such as `1/2/3`. Throws Error.
ObjCorner read_obj_corner(const TextScanner& scan, std::string_view word);
/// Parses an index of any magnitude. Throws Error.
long long read_obj_index(const TextScanner& scan, std::string_view word);

}  // namespace fathom
