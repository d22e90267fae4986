#include <fmt/format.h>
#include <memory>

#include "commands/commands.h"
#include "distributed/ranks/ranks.h"
#include "fathom/error.h"
#include "fathom/memory.h"
#include "fathom/scene_parts.h"
#include "options/arguments.h"
#include "options/render_options.h"
#include "options/scene_options.h"
#include "process/interrupt.h"
#include "process/streams.h"
#include "render/film_memory.h"
#include "render/frames.h"
#include "render/overwrite_guard.h"
#include "render/series.h"
#include "render/still.h"
#include "render/turntable.h"
#include "report/reporter.h"

namespace fathom::cli {

namespace {

/// What film and pictures take.
std::vector<MemoryEstimate> film_needs_of(const RenderOptions& o, const RenderSettings& settings)
{
    FilmUse use;
    use.is_kept = !o.checkpoint.empty();
    use.is_mergeable = o.mergeable && writes_exr(o.picture);
    use.extra_channels = (o.aov_variance ? 3 : 0) + (o.aov_samples ? 1 : 0);
    return film_needs(settings, use, o.picture);
}

/// What scene and film take if the tree is built so.
std::vector<MemoryEstimate> needs_of(const RenderOptions& o, const LoadedScene& loaded, const RenderSettings& settings,
                                     TreeBuild level)
{
    std::vector<MemoryEstimate> needs = estimate_memory(loaded.description, level);
    if (!o.only_sample)
        for (MemoryEstimate& need : film_needs_of(o, settings)) needs.push_back(std::move(need));
    return needs;
}

LoadedScene load(const RenderOptions& o, Reporter& reporter, Warnings& warnings)
{
    const Reporter::Phase phase(reporter, "load", "reading " + o.scene.file.string());
    return load_for_render(o.scene, warnings);
}

/// Whether it is worth the time to learn where light comes from. Parts of one picture must agree on it.
bool guiding_pays(const RenderOptions& o, const RenderPlan& plan)
{
    constexpr double min_in_all = 1 << 22, min_a_pixel = 8, min_s = 10;
    if (o.mergeable || o.range || o.part || !o.checkpoint.empty()) return true;
    if (o.time_s) return *o.time_s >= min_s;
    const double samples = double(plan.samples.value_or(default_samples));
    return samples >= min_a_pixel && samples * plan.settings.width * plan.settings.height >= min_in_all;
}

/// The build that has the picture done soonest. A tree of high quality takes some 1.5 us more to build for each
/// triangle, and saves some 5 % of a sample's microsecond (docs/performance.md).
TreeBuild build_for(const SceneDescription& scene, double samples)
{
    constexpr double min_a_triangle = 32;
    // How many triangles displacement makes is not known yet.
    for (const Material& material : scene.materials)
        if (material.displacement.value != 0) return TreeBuild::standard;
    double triangles = 0;
    for (const Mesh& mesh : scene.meshes) triangles += double(mesh.indices.size()) / 3;
    return triangles > 0 && samples >= min_a_triangle * triangles ? TreeBuild::high : TreeBuild::standard;
}

/// Of all pictures of one tree, roughly; what an animation moves is built anew.
double planned_samples(const RenderOptions& o, const RenderPlan& plan)
{
    constexpr double samples_per_s = 1e6;
    if (o.only_sample || (o.frames.size() > 1 && o.turntable == 0)) return 1;
    if (o.time_s) return *o.time_s * samples_per_s;
    double per_pixel = double(plan.samples.value_or(default_samples)) * double(std::max<std::uint64_t>(1, o.turntable));
    if (o.part) per_pixel /= double(o.part->count);
    if (o.range) per_pixel = double(o.range->second - o.range->first);
    const Crop crop = plan.settings.rendered_pixels();
    return per_pixel * double(crop.x1 - crop.x0) * double(crop.y1 - crop.y0);
}

/// As build_for, where there is the memory.
TreeBuild build_that_pays(const RenderOptions& o, const LoadedScene& loaded, const RenderPlan& plan)
{
    const TreeBuild level = build_for(loaded.description, planned_samples(o, plan));
    double bytes = 0;
    for (const MemoryEstimate& need : needs_of(o, loaded, plan.settings, level)) bytes += need.bytes;
    return bytes <= double(available_memory_bytes()) ? level : TreeBuild::standard;
}

/// Whether the picture is to be denoised, which rank 0 decides: it has the denoiser.
bool all_denoise(bool own, Ranks* ranks)
{
    return ranks ? !ranks->agree(own ? "denoised" : "").empty() : own;
}

/// What options and scene say together; told is what was added to the scene.
RenderPlan plan_for(const RenderOptions& o, const LoadedScene& loaded, std::optional<Denoiser> denoiser, Ranks* ranks,
                    Reporter& reporter)
{
    const RenderHints& hints = loaded.description.hints;
    const RenderSettings settings = settings_for(o, loaded, all_denoise(denoiser.has_value(), ranks));
    RenderPlan plan{loaded, settings, write_options(o.picture, hints, reporter), o.samples, {}, {}, std::move(denoiser),
                    ranks};
    // Refused before anything is built for it.
    check_memory(o.scene.file.string(), needs_of(o, loaded, settings, loaded.build.value_or(TreeBuild::standard)));
    check_outputs(o, plan.settings.width, plan.settings.height);
    if (!plan.samples && !o.time_s) plan.samples = hinted_samples(hints, o.scene.file.string());
    if (!o.checkpoint.empty()) plan.scene_parts = scene_parts(loaded.description);
    if (!o.settings.guiding) plan.settings.guiding = guiding_pays(o, plan);
    if (!loaded.added.empty())
        reporter.note(fmt::format("the file lacks them, so these were added: {}", fmt::join(loaded.added, ", ")));
    if (!loaded.note.empty()) reporter.note(loaded.note);
    return plan;
}

/// The scene, compiled and lit; the plan then has what goes with its light.
///
/// edit  kept only where further frames need it
AutoLitScene build(const RenderOptions& o, LoadedScene& loaded, RenderPlan& plan, std::optional<SceneEdit>& edit,
                   Reporter& reporter, Warnings& warnings)
{
    AutoLitScene lit = [&] {
        const Reporter::Phase phase(reporter, "build", "building " + o.scene.file.string());
        return compile_loaded(edit.emplace(take_edit(loaded, o.scene)), loaded, o.scene, plan.settings, warnings);
    }();
    if (o.frames.size() < 2 || o.turntable > 0) edit.reset();
    use_light(lit, o.picture, plan.settings, plan.write.display, reporter);
    return lit;
}

int print_sample(const OnlySample& only, const RenderJob& job)
{
    const Color c = render_sample(job, only.x, only.y, only.index);
    print(fmt::format("pixel {},{} sample {}: {:.9g} {:.9g} {:.9g}\n", only.x, only.y, only.index, c.r, c.g, c.b));
    return exit_ok;
}

/// What should be known before a long render.
void tell_before(const RenderOptions& o, RenderPlan& plan, Reporter& reporter)
{
    if (!plan.samples && !o.time_s && !o.range) {
        plan.samples = default_samples;
        reporter.note(fmt::format("{} samples a pixel, as neither --spp nor --time is given", default_samples));
    }
    if ((o.range || o.part) && !o.mergeable && o.checkpoint.empty())
        reporter.note(
            fmt::format("the samples of {} can't be merged later: their sums are kept in EXR only, add -o FILE.exr",
                        o.part ? "--part" : "--samples"));
    if (plan.settings.clamp_indirect)
        reporter.note(fmt::format("biased: indirect light clamped at {:g}", *plan.settings.clamp_indirect));
    if (simd_width() == 1)
        reporter.note("this machine has neither AVX2 nor AVX-512: the kernel runs one lane wide, which is slow");
}

/// The samples that are wanted in the end.
SampleRange wanted_samples(const RenderOptions& o, const RenderPlan& plan)
{
    if (o.range) return *o.range;
    if (!o.part) return {0, plan.samples.value_or(max_samples)};
    if (o.part->count > *plan.samples)
        throw UsageError(fmt::format("--part: {} samples can't be cut in {} parts", *plan.samples, o.part->count));
    return samples_of_part(*o.part, *plan.samples);
}

/// ranks  those that this process is one of, or nullptr
int render_scene(RenderOptions& o, Ranks* ranks, Reporter& reporter)
{
    const bool leads = !ranks || ranks->leads(), as_json = reporter.mode() == ReportMode::json;
    Summary summary;
    Warnings warnings;
    const ThreadLimit limit = limit_threads(o.settings, reporter);
    std::optional<Denoiser> denoiser;
    if (leads) denoiser = open_denoiser(o.picture, o.settings.threads, reporter);
    LoadedScene loaded = load(o, reporter, warnings);
    check_outputs_are_no_inputs(files_that_are_there(o), loaded.description);
    RenderPlan plan = plan_for(o, loaded, std::move(denoiser), ranks, reporter);
    if (!loaded.build) loaded.build = build_that_pays(o, loaded, plan);
    summary.load_s = seconds_since_start();

    std::optional<SceneEdit> edit;
    AutoLitScene lit = build(o, loaded, plan, edit, reporter, warnings);
    summary.build_s = seconds_since_start() - summary.load_s;
    reporter.warnings(warnings);
    if (o.only_sample) return print_sample(*o.only_sample, RenderJob(lit.scene, plan.settings));
    // Once more: displacement makes as many triangles as it takes.
    check_memory(o.scene.file.string(), film_needs_of(o, plan.settings));

    tell_before(o, plan, reporter);
    plan.range = wanted_samples(o, plan);
    finish_on_interrupt(!leads    ? ""
                        : as_json ? "{\"event\":\"interrupted\"}\n"
                        : ranks   ? "\nfathom: interrupted\n"
                                  : "\nfathom: interrupted: the picture so far is written; once more stops at once\n");
    if (edit) return render_frames(o, plan, *edit, std::move(lit.scene), summary, warnings, reporter);
    if (o.turntable > 0) return render_turntable(o, plan, lit.scene, summary, reporter);
    const PictureOptions files = o.frames.empty() ? o.picture : files_of(o.picture, o.frames[0]);
    return render_picture(o, plan, files, RenderJob(lit.scene, plan.settings), summary, reporter);
}

/// As one of several ranks, which this process was started as.
int render_as_rank(RenderOptions& o, const RankEnvironment& environment, Reporter& reporter)
{
    if (o.only_sample) throw UsageError("--only-sample: is of one process; leave out mpirun");
    Ranks ranks(environment);
    return ranks.run(
        [&] {
            if (o.settings.threads == 0) o.settings.threads = ranks.threads();
            if (ranks.leads()) {
                check_outputs(o);
                reporter.note(ranks.summary());
                if (const std::string advice = ranks.advice(); !advice.empty()) reporter.note(advice);
            } else {
                // Rank 0 writes them, where they must have a folder.
                o.writes_pictures = false;
            }
            return render_scene(o, &ranks, reporter);
        },
        reporter);
}

int run_render(RenderOptions& o, Reporter& reporter)
{
    const RankEnvironment environment = o.uses_mpi ? rank_environment() : RankEnvironment{};
    const bool as_json = reporter.mode() == ReportMode::json;
    end_on_interrupt(environment.rank > 0 ? ""
                     : as_json            ? "{\"event\":\"interrupted\"}\n"
                                          : "\nfathom: interrupted before anything was rendered\n");
    check_options(o);
    if (environment.count > 1) return render_as_rank(o, environment, reporter);
    check_outputs(o);
    return render_scene(o, nullptr, reporter);
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
        "An option overrides what the scene file says. Without -o: a PNG named after the scene, in this folder;\n"
        "with --checkpoint, that alone.\n"
        "Ctrl-C, SIGTERM or SIGHUP once writes the picture (and checkpoint) so far (exit code 130); twice stops at "
        "once.\n"
        "SIGUSR1 writes them and goes on. docs/long-renders.md tells of checkpoints and parts.\n\n"
        "Examples:\n"
        "  fathom render scene.json --spp 1024 -o out.exr -o out.png\n"
        "  fathom render model.glb --time 10m --orbit 45,20 --env sky.hdr\n"
        "  fathom render scene.json --size 1920x1080 --aov albedo,normal,variance -o out.exr\n"
        "  fathom render model.glb --frames 0:119 --fps 24 -o frame.####.png\n"
        "  fathom render model.glb --turntable 36 -o view.##.png\n"
        "  fathom render scene.json --spp 4096 --checkpoint film.exr -o a.png      killed? the same again goes on\n"
        "  fathom render scene.json --spp 1024 --part 3/16 -o part3.exr      fathom merge joins them\n"
        "  mpirun -n 8 fathom render scene.json -o out.exr      by all of them together (docs/clusters.md)\n"
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
