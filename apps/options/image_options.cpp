#include "options/image_options.h"

#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <cmath>

#include "commands/commands.h"
#include "fathom/error.h"
#include "fathom/film_file.h"

namespace fathom::cli {

namespace fs = std::filesystem;

namespace {

const std::vector<std::string> tonemap_words(std::begin(tonemap_names), std::end(tonemap_names));

const std::vector<std::string> primaries_words(std::begin(primaries_names), std::end(primaries_names));

bool is_exr(const std::filesystem::path& file)
{
    std::string extension = file.extension().string();
    for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
    return extension == ".exr";
}

Tonemap tonemap_for(const PictureOptions& options, const RenderHints& hints)
{
    if (options.tonemap) return *options.tonemap;
    if (!hints.tonemap) return Tonemap::khronos_neutral;
    const auto name = std::find(tonemap_words.begin(), tonemap_words.end(), *hints.tonemap);
    if (name == tonemap_words.end())
        throw Error("", "tonemap",
                    fmt::format("expected {}, found '{}'", fmt::join(tonemap_words, " or "), *hints.tonemap));
    return Tonemap(name - tonemap_words.begin());
}

/// Instead of a tone map.
void add_ocio_options(Command& command, PictureOptions& options)
{
    const auto add = [&](const char* name, const char* value, const char* help, std::string& to) {
        command.add_value(name, value, help, [&options, &to](const std::string& text) {
            to = text;
            options.uses_ocio = true;
        });
    };
    command.add_value("--ocio", "CONFIG|env",
                      "a configuration of OpenColorIO makes PNG, JPEG, WebP, AVIF and window instead of --tonemap: its "
                      "file, the name of a built-in one (ocio://...), or env for what $OCIO names",
                      [&](const std::string& text) {
                          options.ocio.config = text == "env" ? "" : text;
                          options.uses_ocio = true;
                      });
    add("--ocio-display", "NAME", "of that configuration, without --ocio of $OCIO (default: its first)",
        options.ocio.display);
    add("--ocio-view", "NAME", "of that display (default: its first)", options.ocio.view);
    add("--ocio-look", "NAME", "of that configuration, instead of the view's own", options.ocio.look);
    add("--ocio-input", "NAME", "what that configuration calls linear Rec.709 (default: found by its usual names)",
        options.ocio.input);
}

}  // namespace

void add_display_options(Command& command, PictureOptions& options)
{
    command.add_value("--exposure", "STOPS",
                      "brighter (+) or darker (-) PNG, JPEG, WebP, AVIF and window, in powers of two",
                      [&](const std::string& text) { options.exposure_ev = parse_number(text, -100, 100); });
    command.add_value(
        "--white-balance", "KELVIN",
        "light of this temperature is white in PNG, JPEG, WebP, AVIF and window: 2700 for lamps, 6504 for "
        "daylight, which is as it is (default)",
        [&](const std::string& text) {
            options.white_kelvin = parse_number(text, min_white_kelvin, max_white_kelvin);
        });
    command.add_value(
        "--tonemap", "NAME",
        "for PNG, JPEG, WebP, AVIF and window: khronos-neutral (default) keeps the colours of surfaces, agx and aces "
        "are like film, filmic is a simple curve, srgb shows radiance up to 1 as it is, so that pictures can be "
        "compared",
        [&](const std::string& text) { options.tonemap = Tonemap(parse_word(text, tonemap_words)); });
    add_ocio_options(command, options);
    command.add_flag_or_word("--denoise",
                             "take the noise away by Open Image Denoise (`pip install pyoidn`): of PNG, JPEG, WebP, "
                             "AVIF, HDR and window; EXR keeps the "
                             "picture as it is and gets a layer `denoised`. `--denoise auto`: only if it is there",
                             [&](const std::string& text) {
                                 options.denoise =
                                     parse_word(text, {"true", "auto"}) == 1 ? Denoising::automatic : Denoising::on;
                             });
}

void add_picture_options(Command& command, PictureOptions& options)
{
    command.add_files("-o,--output", options.outputs,
                      "file to write: .exr, .png, .jpg, .webp, .avif or .hdr; may be given several times");
    add_display_options(command, options);
    command.add_value("--png-bits", "8|16", "bits per channel of PNG (default 8)",
                      [&](const std::string& text) { options.png_bits = parse_word(text, {"8", "16"}) ? 16 : 8; });
    command.add_value("--quality", "1..100",
                      "of JPEG and AVIF (default 95; 100 is AVIF without loss), and of WebP (default: without loss)",
                      [&](const std::string& text) { options.quality = int(parse_integer(text, 1, 100)); });
    command.add_value("--exr", "half|float",
                      "numbers of EXR (default float); half: of colors up to 65504, all else stays float",
                      [&](const std::string& text) { options.exr_half = parse_word(text, {"half", "float"}) == 0; });
    command.add_value(
        "--exr-primaries", "rec709|acescg",
        "what red, green and blue of EXR are: linear Rec.709 (default), or ACEScg, which the file then says",
        [&](const std::string& text) { options.exr_primaries = Primaries(parse_word(text, primaries_words)); });
}

bool writes_exr(const PictureOptions& options)
{
    return std::any_of(options.outputs.begin(), options.outputs.end(), is_exr);
}

WriteOptions write_options(const PictureOptions& options, const RenderHints& hints, Reporter& reporter)
{
    WriteOptions write;
    if (options.uses_ocio) {
        if (options.tonemap) throw UsageError("--tonemap, --ocio: one of both makes the picture");
        write.display.ocio = open_ocio(options.ocio);
        reporter.note("OpenColorIO: " + ocio_text(*write.display.ocio));
    }
    write.display.exposure_ev = options.exposure_ev.value_or(hints.exposure.value_or(0));
    write.display.white_kelvin = options.white_kelvin ? options.white_kelvin : hints.white_balance;
    write.png_bits = options.png_bits;
    write.exr_half = options.exr_half;
    write.exr_primaries = options.exr_primaries;
    write.display.tonemap = tonemap_for(options, hints);
    if (options.quality) write.jpeg_quality = write.avif_quality = *options.quality;
    write.webp_quality = options.quality;
    return write;
}

void use_light(const AutoLitScene& lit, const PictureOptions& options, RenderSettings& settings,
               DisplayTransform& display, Reporter& reporter)
{
    if (!lit.added.empty()) reporter.note(fmt::format("light: added {}", fmt::join(lit.added, ", ")));
    if (lit.exposure_ev && !options.exposure_ev) display.exposure_ev = *lit.exposure_ev;
    if (lit.backdrop && !settings.background) settings.background = studio_backdrop;
}

std::optional<Denoiser> open_denoiser(const PictureOptions& options, int threads, Reporter& reporter)
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
        fmt::format("denoising by Open Image Denoise {} ({})", denoiser->version(), denoiser->file().string()));
    return denoiser;
}

namespace {

/// Writes to the first other folder that takes the file, under a name that is free there; nothing if none does.
template <class Write>
std::optional<fs::path> write_elsewhere(const fs::path& file, const Write& write)
{
    std::error_code error;
    for (const fs::path& folder : {fs::current_path(error), fs::temp_directory_path(error)}) {
        fs::path other = folder / file.filename();
        if (folder.empty() || fs::exists(other, error) ||
            fs::equivalent(folder, fs::absolute(file).parent_path(), error))
            continue;
        try {
            write(other);
            return other;
        } catch (const Error&) {
            // The next may do.
        }
    }
    return {};
}

/// Tells which layers of colors an EXR of halves has as floats, since half ends at 65504.
void tell_floats(const fs::path& file, const Image& image, Reporter& reporter)
{
    constexpr float max_half = 65504;
    std::vector<std::string> names;
    for (const Image::Layer& layer : image.layers) {
        const bool is_color = layer.name != "variance" &&
                              std::all_of(layer.channels.begin(), layer.channels.end(), [](const std::string& c) {
                                  return c == "R" || c == "G" || c == "B" || c == "A";
                              });
        const bool is_large = std::any_of(layer.pixels.begin(), layer.pixels.end(),
                                          [](float v) { return std::abs(v) > max_half && !std::isinf(v); });
        if (is_color && is_large) names.push_back(layer.name.empty() ? "the image" : "the layer " + layer.name);
    }
    if (!names.empty())
        reporter.note(fmt::format("{}: {} has values above 65504, which half can't hold: written as float",
                                  file.string(), fmt::join(names, " and ")));
}

}  // namespace

bool write_pictures(const PictureOptions& options, const Image& image, const Film* sums, const WriteOptions& write,
                    Reporter& reporter)
{
    bool all = true;
    const Image shown = shown_picture(image);
    for (const auto& file : options.outputs) {
        const auto write_to = [&](const fs::path& place) {
            if (is_exr(file) && sums)
                write_film(place, *sums, image, write);
            else
                write_image(place, is_exr(file) ? image : shown, write);
        };
        try {
            write_to(file);
            reporter.written(file.string());
            if (write.exr_half && is_exr(file)) tell_floats(file, image, reporter);
        } catch (const Error& error) {
            // Hours may have gone into it.
            reporter.error(error.what());
            if (const auto other = write_elsewhere(file, write_to)) reporter.written(other->string());
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
    const Crop inside = film.key().settings.rendered_pixels();
    Image::Layer layer{"samples", {"Y"}, std::vector<float>(std::size_t(film.width()) * std::size_t(film.height()))};
    for (int y = inside.y0; y < inside.y1; ++y) {
        const auto row = layer.pixels.begin() + std::ptrdiff_t(y) * film.width();
        std::fill(row + inside.x0, row + inside.x1, float(film.samples_per_pixel()));
    }
    return layer;
}

}  // namespace fathom::cli
