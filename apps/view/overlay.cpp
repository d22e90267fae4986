// SPDX-License-Identifier: Apache-2.0
#include "overlay.h"

#include <algorithm>

#include "report/bitmap_font.h"

namespace fathom::view {

void Overlay::draw(sf::RenderTarget& target, const std::vector<std::string>& lines, Corner corner)
{
    using cli::BitmapFont;
    constexpr int cell_width = BitmapFont::cell_width, cell_height = BitmapFont::cell_height, margin = 6;
    if (!loaded_) {
        if (!font_.create(BitmapFont::characters * cell_width, cell_height)) return;
        font_.update(BitmapFont::atlas().data());
        loaded_ = true;
    }
    std::size_t longest = 0;
    for (const std::string& line : lines) longest = std::max(longest, line.size());
    const int width = int(longest) * cell_width + 2 * margin, height = int(lines.size()) * cell_height + 2 * margin;
    const int window_width = int(target.getSize().x), window_height = int(target.getSize().y);
    // Double size if there is room, since pixels of modern displays are small.
    const int scale = 2 * width <= window_width && 2 * height <= window_height ? 2 : 1;
    const float left = 0, top = corner == Corner::top_left ? 0 : float(window_height - scale * height);

    sf::RectangleShape background({float(scale * width), float(scale * height)});
    background.setPosition(left, top);
    background.setFillColor(sf::Color(0, 0, 0, 170));
    target.draw(background);

    sf::VertexArray quads(sf::Quads);
    for (std::size_t row = 0; row < lines.size(); ++row)
        for (std::size_t column = 0; column < lines[row].size(); ++column) {
            char c = lines[row][column];
            if (c == ' ') continue;
            if (c < BitmapFont::first || c > BitmapFont::last) c = '?';
            const float x = left + float(scale * (margin + int(column) * cell_width));
            const float y = top + float(scale * (margin + int(row) * cell_height));
            const float u = float((c - BitmapFont::first) * cell_width);
            for (const sf::Vector2f part : {sf::Vector2f{0, 0}, {1, 0}, {1, 1}, {0, 1}})
                quads.append(
                    sf::Vertex({x + part.x * float(scale * cell_width), y + part.y * float(scale * cell_height)},
                               sf::Color::White, {u + part.x * float(cell_width), part.y * float(cell_height)}));
        }
    target.draw(quads, sf::RenderStates(&font_));
}

}  // namespace fathom::view
