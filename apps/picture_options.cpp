#include "picture_options.h"

#include <fmt/format.h>
#include <algorithm>
#include <cctype>

#include "commands.h"
#include "fathom/error.h"

namespace fathom::cli {

const std::vector<std::string> tonemap_names = {"srgb", "filmic"};

void add_display_options(Command& command, PictureOptions& options)
{
    command.add_value("--exposure", "STOPS", "brighter (+) or darker (-) PNG, JPEG and window, in powers of two",
                      [&](const std::string& text) { options.exposure_ev = parse_number(text, -100, 100); });
    command.add_value(
        "--tonemap", "srgb|filmic",
        "for PNG, JPEG and window; srgb (default) shows radiance up to 1 as it is, so that pictures can be compared; "
        "filmic rolls off highlights",
        [&](const std::string& text) { options.tonemap = Tonemap(parse_word(text, tonemap_names)); });
}

void add_picture_options(Command& command, PictureOptions& options)
{
    command.add_files("-o,--output", options.outputs,
                      "file to write: .exr, .png, .jpg or .hdr; may be given several times");
    add_display_options(command, options);
    command.add_value("--png-bits", "8|16", "bits per channel of PNG (default 8)",
                      [&](const std::string& text) { options.png_bits = parse_word(text, {"8", "16"}) ? 16 : 8; });
    command.add_value("--exr", "half|float", "numbers of EXR (default float)",
                      [&](const std::string& text) { options.exr_half = parse_word(text, {"half", "float"}) == 0; });
}

bool writes_exr(const PictureOptions& options)
{
    return std::any_of(options.outputs.begin(), options.outputs.end(), [](const std::filesystem::path& file) {
        std::string extension = file.extension().string();
        for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
        return extension == ".exr";
    });
}

WriteOptions write_options(const PictureOptions& options, const RenderHints& hints)
{
    WriteOptions write;
    write.display.exposure_ev = options.exposure_ev.value_or(hints.exposure.value_or(0));
    write.png_bits = options.png_bits;
    write.exr_half = options.exr_half;
    if (options.tonemap) {
        write.display.tonemap = *options.tonemap;
    } else if (hints.tonemap) {
        const auto name = std::find(tonemap_names.begin(), tonemap_names.end(), *hints.tonemap);
        if (name == tonemap_names.end())
            throw Error("", "tonemap",
                        fmt::format("expected {}, found '{}'", fmt::join(tonemap_names, " or "), *hints.tonemap));
        write.display.tonemap = Tonemap(name - tonemap_names.begin());
    }
    return write;
}

void use_light(const LitScene& lit, const PictureOptions& options, RenderSettings& settings, DisplayTransform& display,
               Reporter& reporter)
{
    constexpr Color backdrop{0.55f, 0.55f, 0.55f};
    if (!lit.added.empty()) reporter.note(fmt::format("light: added {}", fmt::join(lit.added, ", ")));
    if (lit.exposure_ev && !options.exposure_ev) display.exposure_ev = *lit.exposure_ev;
    if (lit.backdrop && !settings.background) settings.background = backdrop;
}

bool write_pictures(const PictureOptions& options, const Image& image, const WriteOptions& write, Reporter& reporter)
{
    bool all = true;
    for (const auto& file : options.outputs) {
        try {
            write_image(file, image, write);
            reporter.written(file.string());
        } catch (const Error& error) {
            reporter.error(error.what());
            all = false;
        }
    }
    return all;
}

std::string text_of(const std::vector<SampleRange>& samples)
{
    std::string text;
    for (const SampleRange& range : samples)
        text += fmt::format("{}{}:{}", text.empty() ? "" : ",", range.first, range.second);
    return text;
}

Image::Layer sample_count_layer(const Film& film)
{
    const Crop inside = film.key().settings.crop.value_or(Crop{0, 0, film.width(), film.height()});
    Image::Layer layer{"samples", {"Y"}, std::vector<float>(std::size_t(film.width()) * std::size_t(film.height()))};
    for (int y = inside.y0; y < inside.y1; ++y) {
        const auto row = layer.pixels.begin() + std::ptrdiff_t(y) * film.width();
        std::fill(row + inside.x0, row + inside.x1, float(film.samples_per_pixel()));
    }
    return layer;
}

}  // namespace fathom::cli
