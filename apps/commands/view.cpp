#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "commands/commands.h"
#include "fathom/error.h"
#include "fathom/memory.h"
#include "options/arguments.h"
#include "options/image_options.h"
#include "options/scene_options.h"
#include "options/settings_options.h"
#include "process/interrupt.h"
#include "process/modules.h"
#include "render/film_memory.h"
#include "report/reporter.h"
#include "view/module.h"

namespace fathom::cli {

namespace {

/// Clear for most scenes, and an end: a window that is forgotten stops working.
constexpr std::uint64_t default_samples = 4096;

struct ViewOptions {
    SceneOptions scene;
    PictureOptions picture;
    SettingsOptions settings;
    std::optional<std::uint64_t> samples;
    std::filesystem::path latency_log;
    int script_moves = 0;
};

/// A film, one more for passes that can be dropped, and what is shown of them.
void check_memory_of(const ViewOptions& o, const LoadedScene& loaded, const RenderSettings& settings)
{
    std::vector<MemoryEstimate> needs = estimate_memory(loaded.description, loaded.build.value_or(TreeBuild::standard));
    for (MemoryEstimate& need : film_needs(settings, {.is_kept = true}, o.picture)) needs.push_back(std::move(need));
    check_memory(o.scene.file.string(), std::move(needs));
}

int run_view(ViewOptions& o)
{
    // Before a scene is loaded, which can take long.
    void* const module =
        open_module(view::module_file, view::version_symbol,
                    fmt::format("this installation has no window: its module {} is not there", view::module_file));
    std::string trouble;
    function_of<view::Trouble>(module, view::module_file, view::trouble_symbol)(trouble);
    if (!trouble.empty()) throw Error("", "", trouble);

    Reporter reporter(default_report_mode());
    Warnings warnings;
    const ThreadLimit limit = limit_threads(o.settings, reporter);
    std::optional<Denoiser> denoiser = open_denoiser(o.picture, o.settings.threads, reporter);
    LoadedScene loaded = [&] {
        const Reporter::Phase phase(reporter, "load", "reading " + o.scene.file.string());
        return load_for_render(o.scene, warnings);
    }();
    const RenderHints hints = loaded.description.hints;
    RenderSettings settings = settings_of(o.settings, hints, o.scene.file.string());
    settings.width = loaded.size.width;
    settings.height = loaded.size.height;
    const std::uint64_t hinted = hinted_samples(hints, o.scene.file.string()).value_or(default_samples);
    if (!loaded.added.empty())
        reporter.note(fmt::format("the file lacks them, so these were added: {}", fmt::join(loaded.added, ", ")));
    if (!loaded.note.empty()) reporter.note(loaded.note);

    check_memory_of(o, loaded, settings);
    const Bounds bounds = world_bounds(loaded.description);
    AutoLitScene lit = [&] {
        const Reporter::Phase phase(reporter, "build", "building " + o.scene.file.string());
        SceneEdit edit = take_edit(loaded, o.scene);
        return compile_loaded(edit, loaded, o.scene, settings, warnings);
    }();
    DisplayTransform display = write_options(o.picture, hints, reporter).display;
    use_light(lit, o.picture, settings, display, reporter);
    view::ViewJob job{std::move(lit.scene), settings, {}, 0, {}, std::move(denoiser), {}, {}, 0, nullptr};
    reporter.warnings(warnings);
    job.name = o.scene.file.filename().string();
    job.samples = o.samples.value_or(hinted);
    job.display = display;
    job.bounds = bounds;
    job.latency_log = o.latency_log;
    job.script_moves = o.script_moves;
    job.interrupted = &interrupted();

    finish_on_interrupt("");
    function_of<view::RunView>(module, view::module_file, view::run_symbol)(job, trouble);
    if (!trouble.empty()) throw Error("", "", trouble);
    return exit_ok;
}

}  // namespace

void add_view(CLI::App& program, Run& run)
{
    const auto options = std::make_shared<ViewOptions>();
    Command command(program, "view", "Show a scene in a window as it becomes clear");
    add_scene_options(command, options->scene);
    command.add_value(
        "--spp", "N", "samples a pixel at which to rest (default: the scene's, else 4096)",
        [o = options.get()](const std::string& text) { o->samples = parse_integer(text, 1, max_samples); });
    add_settings_options(command, options->settings);
    add_display_options(command, options->picture);
    command.add_value("--log-latency", "FILE", "write how long each camera move takes to be seen, milliseconds, as CSV",
                      [o = options.get()](const std::string& text) { o->latency_log = text; });
    command.add_value(
        "--script-moves", "N", "move the camera N times, say how long that took to be seen, and quit",
        [o = options.get()](const std::string& text) { o->script_moves = int(parse_integer(text, 1, 1000000)); });
    command.set_footer(
        "H in the window shows what mouse and keys do; docs/view.md tells more.\n\n"
        "Examples:\n"
        "  fathom view model.glb\n"
        "  fathom view scene.json --size 1280x720 --exposure 1 --tonemap filmic\n\n"
        "Exit codes: 0 done; 1 error, also if there is no display; 2 wrong usage.");
    command.set_run(run, [options] { return run_view(*options); });
}

}  // namespace fathom::cli
