// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "base/text_file.h"
#include "commands/commands.h"
#include "fathom/error.h"
#include "options/arguments.h"
#include "options/scene_options.h"
#include "options/settings_options.h"
#include "process/interrupt.h"
#include "process/streams.h"
#include "render/overwrite_guard.h"
#include "render/scene_setup.h"
#include "why/analysis.h"

namespace fathom::cli {

namespace {

constexpr CommandText why_text{
    "why", "Tell why an image is noisy and slow, and what helps",
    "Renders a small image and tells how much of its noise, light and time belongs to each light, material, object,\n"
    "kind of path and depth. Then it tries what could help, and prints the gain that each change had. The image is\n"
    "256 pixels wide or high unless --size is given. docs/why.md explains the tables.\n\n"
    "Examples:\n"
    "  fathom why scene.json\n"
    "  fathom why model.glb -o why.html               a page with heat maps of noise and cost\n"
    "  fathom why scene.xml --json --advice off       only the tables, as JSON\n\n"
    "Exit codes: 0 success; 1 error; 2 wrong usage; 130 interrupted."};

/// Longest side of the image without --size, in pixels.
constexpr int usual_side = 256;
constexpr int usual_samples = 32;

struct WhyOptions {
    SceneOptions scene;
    SettingsOptions settings;
    int samples = usual_samples;
    bool gives_advice = true, json = false, quiet = false;
    std::vector<std::filesystem::path> outputs;
};

/// The size of the small image, which has the shape of the scene's.
Size small_size(const WhyOptions& o, Size size)
{
    if (o.scene.size) return size;
    const double scale = double(usual_side) / std::max({size.width, size.height, usual_side});
    return {std::max(1, int(std::lround(size.width * scale))), std::max(1, int(std::lround(size.height * scale)))};
}

/// Samples per pixel of a trial, so that cheap scenes are measured well and slow ones soon: those of the profile, or as
/// many as take a few seconds.
int trial_samples(int samples, double profile_s)
{
    constexpr double trial_s = 3;
    constexpr int max_samples_of_trial = 512;
    const double as_many = samples * trial_s / std::max(profile_s, 1e-3);
    return std::max(samples, int(std::min<double>(as_many, max_samples_of_trial)));
}

bool is_json(const std::filesystem::path& file)
{
    return file.extension() == ".json";
}

/// Checks before the work what can be checked of the files to be written.
void check_report(const std::filesystem::path& file)
{
    if (!is_json(file) && file.extension() != ".html" && file.extension() != ".htm")
        throw UsageError(fmt::format("-o: expected a name that ends in .html or .json, found '{}'", file.string()));
    if (std::filesystem::is_directory(file)) throw Error(file.string(), "", "is a folder, not a file to be written");
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    if (!std::filesystem::is_directory(folder))
        throw Error(file.string(), "", fmt::format("there is no folder '{}'", folder.string()));
    if (access(folder.c_str(), W_OK) != 0)
        throw Error(file.string(), "", fmt::format("files can't be written to the folder '{}'", folder.string()));
}

constexpr const char* standard_output = "/dev/stdout";

void check_outputs(const WhyOptions& o)
{
    for (const auto& file : o.outputs) {
        if (file != standard_output)
            check_report(file);
        else if (o.json)
            throw UsageError("-o -, --json: both write to the standard output; leave out one of them");
    }
}

void write_reports(const WhyOptions& o, const Analysis& analysis, Reporter& reporter)
{
    const auto json = [&] {
        return analysis_json(analysis).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
    };
    bool has_stdout = o.json;
    for (const auto& file : o.outputs) {
        has_stdout |= file == standard_output;
        write_text_file(file, is_json(file) ? json() : analysis_page(analysis));
        if (file != standard_output) reporter.written(file.string());
    }
    if (o.json) write_stdout(json());
    if (!has_stdout) write_stdout(analysis_text(analysis));
}

int run_why(WhyOptions& o)
{
    check_outputs(o);
    Reporter reporter(o.quiet ? ReportMode::quiet : default_report_mode());
    Warnings warnings;
    const ThreadLimit limit = limit_threads(o.settings, reporter);
    LoadedScene loaded = load_for_render(o.scene, reporter, warnings);
    check_outputs_are_no_inputs(o.outputs, loaded.description);
    const RenderHints hints = loaded.description.hints;
    RenderSettings settings = resolve_settings(o.settings, hints, o.scene.file.string());
    loaded.size = small_size(o, loaded.size);
    settings.width = loaded.size.width, settings.height = loaded.size.height;
    report_added(loaded, reporter);
    EditableScene edit = make_edit(loaded, o.scene);
    const LitScene lit = [&] {
        const Reporter::Phase phase(reporter, "build", "building " + o.scene.file.string());
        return compile_with_light(edit, loaded, o.scene, settings, warnings);
    }();
    Analysis analysis{o.scene.file.string(), {}, {edit.description(), scene_objects(edit.description())}, {}, {}};
    analysis.display.tonemap = Tonemap::khronos_neutral;
    analysis.display.exposure_ev = hints.exposure.value_or(0);
    apply_light(lit, {}, settings, analysis.display, reporter);
    reporter.warnings(warnings);

    finish_on_interrupt("\nfathom: interrupted\n");
    const RenderJob job(lit.scene, settings);
    const auto working = [&](const std::string& what, const auto& work) {
        const Reporter::Phase phase(reporter, "why", what);
        return work();
    };
    std::optional<RenderProfile> profile = working("rendering with records of each path", [&] {
        return profile_render(job, analysis.names.objects(), std::max(1, o.samples / profile_sets), &interrupted());
    });
    if (!profile) return exit_interrupted;
    analysis.profile = std::move(*profile);
    if (o.gives_advice)
        analysis.remedies = working("trying what could help", [&] {
            return try_remedies({edit, job, analysis.profile, analysis.names, !lit.refracted_light.empty(),
                                 analysis.display.exposure_ev},
                                trial_samples(o.samples, analysis.profile.seconds), interrupted());
        });
    if (interrupted()) return exit_interrupted;
    write_reports(o, analysis, reporter);
    return exit_ok;
}

void add_options(Command& command, WhyOptions& o)
{
    add_scene_options(command, o.scene);
    add_settings_options(command, o.settings);
    command.begin_group("Sampling");
    command.add_value(
        {"--spp", "N",
         fmt::format("samples per pixel of the small image, rounded down to a multiple of {}", profile_sets),
         fmt::format("{}", usual_samples)},
        [&](const std::string& text) {
            o.samples = int(parse_integer(text, profile_sets, profile_sets * max_profile_set_samples));
        });
    command.begin_group("Output");
    command.add_files(
        {"-o,--output", "FILE.html|FILE.json",
         "page to write, with heat maps of noise and cost, or JSON; - writes the page to the standard output", ""},
        o.outputs);
    command.add_value({"--advice", "on|off", "try what could help, which takes most of the time", "on"},
                      [&](const std::string& text) { o.gives_advice = parse_choice(text, {"off", "on"}) == 1; });
    add_json_option(command, o.json);
    add_quiet_option(command, o.quiet);
}

}  // namespace

void add_why(CLI::App& program, Run& run)
{
    add_command<WhyOptions>(program, run, why_text, add_options, run_why);
}

}  // namespace fathom::cli
