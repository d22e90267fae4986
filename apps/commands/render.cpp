// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "commands/commands.h"
#include "dataset/dataset.h"
#include "dataset/views.h"
#include "distributed/ranks/ranks.h"
#include "options/render_options.h"
#include "process/interrupt.h"
#include "process/streams.h"
#include "render/frames.h"
#include "render/overwrite_guard.h"
#include "render/render_plan.h"
#include "render/series.h"
#include "render/still.h"
#include "render/turntable.h"
#include "render/watch.h"
#include "report/reporter.h"

namespace fathom::cli {

namespace {

constexpr CommandText render_text{
    "render", "Render a scene or model file to images",
    "An option overrides what the scene file says.\n"
    "Ctrl-C, SIGTERM or SIGHUP once writes the image and checkpoint so far (exit code 130); twice stops at once.\n"
    "SIGUSR1 writes them and continues. docs/long-renders.md explains checkpoints and parts.\n\n"
    "Examples:\n"
    "  fathom render scene.json --spp 1024 -o out.exr -o out.png\n"
    "  fathom render model.glb --time 10m --orbit 45,20 --env sky.hdr\n"
    "  fathom render model.glb --error 2% --time 1h      stop at an error of 2 %, or after an hour\n"
    "  fathom render scene.json --size 1920x1080 --aov albedo,normal,variance -o out.exr\n"
    "  fathom render model.glb --frames 0:119 --fps 24 -o frame.####.png\n"
    "  fathom render model.glb --turntable 36 -o view.##.png\n"
    "  fathom render model.glb --views 100 --dataset nerf --size 512x512 -o lego/      a data set\n"
    "  fathom render model.glb -o images/{name}.png      {name}: that of the scene; {frame}, {view}: like ####\n"
    "  curl URL | fathom render - --format glb -o - --output-format png >model.png\n"
    "  fathom render scene.json --spp 4096 --checkpoint film.exr -o a.png      run again to continue\n"
    "  fathom render scene.json --spp 1024 --part 3/16 -o part3.exr      fathom merge joins the parts\n"
    "  fathom render scene.json -o new.png --reference old.png      4 as exit code if a pixel differs\n"
    "  mpirun -n 8 fathom render scene.json -o out.exr      one image by 8 processes (docs/clusters.md)\n"
    "  fathom render scene.json --only-sample 400,300,7      replay one sample\n\n"
    "Exit codes: 0 success; 1 error; 2 wrong usage; 3 the image is written, but --error was not reached; 4 it "
    "differs from\n--reference; 130 interrupted."};

/// Compiles the scene with its light, whose backdrop and exposure go into the plan.
///
/// edit  is kept only if further frames need it
LitScene build(const RenderOptions& o, LoadedScene& loaded, RenderPlan& plan, std::optional<EditableScene>& edit,
               Reporter& reporter, Warnings& warnings)
{
    LitScene lit = [&] {
        const Reporter::Phase phase(reporter, "build", "building " + o.scene.file.string());
        return compile_with_light(edit.emplace(make_edit(loaded, o.scene)), loaded, o.scene, plan.settings, warnings);
    }();
    if (!o.dataset.layers.empty()) plan.objects = scene_objects(edit->description());
    if (o.series.frames.size() < 2 || o.series.turntable > 0 || o.dataset.has_views()) edit.reset();
    apply_light(lit, o.images, plan.settings, plan.write.display, reporter);
    decide_on_caustics(lit, {o.scene.file.string(), o.settings.caustics, light_trial_effort(plan, lit)}, plan.settings,
                       warnings, reporter);
    return lit;
}

int print_sample(const OnlySample& only, const RenderJob& job)
{
    const Color c = render_sample(job, only.x, only.y, only.index);
    write_stdout(
        fmt::format("pixel {},{} sample {}: {:.9g} {:.9g} {:.9g}\n", only.x, only.y, only.index, c.r, c.g, c.b));
    return exit_ok;
}

/// Text that the first interrupt prints while rendering.
const char* interrupt_line(const Ranks* ranks, ReportMode mode)
{
    if (ranks && !ranks->leads()) return "";
    if (mode == ReportMode::json) return "{\"event\":\"interrupted\"}\n";
    return ranks ? "\nfathom: interrupted\n"
                 : "\nfathom: interrupted: writing the image so far; a second interrupt stops at once\n";
}

/// ranks  the ranks that this process is one of, or nullptr
/// watch  learns the files of the scene; or nullptr
int render_scene(RenderOptions& o, Ranks* ranks, SceneWatch* watch, Reporter& reporter)
{
    const double start_s = watch ? seconds_since_start() : 0;
    Summary summary;
    Warnings warnings;
    const ThreadLimit limit = limit_threads(o.settings, reporter);
    std::optional<Denoiser> denoiser;
    if (!ranks || ranks->leads()) denoiser = open_denoiser(o.images, o.settings.threads, reporter);
    if (watch) watch->begin_reading();
    LoadedScene loaded = load_for_render(o.scene, reporter, warnings);
    if (watch) watch->set_files(loaded.description);
    check_outputs_are_no_inputs(existing_outputs(o), loaded.description);
    RenderPlan plan = make_plan(o, loaded, std::move(denoiser), ranks, reporter);
    if (!loaded.build) loaded.build = choose_tree_build(o, plan);
    summary.load_s = seconds_since_start() - start_s;

    const std::vector<Camera> cameras = o.dataset.has_views() ? view_cameras(o, loaded) : std::vector<Camera>();
    std::optional<EditableScene> edit;
    LitScene lit = build(o, loaded, plan, edit, reporter, warnings);
    summary.build_s = seconds_since_start() - start_s - summary.load_s;
    reporter.warnings(warnings);
    if (o.only_sample) return print_sample(*o.only_sample, RenderJob(lit.scene, plan.settings));
    // The check before compiling can't know how many triangles displacement adds.
    check_film_memory(plan);

    announce_plan(plan, reporter);
    finish_on_interrupt(interrupt_line(ranks, reporter.mode()));
    if (edit) return render_frames(plan, o.series, *edit, std::move(lit), summary, warnings, reporter);
    if (o.series.turntable > 0) return render_turntable(plan, o.series, lit.scene, summary, reporter);
    if (!cameras.empty()) return render_images(plan, lit.scene, cameras, summary, reporter);
    const ImageOptions files = o.series.frames.empty() ? o.images : frame_files(o.images, o.series.frames[0]);
    return render_image(plan, files, RenderJob(lit.scene, plan.settings), summary, reporter);
}

/// Renders as one of the ranks that a launcher has started.
int render_as_rank(RenderOptions& o, const RankEnvironment& environment, Reporter& reporter)
{
    if (o.samples.error.goal) throw UsageError("--error: runs as one process; under mpirun, choose --spp or --time");
    if (o.only_sample) throw UsageError("--only-sample: runs as one process; leave out mpirun");
    if (!o.reference.file.empty())
        throw UsageError("--reference: runs as one process; under mpirun, compare with `fathom diff` afterwards");
    if (o.watches) throw UsageError("--watch: runs as one process; leave out mpirun");
    Ranks ranks(environment);
    return ranks.run(
        [&] {
            if (o.settings.threads == 0) o.settings.threads = ranks.threads();
            if (ranks.leads()) {
                check_outputs(o);
                reporter.note(ranks.summary());
                if (const std::string advice = ranks.advice(); !advice.empty()) reporter.note(advice);
            } else {
                // Only rank 0 writes images, so their folders need not exist elsewhere.
                o.writes_images = false;
            }
            return render_scene(o, &ranks, nullptr, reporter);
        },
        reporter);
}

/// Renders whenever a file of the scene changes, until an interrupt. A scene that can't be read or rendered may be half
/// saved: its error is printed, and the next change is awaited.
int render_and_watch(const RenderOptions& options, Reporter& reporter)
{
    SceneWatch watch(options.scene.file);
    for (;;) {
        RenderOptions o = options;
        try {
            if (render_scene(o, nullptr, &watch, reporter) == exit_interrupted) return exit_interrupted;
        } catch (const Error& error) {
            reporter.error(error.what());
        }
        end_on_interrupt("");
        // An interrupt that came once the samples were complete has only been noted.
        if (interrupted()) return exit_interrupted;
        reporter.note(fmt::format("watching {} file{}", watch.file_count(), watch.file_count() == 1 ? "" : "s"));
        watch.wait_for_change();
    }
}

int run_render(RenderOptions& o, Reporter& reporter)
{
    const RankEnvironment environment = o.uses_mpi ? rank_environment() : RankEnvironment{};
    const bool as_json = reporter.mode() == ReportMode::json;
    end_on_interrupt(environment.rank > 0 ? ""
                     : as_json            ? "{\"event\":\"interrupted\"}\n"
                                          : "\nfathom: interrupted before anything was rendered\n");
    check_options(o);
    if (environment.count > 1 && o.dataset.format != DatasetFormat::none)
        throw UsageError("--dataset: runs as one process; leave out mpirun, and divide models with --part K/N");
    if (environment.count > 1) return render_as_rank(o, environment, reporter);
    if (o.dataset.format != DatasetFormat::none) return render_dataset(o, reporter);
    check_outputs(o);
    return o.watches ? render_and_watch(o, reporter) : render_scene(o, nullptr, nullptr, reporter);
}

/// Runs the command for --progress json, where errors are events, too.
int run_with_json_errors(RenderOptions& o, Reporter& reporter)
{
    try {
        return run_render(o, reporter);
    } catch (const UsageError&) {
        throw;
    } catch (const std::exception& error) {
        reporter.error(error.what());
        return exit_error;
    }
}

int run_reported(RenderOptions& o)
{
    Reporter reporter(o.json ? ReportMode::json : o.quiet ? ReportMode::quiet : default_report_mode());
    return o.json ? run_with_json_errors(o, reporter) : run_render(o, reporter);
}

}  // namespace

void add_render(CLI::App& program, Run& run)
{
    add_command<RenderOptions>(program, run, render_text, add_all_render_options, run_reported);
}

}  // namespace fathom::cli
