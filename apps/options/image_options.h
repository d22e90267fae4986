#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "fathom/denoise.h"
#include "fathom/first_look.h"
#include "fathom/image.h"
#include "fathom/ocio.h"
#include "fathom/render.h"
#include "options/arguments.h"
#include "report/reporter.h"

namespace fathom::cli {

/// Whether noise is taken away: automatic is where the denoiser is there.
enum class Denoising { off, automatic, on };

/// Which files are written, and how.
struct PictureOptions {
    std::vector<std::filesystem::path> outputs;
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

/// Those that a window has too: how radiance is shown.
void add_display_options(Command& command, PictureOptions& options);
void add_picture_options(Command& command, PictureOptions& options);
bool writes_exr(const PictureOptions& options);
/// Options first, then what the scene asks for, then khronos-neutral: docs/tone-mapping.md says why. Tells what of
/// OpenColorIO is used.
WriteOptions write_options(const PictureOptions& options, const RenderHints& hints, Reporter& reporter);

/// Tells which light was added, and takes what goes with it: its exposure and a backdrop, where no option says another.
void use_light(const AutoLitScene& lit, const PictureOptions& options, RenderSettings& settings,
               DisplayTransform& display, Reporter& reporter);

/// "0:16,32:48"
std::string text_of(const std::vector<SampleRange>& samples);
/// The denoiser, if it is asked for; told by name. Throws Error if it isn't there, but where that is left open.
std::optional<Denoiser> open_denoiser(const PictureOptions& options, int threads, Reporter& reporter);

/// Writes all files of the options and tells which. EXR has all layers; others show the one that is "denoised", if
/// there is one. False if a file could not be written, which is told too: the others are there, and it is in the
/// working folder or that of temporary files, if one of them takes it.
///
/// sums  of the picture, which EXR is to hold too, or nullptr
bool write_pictures(const PictureOptions& options, const Image& image, const Film* sums, const WriteOptions& write,
                    Reporter& reporter);
/// A layer that tells how many samples each pixel has.
Image::Layer sample_count_layer(const Film& film);

}  // namespace fathom::cli
