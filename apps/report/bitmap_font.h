// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>
#include <vector>

namespace fathom::cli {

/// A small built-in fixed-width font for ASCII from space to tilde, so that text needs no font file.
struct BitmapFont {
    static constexpr int cell_width = 6, cell_height = 10;  ///< size of a character in pixels, with its margin
    static constexpr char first = ' ', last = '~';
    static constexpr int characters = last - first + 1;

    /// Whether a pixel of the character's cell is set. Characters without a glyph are shown as `?`.
    static bool pixel(char character, int x, int y);
    /// RGBA pixels of all glyphs side by side, white on transparent, of size characters * cell_width by cell_height.
    static std::vector<unsigned char> atlas();
};

}  // namespace fathom::cli
