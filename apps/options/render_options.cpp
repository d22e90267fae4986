#include "options/render_options.h"

#include <fmt/format.h>
#include <algorithm>

#include "render/frames.h"
#include "render/turntable.h"

namespace fathom::cli {

namespace {

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

void check_checkpoint(const RenderOptions& o)
{
    if (o.checkpoint.empty()) {
        if (o.every_s) throw UsageError("--every: says how often --checkpoint is written; add --checkpoint FILE.exr");
        return;
    }
    if (o.frames.size() > 1) throw UsageError("--checkpoint: is of one picture; leave out --frames and --turntable");
    if (o.only_sample) throw UsageError("--checkpoint: leave it out with --only-sample");
    if (o.checkpoint.extension() != ".exr") throw UsageError("--checkpoint: a film file is an EXR, name it FILE.exr");
    for (const std::filesystem::path& output : o.picture.outputs)
        if (std::filesystem::weakly_canonical(output) == std::filesystem::weakly_canonical(o.checkpoint))
            throw UsageError("--checkpoint: -o has the same name; pictures and the checkpoint need their own");
}

}  // namespace

void add_sample_options(Command& command, RenderOptions& o)
{
    command.add_value("--spp", "N", "samples a pixel (default: the scene's, else 256)",
                      [&](const std::string& text) { o.samples = parse_integer(text, 1, max_samples); });
}

void add_pixel_options(Command& command, RenderOptions& o)
{
    command.add_value("--crop", "X0,Y0,X1,Y1",
                      "render only pixels X0 <= x < X1, Y0 <= y < Y1; the picture keeps its size",
                      [&](const std::string& text) { o.crop = parse_crop(text); });
    command.add_value("--aov", "LIST", "layers of EXR: albedo,normal,depth,position,instance,material,samples,variance",
                      [&](const std::string& text) { take_aovs(o, text); });
}

void add_every_option(Command& command, RenderOptions& o)
{
    command.add_value("--every", "T", "how often --checkpoint is written: 60, 60s, 10m or 1h (default 60s)",
                      [&](const std::string& text) { o.every_s = parse_duration(text); });
}

void add_render_options(Command& command, RenderOptions& o)
{
    add_sample_options(command, o);
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
    command.add_value(
        "--part", "K/N",
        "part K of N of the samples that --spp says, to be merged with the others; EXR keeps the sums; K+1/N if K "
        "counts from 0, as schedulers do",
        [&](const std::string& text) { o.part = parse_part(text); });
    command.add_value("--checkpoint", "FILE.exr",
                      "keep the samples so far in this film file while rendering, and go on from those that are there",
                      [&](const std::string& text) { o.checkpoint = text; });
    add_every_option(command, o);
    command.add_flag("--mergeable", o.mergeable, "keep the exact sums in EXR, for `fathom merge`");
    add_pixel_options(command, o);
    command.add_value("--only-sample", "X,Y,S", "print the radiance of one sample of one pixel, and render nothing",
                      [&](const std::string& text) {
                          const std::vector<std::string> parts = split(text, ',');
                          if (parts.size() != 3) throw UsageError(fmt::format("expected X,Y,S, found '{}'", text));
                          constexpr std::uint64_t max_int = 1u << 30;
                          o.only_sample = {int(parse_integer(parts[0], 0, max_int)),
                                           int(parse_integer(parts[1], 0, max_int)),
                                           parse_integer(parts[2], 0, max_samples - 1)};
                      });
    command.add_value("--mpi", "auto|off",
                      "off: started by mpirun, each process renders for itself (default auto: they render one picture)",
                      [&](const std::string& text) { o.uses_mpi = parse_word(text, {"off", "auto"}) == 1; });
    command.add_flag("-q,--quiet", o.quiet, "print only warnings and errors");
    command.add_flag("--stats", o.stats,
                     "tell where the time went: rays by kind, light samples, lanes in use, nanoseconds a path's "
                     "vertex by stage");
    command.add_value("--progress", "json", "one JSON object a line on stderr: progress, warnings, errors, summary",
                      [&](const std::string& text) { parse_word(text, {"json"}), o.json = true; });
}

void check_options(RenderOptions& o)
{
    check_frames(o);
    if (o.turntable > 0) check_turntable(o);
    if (o.range && (o.samples || o.time_s)) throw UsageError("--samples: leave out --spp and --time");
    if (o.part && (o.range || o.time_s)) throw UsageError("--part: --spp says of what; leave out --samples and --time");
    if (o.only_sample && !o.picture.outputs.empty()) throw UsageError("--only-sample: writes no picture, leave out -o");
    // A checkpoint shows the picture, too.
    if (o.picture.outputs.empty() && !o.only_sample && o.checkpoint.empty())
        o.picture.outputs.push_back(o.scene.file.stem().string() + ".png");
    const bool exr = writes_exr(o.picture) || !o.checkpoint.empty();
    if (!exr && (o.aov_samples || o.aov_variance || !o.aovs.empty()))
        throw UsageError("--aov: layers are kept in EXR only; add -o FILE.exr");
    if (!exr && o.mergeable) throw UsageError("--mergeable: sums are kept in EXR only; add -o FILE.exr");
    if ((o.range || o.part) && exr) o.mergeable = true;
    check_checkpoint(o);
}

namespace {

/// Aids of the denoiser are rendered too.
void add_aids(RenderSettings& settings)
{
    for (Aov aov : {Aov::albedo, Aov::normal})
        if (std::find(settings.aovs.begin(), settings.aovs.end(), aov) == settings.aovs.end())
            settings.aovs.push_back(aov);
}

}  // namespace

RenderSettings settings_for(const RenderOptions& o, const LoadedScene& scene, bool denoised)
{
    RenderSettings settings = settings_of(o.settings, scene.description.hints, o.scene.file.string());
    settings.width = scene.size.width;
    settings.height = scene.size.height;
    settings.crop = o.crop;
    settings.aovs = o.aovs;
    settings.measure = o.stats;
    if (denoised) add_aids(settings);
    const std::string size = fmt::format("{}x{}", settings.width, settings.height);
    if (o.crop && (o.crop->x1 > settings.width || o.crop->y1 > settings.height))
        throw UsageError(fmt::format("--crop: the picture is {}", size));
    if (o.only_sample && (o.only_sample->x >= settings.width || o.only_sample->y >= settings.height))
        throw UsageError(fmt::format("--only-sample: the picture is {}", size));
    return settings;
}

}  // namespace fathom::cli
