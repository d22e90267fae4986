// SPDX-License-Identifier: Apache-2.0
#include "viewer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fathom/error.h"

namespace fathom::view {

namespace {

using namespace std::chrono_literals;

constexpr auto message_time = 4s;
/// SFML does not report when another window uncovers this one, so it is redrawn at this interval.
constexpr auto max_redraw_interval = 250ms;

RenderSettings check_size(const RenderSettings& settings)
{
    const int max_size = int(sf::Texture::getMaximumSize());
    if (settings.width > max_size || settings.height > max_size)
        throw Error("", "--size",
                    fmt::format("a window of {}x{} is larger than the {}x{} that this display can show", settings.width,
                                settings.height, max_size, max_size));
    return settings;
}

}  // namespace

Viewer::Viewer(const ViewJob& job)
    : job_(job),
      control_(job.scene.camera()),
      transform_(job.display),
      width_(check_size(job.settings).width),
      height_(job.settings.height),
      latency_(job.latency_log.string()),
      next_script_move_(Clock::now() + 1s),
      window_(sf::VideoMode(unsigned(width_), unsigned(height_)), "Fathom"),
      renderer_(job.scene, job.settings, job.samples, {job.display, job.bounds, control_.distance()}, job.denoiser)
{
    if (!window_.isOpen()) throw Error("", "", "no window could be opened on this display");
    window_.setKeyRepeatEnabled(false);
    for (sf::Texture& texture : textures_) texture.setSmooth(true);
    // A window manager may choose another size, and SFML reports only later changes.
    const sf::Vector2u size = window_.getSize();
    if (size.x > 0 && size.y > 0 && (int(size.x) != width_ || int(size.y) != height_)) {
        width_ = int(size.x), height_ = int(size.y);
        renderer_.move(control_.camera(), width_, height_, control_.distance());
    }
    set_title();
}

void Viewer::run()
{
    auto last = Clock::now();
    while (window_.isOpen()) {
        const auto now = Clock::now();
        sf::Event event;
        while (window_.pollEvent(event)) handle(event);
        fly_by_keys(std::min(std::chrono::duration<double>(now - last).count(), 0.1));
        last = now;
        if (job_.script_moves > 0) script_step();
        if (moved_) move_camera(now);
        if (job_.interrupted && *job_.interrupted) window_.close();
        if (!window_.isOpen()) break;
        // A new frame ends the wait; events are polled after it.
        apply_update(renderer_.wait(busy() ? 3ms : 15ms));
        if (!message_.empty() && Clock::now() > message_end_) {
            message_.clear();
            redraw_ = true;
        }
        if (redraw_ || Clock::now() - last_draw_ > max_redraw_interval) draw();
    }
    if (job_.script_moves > 0) fmt::print("{}\n", latency_.summary());
}

bool Viewer::busy() const
{
    return down_ || !held_.empty() || job_.script_moves > 0 || frame_.samples < frame_.samples_end;
}

void Viewer::move_camera(Clock::time_point when)
{
    moved_ = false;
    latency_.record_move(renderer_.move(control_.camera(), width_, height_, control_.distance()), when);
}

void Viewer::choose_view(int view)
{
    view_ = View(view);
    renderer_.show(view_);
    show_message(fmt::format("showing: {}", name_of(view_)));
}

void Viewer::change_display()
{
    renderer_.set_transform(transform_);
    if (frame_.pixels.empty()) return;
    frame_.scale.transform = transform_;
    frame_.pixels =
        display_pixels(frame_.view, layer_of(frame_.view, frame_.image), frame_.width, frame_.height, frame_.scale);
    upload(std::move(frame_));
}

void Viewer::apply_update(Renderer::Update update)
{
    for (const std::string& message : update.messages) {
        fmt::print(stderr, "fathom: {}\n", message);
        show_message(message);
    }
    if (update.pick) {
        if (!std::isfinite(update.pick->distance)) {
            show_message("nothing to focus on here");
        } else {
            moved_ |= control_.focus(update.pick->x, update.pick->y, update.pick->aspect, update.pick->distance);
            show_message(fmt::format("focus: {:.4g} m", control_.distance()));
        }
    }
    if (!update.frame) return;
    upload(std::move(*update.frame));
    // The frame may have been made before the exposure or tone map changed.
    if (frame_.scale.transform.exposure_ev != transform_.exposure_ev ||
        frame_.scale.transform.tonemap != transform_.tonemap || frame_.scale.transform.ocio != transform_.ocio)
        change_display();
    draw();
    latency_.record_frame(frame_.move, frame_.width, frame_.height, frame_.full_size, last_draw_);
    set_title();
}

void Viewer::upload(Frame frame)
{
    frame_ = std::move(frame);
    sf::Texture& texture = textures_[frame_.full_size];
    const sf::Vector2u size(unsigned(frame_.width), unsigned(frame_.height));
    if (texture.getSize() != size && !texture.create(size.x, size.y))
        throw Error("", "", fmt::format("the display has no memory for an image of {}x{}", size.x, size.y));
    texture.update(frame_.pixels.data());
    redraw_ = true;
}

void Viewer::draw()
{
    window_.clear();
    if (!frame_.pixels.empty()) {
        sf::Sprite sprite(textures_[frame_.full_size]);
        sprite.setScale(float(width_) / float(frame_.width), float(height_) / float(frame_.height));
        // Blending would mix straight alpha with the black background.
        window_.draw(sprite, sf::RenderStates(sf::BlendNone));
    }
    if (help_) overlay_.draw(window_, help_lines(), Overlay::Corner::top_left);
    if (!message_.empty()) overlay_.draw(window_, {message_}, Overlay::Corner::bottom_left);
    window_.display();
    redraw_ = false;
    last_draw_ = Clock::now();
}

void Viewer::set_title()
{
    std::string title = job_.name;
    // The title describes the frame on the screen, which may be older than the latest request.
    if (frame_.view != View::image) title += fmt::format(" [{}]", name_of(frame_.view));
    title += fmt::format(" - {} of {} samples, {} %", frame_.samples, std::max<std::uint64_t>(frame_.samples_end, 1),
                         frame_.samples * 100 / std::max<std::uint64_t>(frame_.samples_end, 1));
    if (frame_.samples_per_s > 0) title += fmt::format(" - {:.3g} M samples/s", frame_.samples_per_s / 1e6);
    if (frame_.denoised) title += " - denoised";
    if (transform_.exposure_ev != 0) title += fmt::format(" - exposure {:+.1f}", transform_.exposure_ev);
    if (title == title_) return;
    title_ = title;
    window_.setTitle(sf::String::fromUtf8(title.begin(), title.end()));
}

void Viewer::show_message(const std::string& text)
{
    message_ = text;
    message_end_ = Clock::now() + message_time;
    redraw_ = true;
    set_title();
}

}  // namespace fathom::view
