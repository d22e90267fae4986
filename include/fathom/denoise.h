// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "fathom/api.h"
#include "fathom/image.h"

namespace fathom {

/// Open Image Denoise 2 on the CPU. The library is opened at run time; Fathom neither contains nor requires it.
class FATHOM_API Denoiser {
public:
    /// Opens the library. It is searched in this order:
    ///
    /// 1. the file or folder named by the environment variable FATHOM_OIDN, if set
    /// 2. the system's library path
    /// 3. the Python package pyoidn, in $VIRTUAL_ENV, next to the folders of PATH, and in ~/.local
    ///
    /// threads  Number of threads; 0 selects the library's default. It doesn't change the result.
    ///
    /// Throws Error, saying how to install it, if there is no library, or none that works on this machine.
    explicit Denoiser(int threads);

    /// Returns the version of the library, such as "2.3.1".
    const std::string& version() const;
    /// Returns the file name that the library was opened by.
    const std::filesystem::path& file() const;

    /// Denoises the first layer of an image (its first three channels, linear radiance).
    ///
    /// The layers "albedo" and "normal", if present, preserve edges of textures and surfaces; they are denoised first.
    /// Denoising is biased. Returns a layer "denoised" with channels R, G, B. Throws Error if the image has no three
    /// channels or the library fails.
    Image::Layer denoise(const Image& image) const;
    /// Denoises a preview: several times as fast as denoise() and slightly less clean, because the library's balanced
    /// quality is used and albedo and normal are not denoised first. Returns nothing if `cancel` became true meanwhile.
    std::optional<Image::Layer> denoise_quickly(const Image& image, const std::atomic<bool>& cancel) const;
    /// Appends the layer that denoise() returns, and sets the attribute "fathom.denoiser" to name and version of the
    /// library.
    void add_to(Image& image) const;

private:
    struct Data;
    std::shared_ptr<const Data> data_;
};

/// Returns an image with the first layer only, for file formats that hold one layer. If there is a layer "denoised",
/// its colors replace those of the first layer; alpha is kept.
FATHOM_API Image display_image(const Image& image);

}  // namespace fathom
