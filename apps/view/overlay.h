// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <SFML/Graphics.hpp>
#include <string>
#include <vector>

namespace fathom::view {

/// Lines of text on a dark, translucent background, drawn over the image.
class Overlay {
public:
    enum class Corner { top_left, bottom_left };
    void draw(sf::RenderTarget& target, const std::vector<std::string>& lines, Corner corner);

private:
    sf::Texture font_;
    bool loaded_ = false;
};

}  // namespace fathom::view
