// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "camera_text.h"
#include "viewer.h"

/// The part of Viewer that handles mouse and keys.
namespace fathom::view {

namespace {

using namespace std::chrono_literals;

constexpr double radians_per_pixel = 0.006;
constexpr int min_drag_pixels = 4;     // shorter moves count as a click
constexpr double exposure_step = 0.5;  // stops
constexpr double fly_speed = 0.8;      // distances to the pivot per second
constexpr double tap_s = 0.03;         // flight time of a key that is only tapped

bool is_fly_key(sf::Keyboard::Key key)
{
    using K = sf::Keyboard;
    return key == K::W || key == K::A || key == K::S || key == K::D || key == K::Q || key == K::E || key == K::Left ||
           key == K::Right || key == K::Up || key == K::Down;
}

}  // namespace

void Viewer::handle(const sf::Event& event)
{
    switch (event.type) {
        case sf::Event::Closed:
            window_.close();
            break;
        case sf::Event::Resized:
            width_ = std::max(1, int(event.size.width));
            height_ = std::max(1, int(event.size.height));
            window_.setView(sf::View(sf::FloatRect(0, 0, float(width_), float(height_))));
            renderer_.move(control_.camera(), width_, height_, control_.distance());
            redraw_ = true;
            break;
        case sf::Event::KeyPressed:
            handle_key(event.key);
            break;
        case sf::Event::KeyReleased:
            held_.erase(event.key.code);
            break;
        case sf::Event::LostFocus:
            held_.clear();
            break;
        case sf::Event::GainedFocus:
            redraw_ = true;
            break;
        case sf::Event::TextEntered:
            handle_character(event.text.unicode);
            break;
        case sf::Event::MouseButtonPressed:
            if (down_) break;
            down_ = true;
            dragged_ = false;
            button_ = event.mouseButton.button;
            press_ = last_ = {event.mouseButton.x, event.mouseButton.y};
            break;
        case sf::Event::MouseButtonReleased:
            release_mouse(event.mouseButton.button, event.mouseButton.x, event.mouseButton.y);
            break;
        case sf::Event::MouseMoved:
            handle_mouse_move(event.mouseMove.x, event.mouseMove.y);
            break;
        case sf::Event::MouseWheelScrolled:
            if (event.mouseWheelScroll.wheel != sf::Mouse::VerticalWheel) break;
            control_.zoom(double(event.mouseWheelScroll.delta));
            moved_ = true;
            break;
        default:
            break;
    }
}

void Viewer::handle_mouse_move(int x, int y)
{
    if (!down_) return;
    if (!dragged_ && std::max(std::abs(x - press_.x), std::abs(y - press_.y)) < min_drag_pixels) return;
    dragged_ = true;
    const double right = x - last_.x, down = y - last_.y;
    last_ = {x, y};
    if (right == 0 && down == 0) return;
    if (button_ == sf::Mouse::Left)
        control_.orbit(right * radians_per_pixel, down * radians_per_pixel);
    else
        control_.pan(right / height_, down / height_);
    moved_ = true;
}

void Viewer::release_mouse(sf::Mouse::Button button, int x, int y)
{
    if (!down_ || button != button_) return;
    down_ = false;
    if (!dragged_ && button == sf::Mouse::Left) request_focus(x, y);
}

void Viewer::request_focus(int x, int y)
{
    Pick where;
    where.x = (x + 0.5) / width_;
    where.y = (y + 0.5) / height_;
    where.aspect = aspect();
    renderer_.pick(control_.through(where.x, where.y, where.aspect, 1.0 / height_), where);
}

void Viewer::handle_key(const sf::Event::KeyEvent& key)
{
    using K = sf::Keyboard;
    if (key.control) {
        if (key.code == K::S) renderer_.save(std::filesystem::path(job_.name).stem().string());
        if (key.code == K::Q || key.code == K::W) window_.close();
        return;
    }
    if (is_fly_key(key.code)) {
        held_.insert(key.code);
        fly_step(key.code, tap_s);
        return;
    }
    switch (key.code) {
        case K::Escape:
            window_.close();
            break;
        case K::H:
        case K::F1:
            help_ = !help_;
            redraw_ = true;
            break;
        case K::F2:
            renderer_.save(std::filesystem::path(job_.name).stem().string());
            break;
        case K::T:
            // The first press switches from OpenColorIO to the tone map, later ones to the next tone map.
            if (!std::exchange(transform_.ocio, nullptr))
                transform_.tonemap = Tonemap((std::size_t(transform_.tonemap) + 1) % std::size(tonemap_names));
            show_message(fmt::format("tone map: {}", tonemap_names[std::size_t(transform_.tonemap)]));
            change_display();
            break;
        case K::N:
            renderer_.toggle_denoising();
            break;
        case K::Tab:
            choose_view((int(view_) + (key.shift ? view_count - 1 : 1)) % view_count);
            break;
        case K::P:
            fmt::print("{}\n", camera_text(control_.camera()));
            std::fflush(stdout);
            show_message("camera printed");
            break;
        case K::R:
            control_.reset();
            moved_ = true;
            break;
        default:
            break;
    }
}

/// Handles characters that are keys of their own on some keyboards and need a modifier on others.
void Viewer::handle_character(std::uint32_t character)
{
    if (character >= '1' && character < '1' + std::uint32_t(view_count)) choose_view(int(character - '1'));
    const double step = character == '+' || character == '=' ? exposure_step : character == '-' ? -exposure_step : 0;
    if (step == 0) return;
    transform_.exposure_ev = std::clamp(transform_.exposure_ev + step, -100.0, 100.0);
    show_message(fmt::format("exposure: {:+.1f} stops", transform_.exposure_ev));
    change_display();
}

void Viewer::fly_by_keys(double seconds)
{
    for (const sf::Keyboard::Key key : held_) fly_step(key, seconds);
}

void Viewer::fly_step(sf::Keyboard::Key key, double seconds)
{
    using K = sf::Keyboard;
    const double step = fly_speed * seconds;
    switch (key) {
        case K::W:
            control_.fly(0, 0, step);
            break;
        case K::S:
            control_.fly(0, 0, -step);
            break;
        case K::A:
            control_.fly(-step, 0, 0);
            break;
        case K::D:
            control_.fly(step, 0, 0);
            break;
        case K::Q:
            control_.fly(0, -step, 0);
            break;
        case K::E:
            control_.fly(0, step, 0);
            break;
        case K::Left:
            control_.look(-step, 0);
            break;
        case K::Right:
            control_.look(step, 0);
            break;
        case K::Up:
            control_.look(0, step);
            break;
        case K::Down:
            control_.look(0, -step);
            break;
        default:
            return;
    }
    moved_ = true;
}

/// Moves the camera back and forth. Each move waits until the last one is visible and for a varying pause, so that
/// moves interrupt passes at any point.
void Viewer::script_step()
{
    const auto now = Clock::now();
    if (!latency_.all_shown() || !frame_.full_size || moved_) {
        next_script_move_ = std::max(next_script_move_, now + 20ms);
        return;
    }
    if (now < next_script_move_) return;
    if (script_moves_made_ == job_.script_moves) {
        window_.close();
        return;
    }
    const double sign = script_moves_made_ & 1 ? -1 : 1;
    switch (script_moves_made_ / 2 % 4) {
        case 0:
            control_.orbit(sign * 0.2, sign * 0.05);
            break;
        case 1:
            control_.pan(sign * 0.1, sign * -0.05);
            break;
        case 2:
            control_.zoom(sign);
            break;
        default:
            control_.fly(sign * 0.05, 0, sign * 0.1);
            break;
    }
    moved_ = true;
    next_script_move_ = now + std::chrono::milliseconds(20 + script_moves_made_ * 37 % 180);
    ++script_moves_made_;
}

std::vector<std::string> Viewer::help_lines() const
{
    return {"left drag         orbit around the focus point",
            "right drag        pan (middle drag, too)",
            "wheel             zoom",
            "click             focus on this point",
            "W A S D Q E       fly (Q down, E up)",
            "arrows            look around",
            "R                 reset the camera",
            "+ -               exposure",
            "T                 tone map",
            "N                 denoising on or off",
            "1 to 8, Tab       image, albedo, normal,",
            "                  depth, position, instance,",
            "                  material, noise",
            "P                 print the camera",
            "Ctrl+S, F2        save PNG and EXR",
            "H, F1             this help",
            "Esc, Ctrl+Q       quit",
            "",
            fmt::format("showing {}, exposure {:+.1f}, {}", name_of(view_), transform_.exposure_ev,
                        transform_.ocio ? "OpenColorIO" : tonemap_names[std::size_t(transform_.tonemap)])};
}

}  // namespace fathom::view
