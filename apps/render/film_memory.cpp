#include "render/film_memory.h"

#include <fmt/format.h>
#include <algorithm>

namespace fathom::cli {

namespace {

// Bytes for each pixel (bench/memory.py).
constexpr double shown_picture = 16;    // a copy of red, green, blue and alpha
constexpr double encoding = 28;         // or looking for fireflies, whichever takes more
constexpr double encoding_modern = 56;  // WebP, AVIF
constexpr double of_denoiser = 84;      // planes that Open Image Denoise is given, and that it gives
/// What it works with besides, up to what it then cuts the picture in tiles for.
constexpr double within_denoiser = 264, max_within_denoiser = 3e9;
/// A film in a file is packed, but how well is not known before.
constexpr double of_copy = 17.0 / 16;

int channels_of(Aov aov)
{
    return aov == Aov::depth || aov == Aov::instance_id || aov == Aov::material_id ? 1 : 3;
}

double encoding_bytes(const PictureOptions& pictures)
{
    double most = encoding;
    for (const auto& file : pictures.outputs)
        if (file.extension() == ".webp" || file.extension() == ".avif") most = encoding_modern;
    return most + (pictures.png_bits == 16 ? 16 : 0);
}

}  // namespace

std::vector<MemoryEstimate> film_needs(const RenderSettings& settings, const FilmUse& use,
                                       const PictureOptions& pictures)
{
    const double pixels = double(settings.width) * settings.height;
    const auto film = double(Film::bytes_per_pixel(settings));
    int channels = 4 + use.extra_channels;
    for (const Aov aov : settings.aovs) channels += channels_of(aov);
    const double picture = 4 * channels + shown_picture + encoding_bytes(pictures);
    const bool denoised = pictures.denoise != Denoising::off;
    const double copy = film * of_copy + 2 * 4;
    return {
        {fmt::format("film of {}x{}", settings.width, settings.height), pixels * film},
        {"checkpoint", use.is_kept ? pixels * copy : 0},
        {"sums to be written", use.is_mergeable ? pixels * copy : 0},
        {"pictures", pixels * picture},
        {"denoising", denoised ? pixels * of_denoiser + std::min(pixels * within_denoiser, max_within_denoiser) : 0}};
}

}  // namespace fathom::cli
