// SPDX-License-Identifier: Apache-2.0
#include "denoised.h"

#include <algorithm>
#include <chrono>

namespace fathom::view {

namespace {

/// Albedo and normal converge much sooner than the image.
constexpr std::uint64_t max_guide_samples = 16;

}  // namespace

DenoisedImage::DenoisedImage(std::optional<Denoiser> denoiser, int threads)
    : denoiser_(std::move(denoiser)), threads_(threads)
{
}

void DenoisedImage::open()
{
    if (!denoiser_) denoiser_.emplace(threads_);
}

void DenoisedImage::reset()
{
    guides_.reset();
    layer_.reset();
    samples_ = 0;
    rendered_s_ = 0;
}

bool DenoisedImage::is_due(std::uint64_t samples, double rendered_s, bool is_last) const
{
    if (!layer_) return samples > 0;
    if (is_last) return samples > samples_;
    return samples >= samples_ + samples_ / 2 && rendered_s - rendered_s_ >= seconds_;
}

bool DenoisedImage::update(const RenderJob& job, const Film& film, double rendered_s, const std::atomic<bool>& cancel)
{
    const auto start = std::chrono::steady_clock::now();
    const std::uint64_t samples = film.samples_per_pixel();
    if (!render_guides(job, std::min(samples, max_guide_samples), cancel)) return false;
    Image image = film.image(false, false);
    append_guides(image);
    std::optional<Image::Layer> layer = denoiser_->denoise_quickly(image, cancel);
    if (!layer) return false;
    layer_ = std::move(layer);
    samples_ = samples;
    rendered_s_ = rendered_s;
    seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return true;
}

void DenoisedImage::add_to(Image& image) const
{
    Image with_guides = image;
    append_guides(with_guides);
    denoiser_->add_to(with_guides);
    image.layers.push_back(std::move(with_guides.layers.back()));
    image.attributes = std::move(with_guides.attributes);
}

bool DenoisedImage::render_guides(const RenderJob& job, std::uint64_t samples, const std::atomic<bool>& cancel)
{
    RenderSettings settings = job.settings();
    settings.aovs = {Aov::albedo, Aov::normal};
    const RenderJob guides(job.scene(), job.camera(), settings);
    if (!guides_) guides_.emplace(guides);
    const std::uint64_t done = guides_->samples_per_pixel();
    return done >= samples || render_pass(guides, {done, samples}, *guides_, cancel);
}

void DenoisedImage::append_guides(Image& image) const
{
    if (!guides_) return;
    Image guides = guides_->image(false, false);
    for (const char* name : {"albedo", "normal"})
        if (!image.find(name)) image.layers.push_back(*guides.find(name));
}

}  // namespace fathom::view
