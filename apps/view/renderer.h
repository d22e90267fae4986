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

/// A picture to show.
struct Frame {
    std::uint64_t move = 0;  ///< the latest call of Renderer::move that it obeys
    View view = View::picture;
    int width = 0, height = 0;
    bool full_size = false, denoised = false;
    std::uint64_t samples = 0, samples_end = 0;  ///< a pixel
    double samples_per_s = 0;                    ///< of pixels
    Image image;
    DisplayScale scale;  ///< what `pixels` were made by
    std::vector<unsigned char> pixels;
};

/// What was found at the point of the picture that a click asked about.
struct Pick {
    double x = 0, y = 0, aspect = 1;
    double distance = 0;  ///< infinite: nothing there
};

/// Renders in a thread of its own, so that nothing that is called here blocks, and hands out what it made.
///
/// After a move: one sample at low resolution, one at full size, and then passes of as many samples as there are until
/// these take long. A move cancels the pass at work, except one at low resolution: while the camera moves all the time,
/// these are what is seen. Where noise is to be taken away, that is done between passes.
class Renderer {
public:
    /// samples   a pixel, after which nothing more is done until something changes
    /// denoiser  of the picture from the start; none: not before it is asked for
    Renderer(Scene scene, const RenderSettings& settings, std::uint64_t samples, const DisplayScale& scale,
             const std::optional<Denoiser>& denoiser);
    ~Renderer();
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    /// The camera and the picture's size from now on; returns the number of the move.
    std::uint64_t move(const Camera& camera, int width, int height, double distance);
    void show(View view);
    /// Takes the picture's noise away, or no longer; a message tells which, or why it can't be.
    void toggle_denoising();
    /// What frames are made with from now on; those made already are not made again.
    void set_transform(const DisplayTransform& transform);
    /// Asks for the distance of what the camera of one pixel sees; the answer comes as an update.
    void pick(const Camera& camera, const Pick& where);
    /// Writes `stem`-NNNN.png and .exr, NNNN being the first number that is free, when the picture has a sample.
    void save(const std::string& stem);

    struct Update {
        std::optional<Frame> frame;  ///< the latest
        std::optional<Pick> pick;
        std::vector<std::string> messages;
    };
    /// What is new; waits for it, at most so long.
    Update wait(std::chrono::microseconds longest);

private:
    struct Target {
        Film film;
        std::uint64_t move;
    };
    /// What the thread works on: the request as it was taken.
    struct Work {
        Camera camera;
        int width = 0, height = 0;
        std::uint64_t move = 0;
        View view = View::picture;
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
    void take_request();
    void tell_denoising();
    std::optional<Pass> next_pass();
    std::optional<Pass> full_pass(View film);
    Target& target(View view, const RenderJob& job, bool full_size);
    RenderSettings settings_for(View view) const;
    RenderJob job_for(const RenderSettings& settings) const;
    std::uint64_t samples_end(View film) const;
    std::uint64_t picture_samples() const;
    bool render(const Pass& pass);
    void publish(const Pass& pass);
    bool is_denoised(const Pass& pass) const;
    bool denoising_is_due(const Target& picture) const;
    void hand_out(const Pass& pass, const Image::Layer* denoised);
    void answer_pick(PickRequest request);
    void save_picture(const std::string& stem);
    void say(const std::string& message);

    // Of the thread alone.
    const Scene scene_;
    const RenderSettings settings_;
    const std::uint64_t samples_;
    Work work_;
    bool shown_ = false;                  ///< something of the move and view at work was handed out
    double pass_s_ = 0;                   ///< how long the last pass at full size took, a sample
    double rendered_s_ = 0;               ///< and all of them since the move
    std::uint64_t rendered_samples_ = 0;  ///< of pixels
    std::map<View, Target> films_, previews_;
    DenoisedPicture denoised_;

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
