#pragma once
#include <atomic>
#include <optional>

#include "fathom/denoise.h"
#include "fathom/render.h"

namespace fathom::view {

/// The picture without its noise: made anew while the picture becomes clear, as often as takes no more time than
/// rendering.
class DenoisedPicture {
public:
    /// denoiser  none: it is opened when it is first needed
    DenoisedPicture(std::optional<Denoiser> denoiser, int threads);

    /// Opens the denoiser if that was not done yet. Throws Error, which says how to get it.
    void open();
    /// Of another camera or size from now on.
    void reset();
    /// Whether it is time to make it: the film has changed enough since the last time. `rendered_s` is how long its
    /// samples took, `is_last` says that no more are to come.
    bool is_due(std::uint64_t samples, double rendered_s, bool is_last) const;
    /// Makes it from the picture's film, and a few samples of what helps, rendered with the film's camera. False if
    /// `cancel` became true meanwhile.
    bool update(const RenderJob& job, const Film& film, double rendered_s, const std::atomic<bool>& cancel);
    /// Takes the noise away with all care, for a file: adds the layer "denoised".
    void add_to(Image& image) const;

    /// The latest; null if there is none.
    const Image::Layer* layer() const { return layer_ ? &*layer_ : nullptr; }
    const std::string& version() const { return denoiser_->version(); }

private:
    bool render_aids(const RenderJob& job, std::uint64_t samples, const std::atomic<bool>& cancel);
    void append_aids(Image& image) const;

    std::optional<Denoiser> denoiser_;
    int threads_;
    std::optional<Film> aids_;  ///< of the first samples of the picture: albedo and normal
    std::optional<Image::Layer> layer_;
    std::uint64_t samples_ = 0;            ///< that it was made of
    double rendered_s_ = 0, seconds_ = 0;  ///< when it was made, and how long that took
};

}  // namespace fathom::view
