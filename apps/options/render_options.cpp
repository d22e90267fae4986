// SPDX-License-Identifier: Apache-2.0
#include "options/render_options.h"

#include <fmt/format.h>
#include <algorithm>

#include "dataset/dataset.h"
#include "options/arguments.h"
#include "render/frames.h"
#include "render/reference.h"
#include "render/turntable.h"
#include "render/watch.h"

namespace fathom::cli {

namespace fs = std::filesystem;

namespace {

void parse_aovs(FilmOptions& o, const std::string& text)
{
    static const std::vector<std::string> names = {"albedo",   "normal",  "depth",    "position", "instance",
                                                   "material", "samples", "variance", "error"};
    constexpr int samples = 6, variance = 7, error = 8;
    for (const std::string& name : split(text, ',')) {
        const int index = parse_choice(name, names);
        if (index == samples)
            o.aov_samples = true;
        else if (index == variance)
            o.aov_variance = true;
        else if (index == error)
            o.aov_error = true;
        else if (std::find(o.aovs.begin(), o.aovs.end(), Aov(index)) == o.aovs.end())
            o.aovs.push_back(Aov(index));
    }
}

OnlySample parse_only_sample(const std::string& text)
{
    const std::vector<std::string> parts = split(text, ',');
    if (parts.size() != 3) throw UsageError(fmt::format("expected X,Y,S, found '{}'", text));
    constexpr std::uint64_t max_int = 1u << 30;
    return {int(parse_integer(parts[0], 0, max_int)), int(parse_integer(parts[1], 0, max_int)),
            parse_integer(parts[2], 0, max_samples - 1)};
}

void parse_error_goal(ErrorOptions& o, const std::string& text)
{
    o.is_estimated = text != "off";
    o.goal.reset();
    if (!o.is_estimated) return;
    const bool is_percentage = text.ends_with('%');
    const std::string number = is_percentage ? text.substr(0, text.size() - 1) : text;
    o.goal = is_percentage ? parse_number(number, 1e-4, 1e6) / 100 : parse_number(number, 1e-6, 1e4);
}

void add_sample_options(Command& command, SampleOptions& o)
{
    add_spp_option(command, o, "samples per pixel", default_render_samples);
    command.add_value({"--time", "T",
                       "render as many samples as fit into 90, 90s, 10m or 1h since the program's start, at least 1; "
                       "with --spp, at most that many",
                       ""},
                      [&](const std::string& text) { o.time_s = parse_duration(text); });
    command.add_value({"--error", "E|off",
                       "stop once the error of the image, such as 2% or 0.02, is below E with 95 % confidence; with "
                       "--spp and --time, whichever comes first (exit code 3 if E was not reached). off: do not "
                       "estimate the error, which costs 5 to 10 % of the time",
                       "estimate it only"},
                      [&](const std::string& text) { parse_error_goal(o.error, text); });
    command.add_value({"--error-metric", "relative|absolute|worst-block",
                       "error that is estimated; relative: root of the mean of (x - r)^2 / (r^2 + 0.01), where r is "
                       "the image without noise; absolute: of (x - r)^2, in linear radiance; worst-block: the "
                       "relative error of the block of 32x32 pixels that has most",
                       "relative"},
                      [&](const std::string& text) {
                          o.error.metric = ErrorMetric(parse_choice(text, {"relative", "absolute", "worst-block"}));
                      });
    command.add_value({"--samples", "A:B",
                       "render only the samples with indices A to B-1, to be merged later; EXR keeps their sums", ""},
                      [&](const std::string& text) { o.range = parse_sample_range(text); });
    command.add_value({"--part", "K/N",
                       "render part K of N of the --spp samples, to be merged later; EXR keeps the sums. K+1/N if K "
                       "counts from 0, as in many schedulers",
                       ""},
                      [&](const std::string& text) { o.part = parse_part(text); });
}

void add_checkpoint_options(Command& command, CheckpointOptions& o)
{
    command.begin_group("Checkpoints");
    command.add_value({"--checkpoint", "FILE.exr",
                       "keep the samples so far in this film file; the same command again continues from them", ""},
                      [&](const std::string& text) { o.file = text; });
    add_every_option(command, o);
}

void add_series_options(Command& command, SeriesOptions& o)
{
    command.begin_group("Animation");
    command.add_value({"--frames", "A:B[:STEP]",
                       "render an image for each of these frames, B included, at the time frame / fps; #### in the "
                       "names of -o becomes the frame number",
                       ""},
                      [&](const std::string& text) { o.frames = parse_frames(text); });
    command.add_value({"--fps", "N", "frames per second", "24"},
                      [&](const std::string& text) { o.fps = parse_number(text, 1e-3, 1e6); });
    command.add_value({"--shutter", "SHARE",
                       "motion blur: fraction of a frame's time during which the shutter is open; 0.5 in film", "0"},
                      [&](const std::string& text) { o.shutter = parse_number(text, 0, 1000); });
    command.add_value({"--turntable", "N",
                       "render N images around the scene, at one distance, starting from --orbit or --view; the light "
                       "stays where it is; ### in the names of -o becomes the image number, from 0",
                       ""},
                      [&](const std::string& text) { o.turntable = parse_integer(text, 1, 1'000'000); });
}

void add_reference_options(Command& command, ReferenceOptions& o)
{
    command.begin_group("Comparison");
    command.add_value({"--reference", "FILE",
                       "compare the image with this one, as `fathom diff` does; exit code 4 if a pixel differs by more "
                       "than --tolerance",
                       ""},
                      [&](const std::string& text) { o.file = text; });
    command.add_value({"--tolerance", "X",
                       "largest difference of a channel from --reference that counts as none: in radiance for EXR, of "
                       "1 for PNG and others",
                       "0, since renders of one version have the same bits everywhere"},
                      [&](const std::string& text) { o.tolerance = parse_number(text, 0, 1e30); });
}

void add_report_options(Command& command, RenderOptions& o)
{
    command.begin_group("Reporting and debugging");
    command.add_flag({"-q,--quiet", "", "print only warnings and errors", ""}, o.quiet);
    command.add_flag({"--stats", "",
                      "report where the time went: rays by kind, light samples, lanes in use, nanoseconds per path "
                      "vertex by stage",
                      ""},
                     o.stats);
    command.add_value(
        {"--progress", "json", "print progress, warnings, errors and summary to stderr, one JSON object per line", ""},
        [&](const std::string& text) { parse_choice(text, {"json"}), o.json = true; });
    command.add_value(
        {"--only-sample", "X,Y,S", "print the radiance of sample S of pixel X,Y, and render nothing else", ""},
        [&](const std::string& text) { o.only_sample = parse_only_sample(text); });
}

void check_checkpoint(const RenderOptions& o)
{
    const CheckpointOptions& checkpoint = o.checkpoint;
    if (checkpoint.file.empty()) {
        if (checkpoint.every_s)
            throw UsageError("--every: sets how often --checkpoint is written; add --checkpoint FILE.exr");
        return;
    }
    if (o.series.frames.size() > 1)
        throw UsageError("--checkpoint: works for one image; leave out --frames and --turntable");
    if (o.only_sample) throw UsageError("--checkpoint: leave it out with --only-sample");
    if (checkpoint.file.extension() != ".exr")
        throw UsageError("--checkpoint: a film file is an EXR, name it FILE.exr");
    for (const std::filesystem::path& output : o.images.outputs)
        if (std::filesystem::weakly_canonical(output) == std::filesystem::weakly_canonical(checkpoint.file))
            throw UsageError("--checkpoint: -o has the same name; the image and the checkpoint need different files");
}

/// The name of an output with {name} replaced by the scene's name, and {frame} and {view} by the digits ####.
fs::path named_output(const fs::path& output, const RenderOptions& o)
{
    std::string text = output.string();
    const auto replace = [&](const std::string& word, const std::string& by) {
        for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += by.size())
            text.replace(at, word.size(), by);
    };
    replace("{name}", o.scene.file.stem().string());
    if (!o.series.frames.empty()) replace("{frame}", "####");
    if (o.series.turntable > 0 || o.dataset.has_views()) replace("{view}", "####");
    return text;
}

}  // namespace

void add_film_options(Command& command, FilmOptions& o)
{
    command.begin_group("Output");
    command.add_value({"--crop", "X0,Y0,X1,Y1",
                       "render only pixels X0 <= x < X1, Y0 <= y < Y1; the image keeps its size", "all pixels"},
                      [&](const std::string& text) { o.crop = parse_crop(text); });
    command.add_value({"--aov", "LIST",
                       "further layers of EXR, separated by commas: albedo, normal, depth, position, instance, "
                       "material, samples, variance, error",
                       "none"},
                      [&](const std::string& text) { parse_aovs(o, text); });
}

void add_every_option(Command& command, CheckpointOptions& o)
{
    command.begin_group("Checkpoints");
    command.add_value({"--every", "T", "time between checkpoints, such as 60, 60s, 10m or 1h", "60s"},
                      [&](const std::string& text) { o.every_s = parse_duration(text); });
}

void add_render_options(Command& command, RenderOptions& o)
{
    add_sample_options(command, o.samples);
    add_series_options(command, o.series);
    add_dataset_options(command, o.dataset);
    add_checkpoint_options(command, o.checkpoint);
    add_film_options(command, o.film);
    add_output_format(command, o.images);
    command.add_flag({"--mergeable", "", "keep the exact sums in EXR, for `fathom merge`", ""}, o.film.mergeable);
    command.add_flag(
        {"--watch", "", "render again whenever the scene or a file that it uses changes, until Ctrl-C", ""}, o.watches);
    add_reference_options(command, o.reference);
    command.begin_group("Machine");
    command.add_value({"--mpi", "auto|off",
                       "under mpirun, auto: all processes render one image; off: each process renders its own", "auto"},
                      [&](const std::string& text) { o.uses_mpi = parse_choice(text, {"off", "auto"}) == 1; });
    add_report_options(command, o);
}

void add_other_render_options(Command& command, RenderOptions& o)
{
    add_render_options(command, o);
    add_settings_options(command, o.settings);
    add_image_options(command, o.images, "SCENE.png in the current folder; with --checkpoint, no other file");
}

void add_all_render_options(Command& command, RenderOptions& o)
{
    add_scene_options(command, o.scene);
    add_other_render_options(command, o);
}

void check_options(RenderOptions& o)
{
    for (fs::path& output : o.images.outputs) output = named_output(output, o);
    if (o.watches) check_watch(o);
    check_frames(o);
    if (o.series.turntable > 0) check_turntable(o);
    check_dataset(o);
    check_samples(o.samples);
    if (o.film.aov_error && !o.samples.error.is_estimated)
        throw UsageError("--aov: the layer error is an estimate; leave out --error off");
    if (o.only_sample && !o.images.outputs.empty()) throw UsageError("--only-sample: writes no image, leave out -o");
    // A checkpoint contains the image, so that no other file is needed.
    if (o.images.outputs.empty() && !o.only_sample && o.checkpoint.file.empty())
        o.images.outputs.push_back(o.scene.file.stem().string() + ".png");
    const bool is_dataset = o.dataset.format != DatasetFormat::none;
    const bool has_exr = writes_exr(o.images) || !o.checkpoint.file.empty() || is_dataset;
    if (!has_exr && (o.film.aov_samples || o.film.aov_variance || o.film.aov_error || !o.film.aovs.empty()))
        throw UsageError("--aov: only EXR has layers; add -o FILE.exr");
    if (!is_dataset && !writes_exr(o.images) && !o.dataset.layers.empty())
        throw UsageError("--ground-truth: only EXR has layers; add -o FILE.exr");
    if (!has_exr && o.film.mergeable) throw UsageError("--mergeable: only EXR keeps sums; add -o FILE.exr");
    if ((o.samples.range || o.samples.part) && has_exr && !is_dataset) o.film.mergeable = true;
    check_checkpoint(o);
    check_reference(o);
}

}  // namespace fathom::cli
