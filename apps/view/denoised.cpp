#include "denoised.h"

#include <algorithm>
#include <chrono>

namespace fathom::view {

namespace {

/// Albedo and normal are clear enough to help long before the picture is.
constexpr std::uint64_t max_aid_samples = 16;

}  // namespace

DenoisedPicture::DenoisedPicture(std::optional<Denoiser> denoiser, int threads)
    : denoiser_(std::move(denoiser)), threads_(threads)
{
}

void DenoisedPicture::open()
{
    if (!denoiser_) denoiser_.emplace(threads_);
}

void DenoisedPicture::reset()
{
    aids_.reset();
    layer_.reset();
    samples_ = 0;
    rendered_s_ = 0;
}

bool DenoisedPicture::is_due(std::uint64_t samples, double rendered_s, bool is_last) const
{
    if (!layer_) return samples > 0;
    if (is_last) return samples > samples_;
    return samples >= samples_ + samples_ / 2 && rendered_s - rendered_s_ >= seconds_;
}

bool DenoisedPicture::update(const RenderJob& job, const Film& film, double rendered_s, const std::atomic<bool>& cancel)
{
    const auto start = std::chrono::steady_clock::now();
    const std::uint64_t samples = film.samples_per_pixel();
    if (!render_aids(job, std::min(samples, max_aid_samples), cancel)) return false;
    Image image = film.image(false, false);
    append_aids(image);
    std::optional<Image::Layer> layer = denoiser_->denoise_quickly(image, cancel);
    if (!layer) return false;
    layer_ = std::move(layer);
    samples_ = samples;
    rendered_s_ = rendered_s;
    seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return true;
}

void DenoisedPicture::add_to(Image& image) const
{
    Image with_aids = image;
    append_aids(with_aids);
    denoiser_->add_to(with_aids);
    image.layers.push_back(std::move(with_aids.layers.back()));
    image.attributes = std::move(with_aids.attributes);
}

bool DenoisedPicture::render_aids(const RenderJob& job, std::uint64_t samples, const std::atomic<bool>& cancel)
{
    RenderSettings settings = job.settings();
    settings.aovs = {Aov::albedo, Aov::normal};
    const RenderJob aids(job.scene(), job.camera(), settings);
    if (!aids_) aids_.emplace(aids);
    const std::uint64_t done = aids_->samples_per_pixel();
    return done >= samples || render_pass(aids, {done, samples}, *aids_, cancel);
}

void DenoisedPicture::append_aids(Image& image) const
{
    if (!aids_) return;
    Image aids = aids_->image(false, false);
    for (const char* name : {"albedo", "normal"})
        if (!image.find(name)) image.layers.push_back(*aids.find(name));
}

}  // namespace fathom::view
