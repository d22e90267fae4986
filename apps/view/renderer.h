// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "denoised.h"
#include "display.h"
#include "fathom/render.h"

namespace fathom::view {

/// An image for the window.
struct Frame {
    std::uint64_t move = 0;  ///< number of the latest Renderer::move that the frame shows
    View view = View::image;
    int width = 0, height = 0;
    bool full_size = false, denoised = false;
    std::uint64_t samples = 0, samples_end = 0;  ///< samples per pixel, and their final number
    double samples_per_s = 0;                    ///< pixels times samples
    Image image;
    DisplayScale scale;  ///< the scale that made `pixels`
    std::vector<unsigned char> pixels;
};

/// The point of the image that was clicked, and what was found there.
struct Pick {
    double x = 0, y = 0, aspect = 1;
    double distance = 0;  ///< infinite if nothing was hit
};

/// Renders in a thread of its own and returns frames; no call blocks.
///
/// After a move, it renders one sample at low resolution, one at full size, and then passes that double until they take
/// long. A move cancels the current pass, except one at low resolution, since only those are visible while the camera
/// moves. Denoising runs between passes.
class Renderer {
public:
    /// samples   number per pixel, after which the thread waits for a change
    /// denoiser  none: the image is not denoised at first
    Renderer(Scene scene, const RenderSettings& settings, std::uint64_t samples, const DisplayScale& scale,
             const std::optional<Denoiser>& denoiser);
    ~Renderer();
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    /// Sets camera and image size; returns the number of the move.
    std::uint64_t move(const Camera& camera, int width, int height, double distance);
    void show(View view);
    /// Switches denoising on or off; a message confirms that or gives the error.
    void toggle_denoising();
    /// Sets the display transform of later frames.
    void set_transform(const DisplayTransform& transform);
    /// Requests the distance that a camera of one pixel sees; the answer is in an update.
    void pick(const Camera& camera, const Pick& where);
    /// Writes `stem`-NNNN.png and .exr, with the first free number, once the image has a sample.
    void save(const std::string& stem);

    struct Update {
        std::optional<Frame> frame;  ///< latest frame
        std::optional<Pick> pick;
        std::vector<std::string> messages;
    };
    /// Waits for news, with a timeout, and returns them.
    Update wait(std::chrono::microseconds longest);

private:
    struct Target {
        Film film;
        std::uint64_t move;
    };
    /// The request that the thread works on.
    struct Work {
        Camera camera;
        int width = 0, height = 0;
        std::uint64_t move = 0;
        View view = View::image;
        bool denoise = false;
        DisplayScale scale;
    };
    struct PickRequest {
        Camera camera;
        Pick where;
    };
    struct Pass {
        Target* target;
        RenderJob job;
        SampleRange range;
        bool full_size;
    };
    void run();
    void accept_request();
    template <class Act>
    bool run_unlocked(std::unique_lock<std::mutex>& lock, const Act& act);
    bool answer_request(std::unique_lock<std::mutex>& lock);
    bool render_next(std::unique_lock<std::mutex>& lock);
    bool has_request() const;
    void report_denoising();
    std::optional<Pass> next_pass();
    std::optional<Pass> full_pass(View film);
    Target& target(View view, const RenderJob& job, bool full_size);
    RenderSettings settings_for(View view) const;
    RenderJob job_for(const RenderSettings& settings) const;
    std::uint64_t samples_end(View film) const;
    std::uint64_t image_samples() const;
    bool render(const Pass& pass);
    void publish(const Pass& pass);
    bool is_denoised(const Pass& pass) const;
    bool denoising_is_due(const Target& image) const;
    void publish_frame(const Pass& pass, const Image::Layer* denoised);
    void answer_pick(PickRequest request);
    void save_image(const std::string& stem);
    void post_message(const std::string& message);

    // Used by the thread only.
    const Scene scene_;
    const RenderSettings settings_;
    const std::uint64_t samples_;
    Work work_;
    bool shown_ = false;                  ///< a frame of the current move and view was published
    double pass_s_ = 0;                   ///< time per sample of the last pass at full size
    double rendered_s_ = 0;               ///< time of all passes since the move
    std::uint64_t rendered_samples_ = 0;  ///< pixels times samples
    std::map<View, Target> films_, previews_;
    DenoisedImage denoised_;

    std::mutex mutex_;
    std::condition_variable wake_, news_;
    Work request_;
    std::optional<PickRequest> pick_request_;
    std::optional<std::string> save_request_;
    Update update_;
    bool has_news_ = false, quit_ = false, interruptible_ = true;
    std::atomic<bool> cancel_ = false;
    std::thread thread_;
};

}  // namespace fathom::view
