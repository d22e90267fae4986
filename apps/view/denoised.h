// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <optional>

#include "fathom/denoise.h"
#include "fathom/render.h"

namespace fathom::view {

/// The denoised image, updated while rendering; updates take no more time than rendering does.
class DenoisedImage {
public:
    /// denoiser  none: it is opened at first use
    DenoisedImage(std::optional<Denoiser> denoiser, int threads);

    /// Opens the denoiser if it is not open yet. Throws Error, which says how to install it.
    void open();
    /// Drops the image, because camera or size have changed.
    void reset();
    /// Whether the film has changed enough for an update.
    ///
    /// rendered_s  rendering time of the film's samples
    /// is_last     no more samples will follow
    bool is_due(std::uint64_t samples, double rendered_s, bool is_last) const;
    /// Denoises the film, guided by albedo and normal of a few samples that are rendered first. False if `cancel`
    /// became true.
    bool update(const RenderJob& job, const Film& film, double rendered_s, const std::atomic<bool>& cancel);
    /// Adds the layer "denoised" at full quality, for a file.
    void add_to(Image& image) const;

    /// The latest denoised layer, or null.
    const Image::Layer* layer() const { return layer_ ? &*layer_ : nullptr; }
    const std::string& version() const { return denoiser_->version(); }

private:
    bool render_guides(const RenderJob& job, std::uint64_t samples, const std::atomic<bool>& cancel);
    void append_guides(Image& image) const;

    std::optional<Denoiser> denoiser_;
    int threads_;
    std::optional<Film> guides_;  ///< albedo and normal of the first samples
    std::optional<Image::Layer> layer_;
    std::uint64_t samples_ = 0;            ///< samples per pixel of the latest update
    double rendered_s_ = 0, seconds_ = 0;  ///< rendering time at the latest update, and its duration
};

}  // namespace fathom::view
