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

namespace fs = std::filesystem;

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
    std::vector<std::uint64_t> frames;  ///< numbers of the pictures; none: one picture
    std::uint64_t turntable = 0;        ///< pictures around the scene; 0: no such
    double fps = 24, shutter = 0;
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
    command.add_value(
        "--frames", "A:B[:STEP]",
        "a picture for each of these frames of the animation, B included, of the time frame / fps; #### in "
        "the names of -o is the frame's number",
        [&](const std::string& text) { o.frames = parse_frames(text); });
    command.add_value("--fps", "N", "frames a second (default 24)",
                      [&](const std::string& text) { o.fps = parse_number(text, 1e-3, 1e6); });
    command.add_value("--shutter", "SHARE",
                      "blur what the animation moves during this share of a frame, 0.5 as film does (default 0: none)",
                      [&](const std::string& text) { o.shutter = parse_number(text, 0, 1000); });
    command.add_value("--turntable", "N",
                      "N pictures from all around, the first as --orbit or --view says, at one distance; ### in the "
                      "names of -o is the number, from 0; the light stays where it is for the first",
                      [&](const std::string& text) { o.turntable = parse_integer(text, 1, 1'000'000); });
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

double time_of(const RenderOptions& o, std::uint64_t frame)
{
    return double(frame) / o.fps;
}

/// The file of a frame: its number stands where #### does, with as many digits at least.
fs::path output_of(const fs::path& pattern, std::uint64_t frame)
{
    std::string name = pattern.filename().string();
    const std::size_t last = name.rfind('#');
    if (last == std::string::npos) return pattern;
    const std::size_t before = name.find_last_not_of('#', last), first = before == std::string::npos ? 0 : before + 1;
    name.replace(first, last + 1 - first, fmt::format("{:0{}}", frame, last + 1 - first));
    return pattern.parent_path() / name;
}

/// What several pictures mean for the other options.
///
/// option  what asks for them
void check_series(RenderOptions& o, const char* option)
{
    if (o.frames.size() == 1) return;
    if (o.time_s) throw UsageError(fmt::format("{}: --spp says how many samples each has; leave out --time", option));
    if (o.only_sample) throw UsageError(fmt::format("--only-sample: of which picture? give {} one", option));
    if (o.picture.outputs.empty()) o.picture.outputs.push_back(o.scene.file.stem().string() + ".####.png");
    for (const fs::path& file : o.picture.outputs)
        if (file.filename().string().find('#') == std::string::npos)
            throw UsageError(
                fmt::format("-o {}: {} pictures need names of their own: put #### where the number is to stand",
                            file.string(), o.frames.size()));
}

/// What --turntable says with the others.
void check_turntable(RenderOptions& o)
{
    if (!o.frames.empty()) throw UsageError("--turntable, --frames: one of both says which pictures");
    for (std::uint64_t i = 0; i < o.turntable; ++i) o.frames.push_back(i);
    o.scene.turntable = true;
    check_series(o, "--turntable");
}

/// What --frames says with the others.
void check_frames(RenderOptions& o)
{
    o.scene.shutter_s = o.shutter / o.fps;
    if (o.shutter > 0 && o.frames.empty() && !o.scene.at_s)
        throw UsageError("--shutter: from which time on? add --at SECONDS, or --frames A:B");
    if (o.turntable > 0) return check_turntable(o);
    if (o.frames.empty()) return;
    if (o.scene.at_s) throw UsageError("--at, --frames: one of both says the time");
    o.scene.at_s = time_of(o, o.frames[0]);
    check_series(o, "--frames");
}

/// What the options say together.
void check_options(RenderOptions& o)
{
    check_frames(o);
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

/// What is the same for all pictures of a run.
struct RenderPlan {
    const LoadedScene& scene;
    RenderSettings settings;
    WriteOptions write;
    std::optional<std::uint64_t> samples;
    std::optional<Denoiser> denoiser;
};

/// Renders a picture and writes it; returns the exit code.
int render_picture(const RenderOptions& o, const RenderPlan& plan, const PictureOptions& files, const RenderJob& job,
                   Summary summary, Reporter& reporter)
{
    Film film(job);
    Rendering rendering(o, job, reporter);
    rendering.run(film, plan.samples);
    summary.render_s = rendering.render_s;
    summary.rays = rendering.rays;
    summary.samples_per_pixel = film.samples_per_pixel();
    if (rendering.cut_short && film.samples().empty()) {
        reporter.error("interrupted before the first pass was done: no picture is written");
        return exit_interrupted;
    }

    const double write_start_s = seconds_since_start();
    Image image = film.image(plan.settings.alpha, o.aov_variance);
    if (o.aov_samples) image.layers.push_back(sample_count_layer(film));
    image.attributes = attributes(o, plan.settings, plan.scene, film, summary);
    if (plan.denoiser) add_denoised(image, *plan.denoiser, o.aovs);
    if (o.mergeable) store_sums(film.sums(), image);
    const bool all_written = write_pictures(files, image, plan.write, reporter);
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

PictureOptions files_of(PictureOptions options, std::uint64_t frame)
{
    for (fs::path& file : options.outputs) file = output_of(file, frame);
    return options;
}

/// The pictures of all frames, the scene being at the first; returns the exit code.
///
/// told  what was warned of; the frames after the first only tell what is new
int render_frames(const RenderOptions& o, const RenderPlan& plan, SceneEdit& edit, Scene scene, const Summary& summary,
                  const Warnings& told, Reporter& reporter)
{
    Warnings warnings = told;
    for (const std::uint64_t frame : o.frames) {
        Summary now = summary;
        if (frame != o.frames[0]) {
            const double start_s = seconds_since_start();
            // What still has a scene keeps it from being changed.
            scene = {};
            set_time(edit, plan.scene, o.scene, time_of(o, frame));
            Warnings found, fresh;
            scene = edit.compile_exactly(found);
            for (const auto& [message, times] : found.counts())
                if (!warnings.counts().contains(message)) fresh.add(message, times);
            for (const auto& [message, times] : fresh.counts()) warnings.add(message, times);
            reporter.warnings(fresh);
            now.load_s = 0;
            now.build_s = seconds_since_start() - start_s;
        }
        const int code =
            render_picture(o, plan, files_of(o.picture, frame), RenderJob(scene, plan.settings), now, reporter);
        if (code != exit_ok) return code;
    }
    return exit_ok;
}

/// The pictures around a scene, which stays as it is; returns the exit code.
int render_turntable(const RenderOptions& o, const RenderPlan& plan, const Scene& scene, const Summary& summary,
                     Reporter& reporter)
{
    for (const std::uint64_t i : o.frames) {
        const Camera camera = turned_camera(scene.camera(), plan.scene, double(i) / double(o.turntable));
        const int code = render_picture(o, plan, files_of(o.picture, i), RenderJob(scene, camera, plan.settings),
                                        i == 0 ? summary : Summary{}, reporter);
        if (code != exit_ok) return code;
    }
    return exit_ok;
}

/// Those that will be written over, of all frames.
std::vector<fs::path> files_that_are_there(const RenderOptions& o)
{
    std::vector<fs::path> files;
    const auto add = [&](const fs::path& file) {
        std::error_code error;
        if (fs::exists(file, error)) files.push_back(file);
    };
    for (const fs::path& pattern : o.picture.outputs) {
        if (o.frames.empty()) add(pattern);
        for (const std::uint64_t frame : o.frames) add(output_of(pattern, frame));
    }
    return files;
}

/// Looks before a long render whether its files can be written.
void check_outputs(const RenderOptions& o, int width = 0, int height = 0)
{
    for (const fs::path& file : o.picture.outputs)
        check_output(o.frames.empty() ? file : output_of(file, o.frames[0]), width, height);
}

int run_render(RenderOptions& o, Reporter& reporter)
{
    check_options(o);
    check_outputs(o);

    Summary summary;
    Warnings warnings;
    const ThreadLimit limit = limit_threads(o.settings, reporter);
    std::optional<Denoiser> denoiser = open_denoiser(o.picture, o.settings.threads, reporter);
    LoadedScene loaded = [&] {
        const Reporter::Phase phase(reporter, "load", "reading " + o.scene.file.string());
        return load_for_render(o.scene, warnings);
    }();
    check_outputs_are_no_inputs(files_that_are_there(o), loaded.description);
    RenderPlan plan{loaded, settings_for(o, loaded), write_options(o.picture, loaded.description.hints), o.samples,
                    std::move(denoiser)};
    if (!o.only_sample) check_memory(plan.settings, o.mergeable);
    check_outputs(o, plan.settings.width, plan.settings.height);
    if (!plan.samples && !o.time_s) plan.samples = hinted_samples(loaded.description.hints, o.scene.file.string());
    if (!loaded.added.empty())
        reporter.note(fmt::format("the file lacks them, so these were added: {}", fmt::join(loaded.added, ", ")));
    if (!loaded.note.empty()) reporter.note(loaded.note);
    summary.load_s = seconds_since_start();

    std::optional<SceneEdit> edit;
    LitScene lit = [&] {
        const Reporter::Phase phase(reporter, "build", "building " + o.scene.file.string());
        return compile_loaded(edit.emplace(take_edit(loaded, o.scene)), loaded, o.scene, plan.settings, warnings);
    }();
    // The description is needed for further frames alone.
    if (o.frames.size() < 2 || o.turntable > 0) edit.reset();
    use_light(lit, o.picture, plan.settings, plan.write.display, reporter);
    summary.build_s = seconds_since_start() - summary.load_s;
    reporter.warnings(warnings);

    if (o.only_sample) {
        const RenderJob job(lit.scene, plan.settings);
        const Color c = render_sample(job, o.only_sample->x, o.only_sample->y, o.only_sample->index);
        print(fmt::format("pixel {},{} sample {}: {:.9g} {:.9g} {:.9g}\n", o.only_sample->x, o.only_sample->y,
                          o.only_sample->index, c.r, c.g, c.b));
        return exit_ok;
    }

    if (!plan.samples && !o.time_s && !o.range) {
        plan.samples = default_samples;
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
    if (edit) return render_frames(o, plan, *edit, std::move(lit.scene), summary, warnings, reporter);
    if (o.turntable > 0) return render_turntable(o, plan, lit.scene, summary, reporter);
    const PictureOptions files = o.frames.empty() ? o.picture : files_of(o.picture, o.frames[0]);
    return render_picture(o, plan, files, RenderJob(lit.scene, plan.settings), summary, reporter);
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
        "  fathom render model.glb --frames 0:119 --fps 24 -o frame.####.png\n"
        "  fathom render model.glb --turntable 36 -o view.##.png\n"
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
