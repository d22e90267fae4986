// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "commands/commands.h"
#include "fathom/error.h"
#include "fathom/memory.h"
#include "options/arguments.h"
#include "options/image_options.h"
#include "options/sample_request.h"
#include "options/settings_options.h"
#include "process/interrupt.h"
#include "process/modules.h"
#include "render/film_memory.h"
#include "render/scene_setup.h"
#include "report/reporter.h"
#include "view/module.h"

namespace fathom::cli {

namespace {

constexpr CommandText view_text{"view", "Show a scene in a window while it is rendered",
                                "H in the window lists mouse and keys; docs/view.md explains them.\n\n"
                                "Examples:\n"
                                "  fathom view model.glb\n"
                                "  fathom view scene.json --size 1280x720 --exposure 1 --tonemap filmic\n\n"
                                "Exit codes: 0 success; 1 error, such as no display; 2 wrong usage."};

struct ViewOptions {
    SceneOptions scene;
    ImageOptions images;
    SettingsOptions settings;
    SampleOptions samples;
    std::filesystem::path latency_log;
    int script_moves = 0;
};

/// Checks the memory for the scene, two films (one for passes that may be dropped) and their image.
void check_view_memory(const ViewOptions& o, const LoadedScene& loaded, const RenderSettings& settings)
{
    std::vector<MemoryEstimate> needs =
        estimate_memory(loaded.description, loaded.build.value_or(BvhQuality::standard));
    for (MemoryEstimate& need : film_memory(settings, {.has_checkpoint = true}, o.images))
        needs.push_back(std::move(need));
    check_memory(o.scene.file.string(), std::move(needs));
}

int run_view(ViewOptions& o)
{
    // Checked before the scene, which can take long to load.
    void* const module =
        open_module(view::module_file, view::version_symbol,
                    fmt::format("this installation has no window: its module {} is missing", view::module_file));
    std::string trouble;
    find_function<view::Trouble>(module, view::module_file, view::trouble_symbol)(trouble);
    if (!trouble.empty()) throw Error("", "", trouble);

    Reporter reporter(default_report_mode());
    Warnings warnings;
    const ThreadLimit limit = limit_threads(o.settings, reporter);
    std::optional<Denoiser> denoiser = open_denoiser(o.images, o.settings.threads, reporter);
    LoadedScene loaded = load_for_render(o.scene, reporter, warnings);
    const RenderHints hints = loaded.description.hints;
    RenderSettings settings = resolve_settings(o.settings, hints, o.scene.file.string());
    settings.width = loaded.size.width;
    settings.height = loaded.size.height;
    const SampleRequest samples = resolve_samples(o.samples, hints, o.scene.file.string(), default_view_samples);
    report_added(loaded, reporter);

    check_view_memory(o, loaded, settings);
    const Bounds bounds = world_bounds(loaded.description);
    LitScene lit = [&] {
        const Reporter::Phase phase(reporter, "build", "building " + o.scene.file.string());
        EditableScene edit = make_edit(loaded, o.scene);
        return compile_with_light(edit, loaded, o.scene, settings, warnings);
    }();
    DisplayTransform display = resolve_write_options(o.images, hints, reporter).display;
    apply_light(lit, o.images, settings, display, reporter);
    decide_on_caustics(lit, {o.scene.file.string(), o.settings.caustics.value_or(false)}, settings, warnings, reporter);
    view::ViewJob job{std::move(lit.scene), settings, {}, 0, {}, std::move(denoiser), {}, {}, 0, nullptr};
    reporter.warnings(warnings);
    job.name = o.scene.file.filename().string();
    job.samples = *samples.planned;
    job.display = display;
    job.bounds = bounds;
    job.latency_log = o.latency_log;
    job.script_moves = o.script_moves;
    job.interrupted = &interrupted();

    finish_on_interrupt("");
    find_function<view::RunView>(module, view::module_file, view::run_symbol)(job, trouble);
    if (!trouble.empty()) throw Error("", "", trouble);
    return exit_ok;
}

void add_options(Command& command, ViewOptions& o)
{
    add_scene_options(command, o.scene);
    add_spp_option(command, o.samples, "samples per pixel after which rendering pauses", default_view_samples);
    add_settings_options(command, o.settings);
    add_display_options(command, o.images);
    command.begin_group("Reporting and debugging");
    command.add_value({"--log-latency", "FILE", "write the latency of each camera move, in milliseconds, as CSV", ""},
                      [&o](const std::string& text) { o.latency_log = text; });
    command.add_value({"--script-moves", "N", "move the camera N times, print the latencies, and quit", ""},
                      [&o](const std::string& text) { o.script_moves = int(parse_integer(text, 1, 1000000)); });
}

}  // namespace

void add_view(CLI::App& program, Run& run)
{
    add_command<ViewOptions>(program, run, view_text, add_options, run_view);
}

}  // namespace fathom::cli
