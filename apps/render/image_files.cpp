// SPDX-License-Identifier: Apache-2.0
#include "render/image_files.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "fathom/error.h"
#include "fathom/film_file.h"

namespace fathom::cli {

namespace fs = std::filesystem;

namespace {

/// Writes the file to the working folder or that of temporary files, where its name is free; nothing if both fail.
template <class Write>
std::optional<fs::path> write_elsewhere(const fs::path& file, const std::string& format, const Write& write)
{
    std::error_code error;
    for (const fs::path& folder : {fs::current_path(error), fs::temp_directory_path(error)}) {
        fs::path other = folder / file.filename();
        if (file == "/dev/stdout") other += "." + format;
        if (folder.empty() || fs::exists(other, error) ||
            fs::equivalent(folder, fs::absolute(file).parent_path(), error))
            continue;
        try {
            write(other);
            return other;
        } catch (const Error&) {
            // The next folder is tried.
        }
    }
    return {};
}

/// Reports color layers that an EXR of halves keeps as floats, since half ends at 65504.
void report_float_layers(const fs::path& file, const Image& image, Reporter& reporter)
{
    constexpr float max_half = 65504;
    std::vector<std::string> names;
    for (const Image::Layer& layer : image.layers) {
        const bool is_large = std::any_of(layer.pixels.begin(), layer.pixels.end(),
                                          [](float v) { return std::abs(v) > max_half && !std::isinf(v); });
        if (layer.is_color() && is_large) names.push_back(layer.name.empty() ? "the image" : "the layer " + layer.name);
    }
    if (!names.empty())
        reporter.note(fmt::format("{}: {} has values above 65504, which half can't hold: written as float",
                                  file.string(), fmt::join(names, " and ")));
}

}  // namespace

bool write_images(const ImageOptions& options, const Image& image, const Film* sums, const WriteOptions& write,
                  Reporter& reporter)
{
    bool all_written = true;
    const Image shown = display_image(image);
    for (const auto& file : options.outputs) {
        const auto write_to = [&](const fs::path& target) {
            if (is_exr(options.format, file) && sums)
                write_film(target, *sums, image, write);
            else
                write_image(target, is_exr(options.format, file) ? image : shown, write);
        };
        try {
            write_to(file);
            reporter.written(file.string());
            if (write.exr_half && is_exr(options.format, file)) report_float_layers(file, image, reporter);
        } catch (const Error& error) {
            // The render may have taken hours, so its image is saved elsewhere if possible.
            reporter.error(error.what());
            if (const auto other = write_elsewhere(file, options.format, write_to)) reporter.written(other->string());
            all_written = false;
        }
    }
    return all_written;
}

Image::Layer sample_count_layer(const Film& film)
{
    const Crop inside = film.key().settings.rendered_pixels();
    Image::Layer layer{"samples", {"Y"}, std::vector<float>(std::size_t(film.width()) * std::size_t(film.height()))};
    for (int y = inside.y0; y < inside.y1; ++y) {
        const auto row = layer.pixels.begin() + std::ptrdiff_t(y) * film.width();
        std::fill(row + inside.x0, row + inside.x1, float(film.samples_per_pixel()));
    }
    return layer;
}

}  // namespace fathom::cli
