#include <fmt/format.h>
#include <algorithm>
#include <memory>

#include "arguments.h"
#include "commands.h"
#include "fathom/error.h"
#include "fathom/memory.h"
#include "fathom/threads.h"
#include "inputs.h"
#include "interrupt.h"
#include "picture_options.h"
#include "render_options.h"
#include "reporter.h"
#include "scene_options.h"
#include "streams.h"

namespace fathom::cli {

namespace {

constexpr std::uint64_t default_samples = 256;

struct OnlySample {
    int x, y;
    std::uint64_t index;
};

struct RenderOptions {
    SceneOptions scene;
    PictureOptions picture;
    SettingsOptions settings;
    std::optional<std::uint64_t> samples;
    std::optional<double> time_s;
    std::optional<SampleRange> range;
    std::optional<OnlySample> only_sample;
    std::optional<Crop> crop;
    std::vector<Aov> aovs;
    bool aov_samples = false, aov_variance = false;
    bool mergeable = false;
    bool quiet = false, json = false;
};

void take_aovs(RenderOptions& o, const std::string& text)
{
    static const std::vector<std::string> names = {"albedo",   "normal",   "depth",   "position",
                                                   "instance", "material", "samples", "variance"};
    constexpr int samples = 6, variance = 7;
    for (const std::string& name : split(text, ',')) {
        const int index = parse_word(name, names);
        if (index == samples)
            o.aov_samples = true;
        else if (index == variance)
            o.aov_variance = true;
        else if (std::find(o.aovs.begin(), o.aovs.end(), Aov(index)) == o.aovs.end())
            o.aovs.push_back(Aov(index));
    }
}

void add_render_options(Command& command, RenderOptions& o)
{
    command.add_value("--spp", "N", "samples a pixel (default: the scene's, else 256)",
                      [&](const std::string& text) { o.samples = parse_integer(text, 1, most_samples); });
    command.add_value("--time", "T",
                      "as many samples as fit into 90, 90s, 10m or 1h from the program's start, at least 1; "
                      "with --spp, at most that many",
                      [&](const std::string& text) { o.time_s = parse_duration(text); });
    command.add_value("--samples", "A:B",
                      "the samples with these indices, A to B-1; their sums are kept in EXR (--mergeable)",
                      [&](const std::string& text) { o.range = parse_sample_range(text); });
    command.add_flag("--mergeable", o.mergeable, "keep the exact sums in EXR, for `fathom merge`");
    command.add_value("--crop", "X0,Y0,X1,Y1",
                      "render only pixels X0 <= x < X1, Y0 <= y < Y1; the picture keeps its size",
                      [&](const std::string& text) { o.crop = parse_crop(text); });
    command.add_value("--aov", "LIST", "layers of EXR: albedo,normal,depth,position,instance,material,samples,variance",
                      [&](const std::string& text) { take_aovs(o, text); });
    command.add_value("--only-sample", "X,Y,S", "print the radiance of one sample of one pixel, and render nothing",
                      [&](const std::string& text) {
                          const std::vector<std::string> parts = split(text, ',');
                          if (parts.size() != 3) throw UsageError(fmt::format("expected X,Y,S, found '{}'", text));
                          constexpr std::uint64_t most_int = 1u << 30;
                          o.only_sample = {int(parse_integer(parts[0], 0, most_int)),
                                           int(parse_integer(parts[1], 0, most_int)),
                                           parse_integer(parts[2], 0, most_samples - 1)};
                      });
    command.add_flag("-q,--quiet", o.quiet, "print only warnings and errors");
    command.add_value("--progress", "json", "one JSON object a line on stderr: progress, warnings, errors, summary",
                      [&](const std::string& text) { parse_word(text, {"json"}), o.json = true; });
}

/// What the options say together.
void check_options(RenderOptions& o)
{
    if (o.range && (o.samples || o.time_s)) throw UsageError("--samples: leave out --spp and --time");
    if (o.only_sample && !o.picture.outputs.empty()) throw UsageError("--only-sample: writes no picture, leave out -o");
    if (o.picture.outputs.empty() && !o.only_sample) o.picture.outputs.push_back(o.scene.file.stem().string() + ".png");
    const bool exr = writes_exr(o.picture);
    if (!exr && (o.aov_samples || o.aov_variance || !o.aovs.empty()))
        throw UsageError("--aov: layers are kept in EXR only; add -o FILE.exr");
    if (!exr && o.mergeable) throw UsageError("--mergeable: sums are kept in EXR only; add -o FILE.exr");
    if (o.range && exr) o.mergeable = true;
}

/// Aids of the denoiser are rendered too.
void add_aids(RenderSettings& settings)
{
    for (Aov aov : {Aov::albedo, Aov::normal})
        if (std::find(settings.aovs.begin(), settings.aovs.end(), aov) == settings.aovs.end())
            settings.aovs.push_back(aov);
}

RenderSettings settings_for(const RenderOptions& o, const LoadedScene& scene)
{
    RenderSettings settings = settings_of(o.settings, scene.description.hints, o.scene.file.string());
    settings.width = scene.size.width;
    settings.height = scene.size.height;
    settings.crop = o.crop;
    settings.aovs = o.aovs;
    if (o.picture.denoise) add_aids(settings);
    const std::string size = fmt::format("{}x{}", settings.width, settings.height);
    if (o.crop && (o.crop->x1 > settings.width || o.crop->y1 > settings.height))
        throw UsageError(fmt::format("--crop: the picture is {}", size));
    if (o.only_sample && (o.only_sample->x >= settings.width || o.only_sample->y >= settings.height))
        throw UsageError(fmt::format("--only-sample: the picture is {}", size));
    return settings;
}

void check_memory(const RenderSettings& settings, bool mergeable)
{
    // Sums of 72 bytes, twice more while they are made into channels of a file, and 32 for each layer on its way there.
    const double per_pixel = 72.0 * (mergeable ? 3 : 1) + 32.0 * double(1 + settings.aovs.size());
    const double bytes = per_pixel * settings.width * settings.height;
    const double available = double(available_memory_bytes());
    if (bytes > available)
        throw Error("", "",
                    fmt::format("a picture of {}x{} pixels needs {:.1f} GB of memory, {:.1f} GB are there",
                                settings.width, settings.height, bytes / 1e9, available / 1e9));
}

/// The denoised picture, as a layer; its aids go unless they are `wanted`.
void add_denoised(Image& image, const Denoiser& denoiser, const std::vector<Aov>& wanted)
{
    Image::Layer denoised = denoiser.denoise(image);
    std::erase_if(image.layers, [&](const Image::Layer& layer) {
        const auto is_extra = [&](Aov aov, const char* name) {
            return layer.name == name && std::find(wanted.begin(), wanted.end(), aov) == wanted.end();
        };
        return is_extra(Aov::albedo, "albedo") || is_extra(Aov::normal, "normal");
    });
    image.layers.push_back(std::move(denoised));
    image.attributes["fathom.denoiser"] = "Open Image Denoise " + denoiser.version();
}

/// Renders what the options ask for into one film, and tells how far it is.
class Rendering {
public:
    Rendering(const RenderOptions& options, const RenderJob& job, Reporter& reporter)
        : options_(options), job_(job), reporter_(reporter), start_s_(seconds_since_start())
    {
        const RenderSettings& settings = job.settings();
        const Crop crop = settings.crop.value_or(Crop{0, 0, settings.width, settings.height});
        pixels_ = std::uint64_t(crop.x1 - crop.x0) * std::uint64_t(crop.y1 - crop.y0);
    }

    void run(Film& film, std::optional<std::uint64_t> samples)
    {
        const std::uint64_t most = samples.value_or(most_samples);
        if (options_.range)
            render_range(film, *options_.range, options_.range->second - options_.range->first);
        else if (options_.time_s)
            render_for_time(film, *options_.time_s, most);
        else
            render_range(film, {0, most}, most);
        render_s = seconds_since_start() - start_s_;
    }

    double render_s = 0;
    std::uint64_t rays = 0;
    bool cut_short = false;

private:
    /// total  samples a pixel of the whole job
    void render_range(Film& film, SampleRange range, std::uint64_t total)
    {
        Progress last;
        const auto on_pass = [&](const Progress& p, const Film&) {
            last = p;
            report(p, total);
        };
        cut_short = !render(job_, range, film, &interrupted(), on_pass);
        done_ += cut_short ? last.samples_done : pixels_ * (range.second - range.first);
        rays += last.rays;
        report({}, total, !cut_short);
    }

    void report(const Progress& p, std::uint64_t total, bool force = false)
    {
        const double now_s = seconds_since_start();
        const std::uint64_t done = done_ + p.samples_done;
        // With a time limit the samples to come are not known; the time is.
        const double fraction = options_.time_s ? now_s / *options_.time_s : double(done) / double(pixels_ * total);
        reporter_.progress(fraction, now_s - start_s_, {done, options_.time_s ? 0 : pixels_ * total, rays + p.rays},
                           force && !options_.time_s);
    }

    /// Ranges that double, so that their overhead is small, until the next would end too late.
    void render_for_time(Film& film, double time_s, std::uint64_t most)
    {
        std::uint64_t done = 0, next = 1;
        while (true) {
            const double begin_s = seconds_since_start();
            render_range(film, {done, done + next}, most);
            if (cut_short) return;
            done += next;
            const double now_s = seconds_since_start();
            // The rate of the latest range: the first ones are slower, with cold caches.
            const double sample_s = std::max((now_s - begin_s) / double(next), 1e-9);
            const double fit = std::max(0.0, (time_s - now_s) / sample_s);
            next = std::min({done, most - done, std::uint64_t(std::min(fit, 1e15))});
            if (next == 0) return;
        }
    }

    const RenderOptions& options_;
    const RenderJob& job_;
    Reporter& reporter_;
    double start_s_;
    std::uint64_t pixels_ = 0, done_ = 0;
};

std::map<std::string, std::string> attributes(const RenderOptions& o, const RenderSettings& s, const LoadedScene& scene,
                                              const Film& film, const Summary& summary)
{
    return {
        {"fathom.version", FATHOM_VERSION},
        {"fathom.scene", o.scene.file.string()},
        {"fathom.camera", scene.camera},
        {"fathom.seed", fmt::format("{}", s.seed)},
        {"fathom.samples", text_of(film.samples())},
        {"fathom.samples_per_pixel", fmt::format("{}", film.samples_per_pixel())},
        {"fathom.dropped_samples", fmt::format("{}", film.dropped_samples())},
        {"fathom.filter", filter_names[std::size_t(s.filter)]},
        {"fathom.max_depth", s.max_depth < 0 ? "none" : fmt::format("{}", s.max_depth)},
        {"fathom.roulette_depth", fmt::format("{}", s.roulette_depth)},
        {"fathom.light_sampling", s.light_sampling ? "on" : "off"},
        {"fathom.crop", s.crop ? fmt::format("{},{},{},{}", s.crop->x0, s.crop->y0, s.crop->x1, s.crop->y1) : "none"},
        {"fathom.simd", simd_name()},
        {"fathom.rays", fmt::format("{}", summary.rays)},
        {"fathom.load_s", fmt::format("{:.3f}", summary.load_s)},
        {"fathom.build_s", fmt::format("{:.3f}", summary.build_s)},
        {"fathom.render_s", fmt::format("{:.3f}", summary.render_s)}};
}

int run_render(RenderOptions& o, Reporter& reporter)
{
    check_options(o);
    for (const auto& file : o.picture.outputs) check_output(file);

    Summary summary;
    Warnings warnings;
    const ThreadLimit limit = limit_threads(o.settings, reporter);
    const std::optional<Denoiser> denoiser = open_denoiser(o.picture, o.settings.threads, reporter);
    LoadedScene loaded = [&] {
        const Reporter::Phase phase(reporter, "load", "reading " + o.scene.file.string());
        return load_for_render(o.scene, warnings);
    }();
    check_outputs_are_no_inputs(o.picture.outputs, loaded.description);
    RenderSettings settings = settings_for(o, loaded);
    WriteOptions write = write_options(o.picture, loaded.description.hints);
    if (!o.only_sample) check_memory(settings, o.mergeable);
    for (const auto& file : o.picture.outputs) check_output(file, settings.width, settings.height);
    std::optional<std::uint64_t> samples = o.samples;
    if (!samples && !o.time_s) samples = hinted_samples(loaded.description.hints, o.scene.file.string());
    if (!loaded.added.empty())
        reporter.note(fmt::format("the file lacks them, so these were added: {}", fmt::join(loaded.added, ", ")));
    summary.load_s = seconds_since_start();

    const LitScene lit = [&] {
        const Reporter::Phase phase(reporter, "build", "building " + o.scene.file.string());
        return compile_loaded(loaded, o.scene, warnings);
    }();
    use_light(lit, o.picture, settings, write.display, reporter);
    const Scene& scene = lit.scene;
    summary.build_s = seconds_since_start() - summary.load_s;
    reporter.warnings(warnings);
    const RenderJob job(scene, settings);

    if (o.only_sample) {
        const Color c = render_sample(job, o.only_sample->x, o.only_sample->y, o.only_sample->index);
        print(fmt::format("pixel {},{} sample {}: {:.9g} {:.9g} {:.9g}\n", o.only_sample->x, o.only_sample->y,
                          o.only_sample->index, c.r, c.g, c.b));
        return exit_ok;
    }

    if (!samples && !o.time_s && !o.range) {
        samples = default_samples;
        reporter.note(fmt::format("{} samples a pixel, as neither --spp nor --time is given", default_samples));
    }
    if (o.range && !o.mergeable)
        reporter.note(
            "the samples of --samples can't be merged later: their sums are kept in EXR only, add -o FILE.exr");
    if (simd_width() == 1)
        reporter.note("this machine has neither AVX2 nor AVX-512: the kernel runs one lane wide, which is slow");
    finish_on_interrupt(
        reporter.mode() == ReportMode::json
            ? "{\"event\":\"interrupted\"}\n"
            : "\nfathom: interrupted: finishing this pass, then the picture is written; once more stops at once\n");
    Film film(job);
    Rendering rendering(o, job, reporter);
    rendering.run(film, samples);
    summary.render_s = rendering.render_s;
    summary.rays = rendering.rays;
    summary.samples_per_pixel = film.samples_per_pixel();
    if (rendering.cut_short && film.samples().empty()) {
        reporter.error("interrupted before the first pass was done: no picture is written");
        return exit_interrupted;
    }

    const double write_start_s = seconds_since_start();
    Image image = film.image(settings.alpha, o.aov_variance);
    if (o.aov_samples) image.layers.push_back(sample_count_layer(film));
    image.attributes = attributes(o, settings, loaded, film, summary);
    if (denoiser) add_denoised(image, *denoiser, o.aovs);
    if (o.mergeable) store_sums(film.sums(), image);
    const bool all_written = write_pictures(o.picture, image, write, reporter);
    summary.write_s = seconds_since_start() - write_start_s;
    if (film.dropped_samples() > 0) {
        Warnings dropped;
        std::string text = fmt::format("{} samples were no number or infinite; they count as black, which is a bias",
                                       film.dropped_samples());
        if (const auto place = film.dropped_sample())
            text += fmt::format(" (--only-sample {},{},{} replays one)", place->x, place->y, place->sample);
        dropped.add(text);
        reporter.warnings(dropped);
    }
    if (rendering.cut_short)
        reporter.note(fmt::format("interrupted: the picture has {} samples a pixel", film.samples_per_pixel()));
    reporter.summary(summary);
    if (!all_written) return exit_error;
    return rendering.cut_short ? exit_interrupted : exit_ok;
}

}  // namespace

void add_render(CLI::App& program, Run& run)
{
    const auto options = std::make_shared<RenderOptions>();
    Command command(program, "render", "Render a scene or model file to pictures");
    add_scene_options(command, options->scene);
    add_render_options(command, *options);
    add_settings_options(command, options->settings);
    add_picture_options(command, options->picture);
    command.set_footer(
        "An option overrides what the scene file says. Without -o: a PNG named after the scene, in this folder.\n"
        "Ctrl-C once finishes the pass and writes the picture so far (exit code 130); twice stops at once.\n\n"
        "Examples:\n"
        "  fathom render scene.json --spp 1024 -o out.exr -o out.png\n"
        "  fathom render model.glb --time 10m --orbit 45,20 --env sky.hdr\n"
        "  fathom render scene.json --size 1920x1080 --aov albedo,normal,variance -o out.exr\n"
        "  fathom render scene.json --samples 0:64 -o a.exr      one part; fathom merge joins them\n"
        "  fathom render scene.json --only-sample 400,300,7      replay one sample\n\n"
        "Exit codes: 0 done; 1 error; 2 wrong usage; 130 interrupted.");
    command.set_run(run, [options] {
        Reporter reporter(options->json    ? ReportMode::json
                          : options->quiet ? ReportMode::quiet
                                           : default_report_mode());
        if (!options->json) return run_render(*options, reporter);
        try {
            return run_render(*options, reporter);
        } catch (const UsageError&) {
            throw;
        } catch (const std::exception& error) {
            reporter.error(error.what());
            return int(exit_error);
        }
    });
}

}  // namespace fathom::cli
