#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "fathom/description.h"
#include "formats/io/text_scanner.h"

namespace fathom {

/// A corner as it is written: from 1 on, or from -1 back. Numbers that no array is long enough for are cut.
struct ObjCorner {
    static constexpr std::int32_t absent = std::numeric_limits<std::int32_t>::min();
    static constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
    std::int32_t position = absent, uv = absent, normal = absent;
};

/// How many there are so far: what corners may refer to.
struct ObjCounts {
    std::size_t positions = 0, uvs = 0, normals = 0;
    friend bool operator==(const ObjCounts&, const ObjCounts&) = default;
};

/// Some lines of an OBJ file, read without knowing what stands before them: pieces are read side by side and joined one
/// after the other.
struct ObjPiece {
    std::string text;       ///< whole lines, which end as lines do
    std::size_t lines = 0;  ///< that were read

    std::vector<Vec3f> positions, normals;
    std::vector<Vec2f> uvs;
    /// Stands for the color of a vertex without one, in a piece that has some.
    static constexpr Vec4f no_color{1, 1, 1, 0};
    std::vector<Vec4f> colors;  ///< empty, or up to the last position from the first that has one on
    std::size_t first_color = 0;

    std::vector<ObjCorner> corners;
    std::vector<std::uint32_t> face_ends;  ///< in corners
    /// What was counted in the piece before this face and those after it.
    struct Run {
        std::size_t first_face;
        ObjCounts counts;
    };
    std::vector<Run> runs;
    /// A line that faces after it depend on, or that depends on what came before.
    struct Event {
        enum Kind { object, material, library, points } kind;
        std::size_t face;  ///< the first one after it
        ObjCounts counts;
        std::string_view rest;  ///< of the line
    };
    std::vector<Event> events;

    std::size_t drawn_lines = 0, free_forms = 0, unknown_lines = 0;
    bool is_damaged = false;  ///< reading stopped at a line that can't be read

    ObjCounts counts() const { return {positions.size(), uvs.size(), normals.size()}; }
    void clear();
};

/// Reads the lines of piece.text. Throws Error naming the line, of which the first here has the number first_line.
void read_obj_piece(ObjPiece& piece, const std::string& file, std::size_t first_line);

/// The words of a corner. Throws Error.
ObjCorner read_obj_corner(const TextScanner& scan, std::string_view word);
/// A whole number of a corner, of any size.
long long read_obj_index(const TextScanner& scan, std::string_view word);

}  // namespace fathom
