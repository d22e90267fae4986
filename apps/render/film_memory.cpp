// SPDX-License-Identifier: Apache-2.0
#include "render/film_memory.h"

#include <fmt/format.h>
#include <algorithm>

namespace fathom::cli {

namespace {

// Bytes per pixel, measured with bench/memory.py.
constexpr double display_copy = 16;     // red, green, blue and alpha as floats
constexpr double encoding = 28;         // or the search for fireflies, whichever takes more
constexpr double encoding_modern = 56;  // WebP, AVIF
constexpr double denoiser_planes = 84;  // input and output of Open Image Denoise
/// Working memory of Open Image Denoise, which splits larger images into tiles.
constexpr double denoiser_work = 264, max_denoiser_work_bytes = 3e9;
/// A film in a file is packed, but its size is not known in advance.
constexpr double film_copy_factor = 17.0 / 16;

int channels_of(Aov aov)
{
    return aov == Aov::depth || aov == Aov::instance_id || aov == Aov::material_id ? 1 : 3;
}

double encoding_bytes(const ImageOptions& images)
{
    double bytes = encoding;
    for (const auto& file : images.outputs)
        if (const std::string format = images.format.empty() ? file.extension().string() : "." + images.format;
            format == ".webp" || format == ".avif")
            bytes = encoding_modern;
    return bytes + (images.png_bits == 16 ? 16 : 0);
}

}  // namespace

std::vector<MemoryEstimate> film_memory(const RenderSettings& settings, const FilmUse& use, const ImageOptions& images)
{
    const double pixels = double(settings.width) * settings.height;
    const auto film = double(Film::bytes_per_pixel(settings));
    int channels = 4 + use.extra_channels;
    for (const Aov aov : settings.aovs) channels += channels_of(aov);
    const double image = 4 * channels + display_copy + encoding_bytes(images);
    const double denoising = pixels * denoiser_planes + std::min(pixels * denoiser_work, max_denoiser_work_bytes);
    const double copy = film * film_copy_factor + 2 * 4;
    return {{fmt::format("film of {}x{}", settings.width, settings.height), pixels * film},
            {"checkpoint", use.has_checkpoint ? pixels * copy : 0},
            {"sums in EXR", use.is_mergeable ? pixels * copy : 0},
            {"images", pixels * image},
            {"denoising", images.denoise != Denoising::off ? denoising : 0}};
}

}  // namespace fathom::cli
