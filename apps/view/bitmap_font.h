#pragma once
#include <string_view>
#include <vector>

namespace fathom::view {

/// A small fixed-width font of our own, so that text needs no font file. ASCII from space to tilde.
struct BitmapFont {
    static constexpr int cell_width = 6, cell_height = 10;  ///< pixels of a character, with the space around it
    static constexpr char first = ' ', last = '~';
    static constexpr int characters = last - first + 1;

    /// Whether the pixel of the character's cell is part of it; characters without a glyph show as `?`.
    static bool pixel(char character, int x, int y);
    /// All glyphs side by side, RGBA, white on transparent: characters * cell_width by cell_height.
    static std::vector<unsigned char> atlas();
};

}  // namespace fathom::view
