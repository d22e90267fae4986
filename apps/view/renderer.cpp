// SPDX-License-Identifier: Apache-2.0
#include "renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace fathom::view {

namespace {

/// Minimum size of the low resolution after a move, if the window is that large.
constexpr int preview_width = 400, preview_height = 300;
/// Passes grow up to about this duration, so that progress is visible and saving does not wait long.
constexpr double max_pass_s = 0.25;
constexpr std::uint64_t max_pass_samples = 1024;
/// Layers of the first hit converge much sooner than the image.
constexpr std::uint64_t aov_samples = 64;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start)
{
    return std::chrono::duration<double>(Clock::now() - start).count();
}

bool uses_image_film(View view)
{
    return view == View::image || view == View::noise;
}

}  // namespace

Renderer::Renderer(Scene scene, const RenderSettings& settings, std::uint64_t samples, const DisplayScale& scale,
                   const std::optional<Denoiser>& denoiser)
    : scene_(std::move(scene)), settings_(settings), samples_(samples), denoised_(denoiser, settings.threads)
{
    request_.denoise = work_.denoise = denoiser.has_value();
    request_.camera = scene_.camera();
    request_.width = settings.width;
    request_.height = settings.height;
    request_.scale = scale;
    request_.move = 1;
    thread_ = std::thread([this] { run(); });
}

Renderer::~Renderer()
{
    {
        const std::lock_guard lock(mutex_);
        quit_ = true;
        cancel_ = true;
    }
    wake_.notify_one();
    thread_.join();
}

std::uint64_t Renderer::move(const Camera& camera, int width, int height, double distance)
{
    const std::lock_guard lock(mutex_);
    request_.camera = camera;
    request_.width = width;
    request_.height = height;
    request_.scale.distance = distance;
    ++request_.move;
    if (interruptible_) cancel_ = true;
    wake_.notify_one();
    return request_.move;
}

void Renderer::show(View view)
{
    const std::lock_guard lock(mutex_);
    request_.view = view;
    if (interruptible_) cancel_ = true;
    wake_.notify_one();
}

void Renderer::toggle_denoising()
{
    const std::lock_guard lock(mutex_);
    request_.denoise = !request_.denoise;
    if (interruptible_) cancel_ = true;
    wake_.notify_one();
}

void Renderer::set_transform(const DisplayTransform& transform)
{
    const std::lock_guard lock(mutex_);
    request_.scale.transform = transform;
}

void Renderer::pick(const Camera& camera, const Pick& where)
{
    const std::lock_guard lock(mutex_);
    pick_request_ = {camera, where};
    if (interruptible_) cancel_ = true;
    wake_.notify_one();
}

void Renderer::save(const std::string& stem)
{
    const std::lock_guard lock(mutex_);
    save_request_ = stem;
    wake_.notify_one();
}

Renderer::Update Renderer::wait(std::chrono::microseconds longest)
{
    std::unique_lock lock(mutex_);
    news_.wait_for(lock, longest, [&] { return has_news_; });
    has_news_ = false;
    return std::exchange(update_, {});
}

void Renderer::post_message(const std::string& message)
{
    const std::lock_guard lock(mutex_);
    update_.messages.push_back(message);
    has_news_ = true;
    news_.notify_one();
}

/// Runs an action without the lock; false if it threw, which is posted as a message.
template <class Act>
bool Renderer::run_unlocked(std::unique_lock<std::mutex>& lock, const Act& act)
{
    bool done = true;
    lock.unlock();
    try {
        act();
    } catch (const std::exception& error) {
        post_message(error.what());
        done = false;
    }
    lock.lock();
    return done;
}

/// Answers a pick, or saves; false if neither was requested or possible.
bool Renderer::answer_request(std::unique_lock<std::mutex>& lock)
{
    if (pick_request_) {
        const PickRequest request = *std::exchange(pick_request_, {});
        run_unlocked(lock, [&] { answer_pick(request); });
        return true;
    }
    if (save_request_ && image_samples() > 0) {
        const std::string stem = *std::exchange(save_request_, {});
        run_unlocked(lock, [&] { save_image(stem); });
        return true;
    }
    return false;
}

/// Renders the next pass; false if none is left, or if it failed.
bool Renderer::render_next(std::unique_lock<std::mutex>& lock)
{
    // A view of another layer is shown, but saving needs a sample of the image.
    const bool only_to_save = save_request_ && !uses_image_film(work_.view);
    bool idle = false;
    const bool done = run_unlocked(lock, [&] {
        const std::optional<Pass> pass = only_to_save ? full_pass(View::image) : next_pass();
        idle = !pass;
        if (pass && render(*pass) && !only_to_save) publish(*pass);
    });
    if (!done) save_request_.reset();
    return done && !idle;
}

bool Renderer::has_request() const
{
    return quit_ || request_.move != work_.move || request_.view != work_.view || request_.denoise != work_.denoise ||
           pick_request_ || save_request_;
}

void Renderer::run()
{
    std::unique_lock lock(mutex_);
    while (!quit_) {
        const bool denoise = work_.denoise;
        accept_request();
        if (work_.denoise != denoise && !run_unlocked(lock, [&] { report_denoising(); }))
            request_.denoise = work_.denoise = false;
        cancel_ = false;
        interruptible_ = true;
        if (answer_request(lock)) continue;
        if (!render_next(lock) && !quit_) wake_.wait(lock, [&] { return has_request(); });
    }
}

/// Called with the lock held.
void Renderer::accept_request()
{
    if (request_.width != work_.width || request_.height != work_.height) {
        films_.clear();
        previews_.clear();
    }
    if (request_.move != work_.move) {
        rendered_s_ = 0;
        rendered_samples_ = 0;
        denoised_.reset();
    }
    if (request_.move != work_.move || request_.view != work_.view || request_.denoise != work_.denoise) shown_ = false;
    work_ = request_;
}

void Renderer::report_denoising()
{
    if (work_.denoise) denoised_.open();
    post_message(work_.denoise ? "denoised with Open Image Denoise " + denoised_.version() : "not denoised");
}

RenderSettings Renderer::settings_for(View view) const
{
    RenderSettings settings = settings_;
    settings.width = work_.width;
    settings.height = work_.height;
    set_aovs(view, settings);
    return settings;
}

/// A job with the current camera.
RenderJob Renderer::job_for(const RenderSettings& settings) const
{
    return RenderJob(scene_, work_.camera, settings);
}

Renderer::Target& Renderer::target(View view, const RenderJob& job, bool full_size)
{
    auto& targets = full_size ? films_ : previews_;
    auto found = targets.find(view);
    if (found == targets.end()) found = targets.emplace(view, Target{Film(job), work_.move}).first;
    Target& t = found->second;
    if (t.move != work_.move) {
        t.film.reset(job);
        t.move = work_.move;
    }
    return t;
}

std::uint64_t Renderer::image_samples() const
{
    const auto found = films_.find(View::image);
    return found != films_.end() && found->second.move == work_.move ? found->second.film.samples_per_pixel() : 0;
}

std::optional<Renderer::Pass> Renderer::full_pass(View film)
{
    const RenderJob job = job_for(settings_for(film));
    Target& t = target(film, job, true);
    const std::uint64_t done = t.film.samples_per_pixel();
    const std::uint64_t end = samples_end(film);
    // An empty pass publishes existing samples at once, when a view is chosen again or denoising is due.
    if (done > 0 && (!shown_ || denoising_is_due(t))) return Pass{&t, job, {done, done}, true};
    if (done >= end) return {};
    const double fit = pass_s_ > 0 ? max_pass_s / pass_s_ : 1;
    std::uint64_t count = std::clamp<std::uint64_t>(done, 1, max_pass_samples);
    count = std::min(count, std::uint64_t(std::clamp(fit, 1.0, double(max_pass_samples))));
    return Pass{&t, job, {done, std::min(done + count, end)}, true};
}

std::optional<Renderer::Pass> Renderer::next_pass()
{
    const View film = uses_image_film(work_.view) ? View::image : work_.view;
    const auto kept = films_.find(film);
    const bool has_samples =
        kept != films_.end() && kept->second.move == work_.move && kept->second.film.samples_per_pixel() > 0;
    const double scale = std::max(double(preview_width) / work_.width, double(preview_height) / work_.height);
    if (shown_ || has_samples || scale >= 1) return full_pass(film);
    RenderSettings settings = settings_for(film);
    settings.width = int(std::ceil(work_.width * scale));
    settings.height = int(std::ceil(work_.height * scale));
    const RenderJob job = job_for(settings);
    Target& t = target(film, job, false);
    // The film already holds a sample if another view was chosen before this one was shown at full size.
    if (t.film.samples_per_pixel() > 0) t.film.reset(job);
    return Pass{&t, job, {0, 1}, false};
}

std::uint64_t Renderer::samples_end(View film) const
{
    return uses_image_film(film) ? samples_ : std::min(samples_, aov_samples);
}

bool Renderer::render(const Pass& pass)
{
    if (!pass.full_size) {
        const std::lock_guard lock(mutex_);
        // A newer request goes first; later ones wait for the end of this pass.
        if (cancel_) return false;
        interruptible_ = false;
    }
    const auto start = Clock::now();
    const std::uint64_t samples = pass.range.second - pass.range.first;
    if (samples == 0) return true;
    if (!render_pass(pass.job, pass.range, pass.target->film, cancel_)) return false;
    if (!pass.full_size) return true;
    const double seconds = seconds_since(start);
    pass_s_ = seconds / double(samples);
    rendered_s_ += seconds;
    rendered_samples_ += samples * std::uint64_t(pass.job.settings().width) * std::uint64_t(pass.job.settings().height);
    return true;
}

/// Publishes the noisy image first, and then the denoised one, which takes longer.
void Renderer::publish(const Pass& pass)
{
    if (!is_denoised(pass)) return publish_frame(pass, nullptr);
    if (!denoised_.layer()) publish_frame(pass, nullptr);
    if (denoising_is_due(*pass.target) && !denoised_.update(pass.job, pass.target->film, rendered_s_, cancel_)) return;
    publish_frame(pass, denoised_.layer());
}

bool Renderer::is_denoised(const Pass& pass) const
{
    return work_.denoise && work_.view == View::image && pass.full_size;
}

bool Renderer::denoising_is_due(const Target& image) const
{
    const std::uint64_t samples = image.film.samples_per_pixel();
    return work_.denoise && work_.view == View::image &&
           denoised_.is_due(samples, rendered_s_, samples >= samples_end(View::image));
}

/// denoised  the colors of the image, or null
void Renderer::publish_frame(const Pass& pass, const Image::Layer* denoised)
{
    Frame frame;
    frame.move = work_.move;
    frame.view = work_.view;
    frame.width = pass.job.settings().width;
    frame.height = pass.job.settings().height;
    frame.full_size = pass.full_size;
    frame.samples = pass.full_size ? pass.target->film.samples_per_pixel() : 0;
    frame.samples_end = samples_end(work_.view);
    if (rendered_s_ > 0) frame.samples_per_s = double(rendered_samples_) / rendered_s_;
    frame.image = pass.target->film.image(false, work_.view == View::noise);
    if (denoised) frame.image.layers[0].pixels = denoised->pixels;
    frame.denoised = denoised != nullptr;
    mark_misses(work_.view, frame.image);
    frame.scale = work_.scale;
    frame.pixels =
        display_pixels(work_.view, layer_of(work_.view, frame.image), frame.width, frame.height, work_.scale);
    shown_ = true;
    const std::lock_guard lock(mutex_);
    update_.frame = std::move(frame);
    has_news_ = true;
    news_.notify_one();
}

void Renderer::answer_pick(PickRequest request)
{
    RenderSettings settings = settings_;
    settings.width = settings.height = 1;
    settings.filter = Filter::box;
    settings.aovs = {Aov::depth};
    settings.max_depth = 0;
    const RenderJob job(scene_, request.camera, settings);
    Film film(job);
    fathom::render(job, {0, 1}, film);
    const Image image = film.image(false, false);
    request.where.distance = image.find("depth")->pixels[0];
    const std::lock_guard lock(mutex_);
    update_.pick = request.where;
    has_news_ = true;
    news_.notify_one();
}

void Renderer::save_image(const std::string& stem)
{
    namespace fs = std::filesystem;
    std::string name;
    for (int number = 1; name.empty() || fs::exists(name + ".png") || fs::exists(name + ".exr"); ++number)
        name = fmt::format("{}-{:04}", stem, number);
    const Film& film = films_.at(View::image).film;
    Image image = film.image(settings_.alpha, true);
    for (const auto& [view, target] : films_) {
        if (view == View::image || target.move != work_.move || target.film.samples_per_pixel() == 0) continue;
        image.layers.push_back(layer_of(view, target.film.image(false, false)));
    }
    image.attributes = {{"fathom.scene", stem},
                        {"fathom.samples_per_pixel", fmt::format("{}", film.samples_per_pixel())},
                        {"fathom.seed", fmt::format("{}", settings_.seed)}};
    if (work_.denoise) denoised_.add_to(image);
    WriteOptions options;
    options.display = work_.scale.transform;
    write_image(name + ".png", display_image(image), options);
    write_image(name + ".exr", image, options);
    post_message(fmt::format("saved {0}.png and {0}.exr", name));
}

}  // namespace fathom::view
