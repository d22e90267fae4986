#pragma once
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "fathom/api.h"
#include "fathom/image.h"

namespace fathom {

/// Open Image Denoise 2, opened at run time where it is there: Fathom neither contains nor needs it.
class FATHOM_API Denoiser {
public:
    /// Opens the library: what the environment variable FATHOM_OIDN names (its file or folder); else the system's; else
    /// that of Python's package pyoidn, beside the folders of PATH, in $VIRTUAL_ENV or ~/.local. Throws Error, which
    /// says how to get it, if there is none, or none that this machine can run.
    ///
    /// threads  0: as many as there are; the picture doesn't depend on them
    explicit Denoiser(int threads);

    const std::string& version() const;         ///< "2.3.1"
    const std::filesystem::path& file() const;  ///< as it was opened

    /// The picture (R, G, B of the first layer) without its noise, as a layer "denoised". The layers "albedo" and
    /// "normal", where there are such, keep the edges of textures and surfaces sharp. This is biased, as every denoiser
    /// is. Throws Error if the library fails.
    Image::Layer denoise(const Image& image) const;
    /// The same, for a picture that is soon to be another: a few times as fast and a little less clean, since albedo
    /// and normal are taken with their noise. Nothing if `cancel` became true meanwhile.
    std::optional<Image::Layer> denoise_quickly(const Image& image, const std::atomic<bool>& cancel) const;
    /// Adds the layer that denoise() makes of it, and the attribute "fathom.denoiser", which names the library.
    void add_to(Image& image) const;

private:
    struct Data;
    std::shared_ptr<const Data> data_;
};

/// What formats of one layer show of it: the layer "denoised", if there is one, in the place of the first, whose alpha
/// stays.
FATHOM_API Image display_image(const Image& image);

}  // namespace fathom
