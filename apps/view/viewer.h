// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <SFML/Graphics.hpp>
#include <chrono>
#include <set>
#include <string>
#include <vector>

#include "camera_control.h"
#include "latency_log.h"
#include "module.h"
#include "overlay.h"
#include "renderer.h"

namespace fathom::view {

/// The window: handles mouse and keys, and draws the frames of the renderer.
class Viewer {
public:
    /// Throws Error if the window can't be opened.
    explicit Viewer(const ViewJob& job);
    /// Runs until the window is closed.
    void run();

private:
    using Clock = std::chrono::steady_clock;

    void handle(const sf::Event& event);
    void handle_key(const sf::Event::KeyEvent& key);
    void handle_character(std::uint32_t character);
    void handle_mouse_move(int x, int y);
    void release_mouse(sf::Mouse::Button button, int x, int y);
    void request_focus(int x, int y);
    void fly_by_keys(double seconds);
    void fly_step(sf::Keyboard::Key key, double step);
    void script_step();

    void move_camera(Clock::time_point when);
    void choose_view(int view);
    void change_display();
    void apply_update(Renderer::Update update);
    void upload(Frame frame);
    void draw();
    void set_title();
    void show_message(const std::string& text);
    std::vector<std::string> help_lines() const;
    bool busy() const;
    double aspect() const { return double(width_) / height_; }

    const ViewJob& job_;
    CameraControl control_;
    DisplayTransform transform_;
    View view_ = View::image;
    int width_, height_;
    bool moved_ = false, redraw_ = true, help_ = false;

    // State of the mouse: pressed button, position of the press, last position, and whether it was dragged.
    bool down_ = false, dragged_ = false;
    sf::Mouse::Button button_ = sf::Mouse::Left;
    sf::Vector2i press_, last_;
    std::set<sf::Keyboard::Key> held_;

    LatencyLog latency_;
    int script_moves_made_ = 0;
    Clock::time_point next_script_move_;

    sf::RenderWindow window_;
    sf::Texture textures_[2];  ///< textures for frames at low resolution and at full size
    Overlay overlay_;
    Frame frame_;
    std::string title_, message_;
    Clock::time_point message_end_, last_draw_;
    // Last member, so that its thread ends before the other members are destroyed.
    Renderer renderer_;
};

}  // namespace fathom::view
