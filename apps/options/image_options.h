// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "fathom/denoise.h"
#include "fathom/image.h"
#include "fathom/ocio.h"
#include "fathom/render.h"
#include "options/command.h"
#include "report/reporter.h"

namespace fathom::cli {

/// Whether images are denoised; automatic: where the denoiser is installed.
enum class Denoising { off, automatic, on };

/// Options for the image files that are written: names, formats and tone mapping.
struct ImageOptions {
    std::vector<std::filesystem::path> outputs;
    std::string format;  ///< extension of the format of all outputs; empty: that of each name
    std::optional<double> exposure_ev, white_kelvin;
    std::optional<Tonemap> tonemap;
    OcioChoice ocio;
    bool uses_ocio = false;  ///< instead of a tone map
    int png_bits = 8;
    std::optional<int> quality;  ///< of JPEG, WebP and AVIF
    bool exr_half = false;
    Primaries exr_primaries = Primaries::rec709;
    Denoising denoise = Denoising::off;
};

/// Adds the options that say how radiance is displayed, in files and in a window.
void add_display_options(Command& command, ImageOptions& options);
/// Adds the display options and the options for image files.
///
/// default_output  what -o is without the option
void add_image_options(Command& command, ImageOptions& options, const std::string& default_output);
/// Whether an image is written as EXR. format: ImageOptions::format
bool is_exr(const std::string& format, const std::filesystem::path& file);
/// Adds --output-format.
void add_output_format(Command& command, ImageOptions& options);
bool writes_exr(const ImageOptions& options);

/// Options first, then the scene's hints, then the defaults (docs/tone-mapping.md says why khronos-neutral). Reports
/// which OpenColorIO configuration is used.
WriteOptions resolve_write_options(const ImageOptions& options, const RenderHints& hints, Reporter& reporter);

/// The denoiser, if the options ask for it, and a report of its version. Throws Error if --denoise needs it and it is
/// not installed.
std::optional<Denoiser> open_denoiser(const ImageOptions& options, int threads, Reporter& reporter);

}  // namespace fathom::cli
