// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <memory>
#include <set>

#include "commands/commands.h"
#include "distributed/slurm/job_plan.h"
#include "distributed/slurm/submission.h"
#include "options/arguments.h"
#include "options/render_options.h"
#include "process/streams.h"
#include "render/scene_setup.h"
#include "report/reporter.h"

namespace fathom::cli {

namespace {

constexpr CommandText submit_text{
    "submit", "Render an image in parts on a cluster, or submit its missing parts",
    "SCENE and the image must be in folders that all nodes of the cluster see. Parts are kept next to the image,\n"
    "in a folder named IMAGE.parts; a task that is started again continues from its part.\n\n"
    "Examples:\n"
    "  fathom submit scene.json --spp 4096 --slurm --parts 64 --time 30:00 -o out.exr\n"
    "  fathom status out.exr                         report their progress\n"
    "  fathom submit --fix out.exr                   submit the missing parts\n"
    "  fathom submit scene.json --slurm --parts 64 -o out.exr --dry-run\n\n"
    "Exit codes: 0 success; 1 error; 2 wrong usage."};

namespace fs = std::filesystem;

struct SubmitOptions {
    SceneOptions scene;
    FilmOptions film;
    SettingsOptions settings;
    CheckpointOptions checkpoint;
    SampleOptions samples;
    ImageOptions images;
    std::uint64_t parts = 0;
    std::vector<std::string> scheduler;
    bool slurm = false, fix = false, dry_run = false, unchecked = false, quiet = false;
    /// The given options, spelled for `fathom render` and for `fathom merge`.
    std::vector<std::string> render_words, merge_words;
};

std::string path_of_this_program()
{
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    return error ? "fathom" : program.string();
}

/// Adds the layers that guide the denoiser of the merged image.
void add_denoiser_layers(std::vector<std::string>& words)
{
    const auto aov = std::find(words.begin(), words.end(), "--aov");
    if (aov == words.end())
        words.insert(words.end(), {"--aov", "albedo,normal"});
    else
        *(aov + 1) += ",albedo,normal";
}

/// Makes file names in options absolute, since tasks start in another folder.
std::vector<std::string> with_absolute_files(std::vector<std::string> words)
{
    static const std::set<std::string> files = {"--env", "--ocio"};
    for (std::size_t i = 1; i < words.size(); ++i)
        if (files.contains(words[i - 1]) && fs::exists(words[i])) words[i] = fs::absolute(words[i]).lexically_normal();
    return words;
}

void check_usage(const SubmitOptions& o)
{
    if (!o.slurm) throw UsageError("--slurm: name the scheduler (Slurm is the only one)");
    if (o.images.outputs.empty()) throw UsageError("-o: name the image to write, in a folder that all nodes see");
    if (o.parts == 0) throw UsageError("--parts: choose the number of tasks");
}

/// Samples per pixel. Loads the scene, so that its errors show before anything is submitted.
std::uint64_t planned_samples(const SubmitOptions& o, Reporter& reporter)
{
    Warnings warnings;
    const LoadedScene loaded = load_for_render(o.scene, reporter, warnings);
    return *resolve_samples(o.samples, loaded.description.hints, o.scene.file.string(), default_render_samples).planned;
}

JobPlan make_plan(const SubmitOptions& o, Reporter& reporter)
{
    JobPlan plan;
    plan.program = path_of_this_program();
    plan.scene = fs::absolute(o.scene.file).lexically_normal();
    plan.render_options = with_absolute_files(o.render_words);
    plan.merge_options = with_absolute_files(o.merge_words);
    if (o.images.denoise != Denoising::off) add_denoiser_layers(plan.render_options);
    for (const fs::path& output : o.images.outputs) plan.outputs.push_back(fs::absolute(output).lexically_normal());
    plan.parts = o.parts;
    plan.scheduler_options = o.scheduler;
    plan.samples = planned_samples(o, reporter);
    if (plan.samples < plan.parts)
        throw UsageError(
            fmt::format("--parts: {} samples per pixel can't be split into {} parts", plan.samples, plan.parts));
    return plan;
}

int run_submit(const SubmitOptions& o)
{
    Reporter reporter(o.quiet ? ReportMode::quiet : default_report_mode());
    JobPlan plan;
    if (o.fix) {
        plan = JobPlan::read(JobPlan::folder_of(o.scene.file));
    } else {
        check_usage(o);
        for (const fs::path& output : o.images.outputs) check_output(output);
        plan = make_plan(o, reporter);
    }
    if (o.dry_run)
        write_stdout(submission_scripts(plan));
    else
        submit_job(std::move(plan), o.fix, !o.unchecked, reporter);
    return exit_ok;
}

void add_scheduler_options(Command& command, SubmitOptions& o)
{
    const auto add_slurm_option = [&](const std::string& name, const OptionText& text) {
        command.add_value(text, [&o, name](const std::string& value) { o.scheduler.push_back(name + "=" + value); });
    };
    command.begin_group("Cluster");
    command.add_flag({"--slurm", "", "use Slurm: an array of tasks, and a job that merges their parts", ""}, o.slurm);
    command.add_value({"--parts", "N", "number of tasks; each renders its share of the samples of all pixels", ""},
                      [&](const std::string& text) { o.parts = parse_integer(text, 1, 1'000'000); });
    add_slurm_option("--partition", {"--partition", "NAME", "partition of the cluster", "the cluster's"});
    add_slurm_option("--time", {"--time", "T",
                                "time limit of each task in Slurm's notation: minutes, H:MM:SS or D-HH; a task that is "
                                "not done by then is queued again and continues",
                                "the cluster's"});
    add_slurm_option("--account", {"--account", "NAME", "account that is charged", "the user's"});
    add_slurm_option("--cpus-per-task", {"--cpus-per-task", "N", "threads of each task", "the cluster's, usually 1"});
    command.add_value({"--sbatch", "'OPTIONS'", "further options for `sbatch`, separated by spaces", ""},
                      [&](const std::string& text) {
                          for (const std::string& word : split(text, ' '))
                              if (!word.empty()) o.scheduler.push_back(word);
                      });
    command.add_flag({"--fix", "", "SCENE is an image that was submitted before: submit its missing parts", ""}, o.fix);
    command.add_flag({"--dry-run", "", "print the scripts and submit nothing", ""}, o.dry_run);
    command.add_flag({"--unchecked", "", "don't test whether a node can access the scene and the folder", ""},
                     o.unchecked);
    add_quiet_option(command, o.quiet);
}

}  // namespace

void add_submit(CLI::App& program, Run& run)
{
    const auto o = std::make_shared<SubmitOptions>();
    const auto command = std::make_shared<Command>(program, submit_text);
    const std::size_t first = command->option_count();
    add_scene_options(*command, o->scene);
    add_film_options(*command, o->film);
    add_settings_options(*command, o->settings);
    add_every_option(*command, o->checkpoint);
    const std::size_t first_of_merge = command->option_count();
    add_image_options(*command, o->images, "");
    const std::size_t last = command->option_count();
    add_spp_option(*command, o->samples, "samples per pixel of the whole image", default_render_samples);
    add_scheduler_options(*command, *o);
    command->set_run(run, [o, command, first, first_of_merge, last] {
        o->render_words = command->given_options(first, first_of_merge);
        o->merge_words = command->given_options(first_of_merge, last);
        return run_submit(*o);
    });
}

}  // namespace fathom::cli
