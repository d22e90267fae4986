// SPDX-License-Identifier: Apache-2.0
#include "options/image_options.h"

#include <fmt/format.h>
#include <algorithm>
#include <cctype>

#include "fathom/error.h"
#include "options/arguments.h"

namespace fathom::cli {

namespace {

const std::vector<std::string> tonemap_words(std::begin(tonemap_names), std::end(tonemap_names));

const std::vector<std::string> primaries_words(std::begin(primaries_names), std::end(primaries_names));

Tonemap resolve_tonemap(const ImageOptions& options, const RenderHints& hints)
{
    if (options.tonemap) return *options.tonemap;
    if (!hints.tonemap) return Tonemap::khronos_neutral;
    const auto name = std::find(tonemap_words.begin(), tonemap_words.end(), *hints.tonemap);
    if (name == tonemap_words.end())
        throw Error("", "tonemap",
                    fmt::format("expected {}, found '{}'", fmt::join(tonemap_words, " or "), *hints.tonemap));
    return Tonemap(name - tonemap_words.begin());
}

void add_ocio_options(Command& command, ImageOptions& options)
{
    const auto add = [&](const OptionText& text, std::string& value) {
        command.add_value(text, [&options, &value](const std::string& given) {
            value = given;
            options.uses_ocio = true;
        });
    };
    command.add_value({"--ocio", "CONFIG|env",
                       "OpenColorIO configuration to use instead of --tonemap: a file, a built-in one (ocio://...), or "
                       "env for the one that $OCIO names",
                       ""},
                      [&](const std::string& text) {
                          options.ocio.config = text == "env" ? "" : text;
                          options.uses_ocio = true;
                      });
    add({"--ocio-display", "NAME", "display of the configuration, or of $OCIO without --ocio", "its first"},
        options.ocio.display);
    add({"--ocio-view", "NAME", "view of the display", "its first"}, options.ocio.view);
    add({"--ocio-look", "NAME", "look of the configuration", "the view's"}, options.ocio.look);
    add({"--ocio-input", "NAME", "color space of the configuration that is linear Rec.709", "found by its usual names"},
        options.ocio.input);
}

}  // namespace

bool is_exr(const std::string& format, const std::filesystem::path& file)
{
    if (!format.empty()) return format == "exr";
    std::string extension = file.extension().string();
    for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
    return extension == ".exr";
}

void add_output_format(Command& command, ImageOptions& options)
{
    command.begin_group("Output");
    command.add_value({"--output-format", "exr|png|jpg|webp|avif|hdr",
                       "format of all images of -o, whatever their names are; -o - needs it", "by the names"},
                      [&](const std::string& text) {
                          static const std::vector<std::string> formats = {"exr", "png", "jpg", "webp", "avif", "hdr"};
                          options.format = formats[std::size_t(parse_choice(text, formats))];
                      });
}

void add_display_options(Command& command, ImageOptions& options)
{
    command.begin_group("Display");
    command.add_value(
        {"--exposure", "STOPS", "brighten (+) or darken (-) PNG, JPEG, WebP, AVIF and window, in powers of two",
         "the scene's, otherwise chosen automatically"},
        [&](const std::string& text) { options.exposure_ev = parse_number(text, -100, 100); });
    command.add_value({"--white-balance", "KELVIN",
                       "color temperature that is white in PNG, JPEG, WebP, AVIF and window: 2700 for lamps, 6504 for "
                       "daylight",
                       "the scene's, else 6504: colors stay as they are"},
                      [&](const std::string& text) {
                          options.white_kelvin = parse_number(text, min_white_kelvin, max_white_kelvin);
                      });
    command.add_value({"--tonemap", "NAME",
                       "tone map of PNG, JPEG, WebP, AVIF and window: khronos-neutral keeps the colors of surfaces, "
                       "agx and aces resemble film, filmic is a simple curve, srgb keeps radiance up to 1, so that "
                       "images can be compared",
                       "the scene's, else khronos-neutral"},
                      [&](const std::string& text) { options.tonemap = Tonemap(parse_choice(text, tonemap_words)); });
    add_ocio_options(command, options);
    command.add_flag_or_word(
        {"--denoise", "",
         "remove noise with Open Image Denoise (`pip install pyoidn`) from PNG, JPEG, WebP, AVIF, HDR and window; EXR "
         "keeps the image and gets a layer `denoised`. `--denoise auto`: only if it is installed",
         ""},
        [&](const std::string& text) {
            options.denoise = parse_choice(text, {"true", "auto"}) == 1 ? Denoising::automatic : Denoising::on;
        });
}

void add_image_options(Command& command, ImageOptions& options, const std::string& default_output)
{
    command.begin_group("Output");
    command.add_files({"-o,--output", "FILE",
                       "image file to write: .exr, .png, .jpg, .webp, .avif or .hdr; - is the standard output; can be "
                       "repeated",
                       default_output},
                      options.outputs);
    command.add_value({"--png-bits", "8|16", "bits per channel of PNG", "8"},
                      [&](const std::string& text) { options.png_bits = parse_choice(text, {"8", "16"}) ? 16 : 8; });
    command.add_value({"--quality", "1..100", "quality of JPEG, AVIF and WebP; 100 makes AVIF lossless",
                       "95 for JPEG and AVIF, lossless for WebP"},
                      [&](const std::string& text) { options.quality = int(parse_integer(text, 1, 100)); });
    command.add_value({"--exr", "half|float",
                       "number format of EXR; half: for colors up to 65504, everything else stays float", "float"},
                      [&](const std::string& text) { options.exr_half = parse_choice(text, {"half", "float"}) == 0; });
    command.add_value(
        {"--exr-primaries", "rec709|acescg", "color space of EXR: linear Rec.709, or ACEScg, recorded in the file",
         "rec709"},
        [&](const std::string& text) { options.exr_primaries = Primaries(parse_choice(text, primaries_words)); });
    add_display_options(command, options);
}

bool writes_exr(const ImageOptions& options)
{
    return std::any_of(options.outputs.begin(), options.outputs.end(),
                       [&](const std::filesystem::path& file) { return is_exr(options.format, file); });
}

WriteOptions resolve_write_options(const ImageOptions& options, const RenderHints& hints, Reporter& reporter)
{
    WriteOptions write;
    write.format = options.format;
    if (options.uses_ocio) {
        if (options.tonemap) throw UsageError("--tonemap, --ocio: give one of them");
        write.display.ocio = open_ocio(options.ocio);
        reporter.note("OpenColorIO: " + ocio_text(*write.display.ocio));
    }
    write.display.exposure_ev = options.exposure_ev.value_or(hints.exposure.value_or(0));
    write.display.white_kelvin = options.white_kelvin ? options.white_kelvin : hints.white_balance;
    write.png_bits = options.png_bits;
    write.exr_half = options.exr_half;
    write.exr_primaries = options.exr_primaries;
    write.display.tonemap = resolve_tonemap(options, hints);
    if (options.quality) write.jpeg_quality = write.avif_quality = *options.quality;
    write.webp_quality = options.quality;
    return write;
}

std::optional<Denoiser> open_denoiser(const ImageOptions& options, int threads, Reporter& reporter)
{
    if (options.denoise == Denoising::off) return {};
    std::optional<Denoiser> denoiser;
    try {
        denoiser.emplace(threads);
    } catch (const Error& error) {
        if (options.denoise == Denoising::on) throw;
        reporter.note(fmt::format("not denoised: {}", error.what()));
        return {};
    }
    reporter.note(
        fmt::format("denoising with Open Image Denoise {} ({})", denoiser->version(), denoiser->file().string()));
    return denoiser;
}

}  // namespace fathom::cli
