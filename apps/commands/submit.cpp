#include <fmt/format.h>
#include <unistd.h>
#include <algorithm>
#include <memory>
#include <set>

#include "commands/commands.h"
#include "distributed/slurm/job_plan.h"
#include "distributed/slurm/slurm.h"
#include "fathom/error.h"
#include "options/arguments.h"
#include "options/image_options.h"
#include "options/render_options.h"
#include "options/scene_options.h"
#include "process/streams.h"
#include "report/reporter.h"

namespace fathom::cli {

namespace {

namespace fs = std::filesystem;

struct SubmitOptions {
    RenderOptions render;
    std::uint64_t parts = 0;
    std::vector<std::string> scheduler;
    bool slurm = false, fix = false, dry_run = false, unchecked = false;
    /// As they were given: for `fathom render`, and for `fathom merge`.
    std::vector<std::string> render_words, picture_words;
};

std::string own_program()
{
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    return error ? "fathom" : program.string();
}

/// A denoised picture needs more layers.
void add_aids(std::vector<std::string>& words)
{
    const auto aov = std::find(words.begin(), words.end(), "--aov");
    if (aov == words.end())
        words.insert(words.end(), {"--aov", "albedo,normal"});
    else
        *(aov + 1) += ",albedo,normal";
}

/// Words of options that name files, made absolute: tasks begin in a folder of their own.
std::vector<std::string> with_absolute_files(std::vector<std::string> words)
{
    static const std::set<std::string> files = {"--env", "--ocio"};
    for (std::size_t i = 1; i < words.size(); ++i)
        if (files.contains(words[i - 1]) && fs::exists(words[i])) words[i] = fs::absolute(words[i]).lexically_normal();
    return words;
}

void check_usage(const SubmitOptions& o)
{
    if (!o.slurm) throw UsageError("--slurm: say what the parts are handed to (there is only Slurm so far)");
    if (o.render.picture.outputs.empty())
        throw UsageError("-o: say where the picture goes: a folder that all nodes see");
    if (o.parts == 0) throw UsageError("--parts: say into how many tasks the samples are to be split");
    if (o.render.time_s || o.render.range || o.render.only_sample || !o.render.frames.empty() || o.render.turntable > 0)
        throw UsageError("submit makes one picture of --spp samples a pixel, in parts");
}

/// How many samples a pixel the scene itself asks for, if no option does. Reads the scene: what is wrong with it had
/// better be known now.
std::uint64_t samples_of(const SubmitOptions& o, Reporter& reporter)
{
    Warnings warnings;
    LoadedScene loaded = [&] {
        const Reporter::Phase phase(reporter, "load", "reading " + o.render.scene.file.string());
        return load_for_render(o.render.scene, warnings);
    }();
    if (o.render.samples) return *o.render.samples;
    return hinted_samples(loaded.description.hints, o.render.scene.file.string()).value_or(default_samples);
}

JobPlan plan_of(const SubmitOptions& o, Reporter& reporter)
{
    JobPlan plan;
    plan.program = own_program();
    plan.scene = fs::absolute(o.render.scene.file).lexically_normal();
    plan.render_options = with_absolute_files(o.render_words);
    plan.picture_options = with_absolute_files(o.picture_words);
    if (o.render.picture.denoise != Denoising::off) add_aids(plan.render_options);
    for (const fs::path& output : o.render.picture.outputs)
        plan.outputs.push_back(fs::absolute(output).lexically_normal());
    plan.parts = o.parts;
    plan.scheduler_options = o.scheduler;
    plan.samples = samples_of(o, reporter);
    if (plan.samples < plan.parts)
        throw UsageError(fmt::format("--parts: {} samples a pixel can't be split into {}", plan.samples, plan.parts));
    return plan;
}

/// The plan that is there already, with this one's wishes for the scheduler; or this one.
JobPlan joined_with_earlier(JobPlan plan)
{
    std::error_code error;
    if (!fs::exists(plan.folder() / "plan.json", error)) return plan;
    JobPlan earlier = JobPlan::read(plan.folder());
    if (const std::string difference = plan.difference(earlier); !difference.empty())
        throw Error(
            plan.folder().string(), "",
            fmt::format("has parts of another picture: {}. Take another -o, or remove that folder", difference));
    plan.submissions = std::move(earlier.submissions);
    return plan;
}

void make_folder(const fs::path& folder)
{
    std::error_code error;
    fs::create_directories(folder, error);
    if (error || access(folder.c_str(), W_OK) != 0)
        throw Error(folder.string(), "",
                    "can't be made, or not be written into: parts are kept there, where all nodes see it");
}

/// Asks a node whether it sees what its tasks are going to read.
void check_nodes_see(const JobPlan& plan, Reporter& reporter)
{
    const Reporter::Phase phase(reporter, "look", "asking a node whether it sees the scene");
    const auto missing = slurm::paths_missing_on_nodes({plan.program, plan.scene.string(), plan.folder().string()},
                                                       plan.scheduler_options);
    if (!missing || missing->empty()) return;
    std::error_code error;
    fs::remove(plan.folder(), error);  // if nothing is in it
    throw Error(missing->front(), "",
                "is not to be seen on the cluster's nodes: keep scene, program and picture in a shared folder "
                "(--unchecked submits all the same)");
}

/// Tasks that Slurm could not start are cancelled: others take their place.
void forget_stuck(slurm::Queue& queue)
{
    std::erase_if(queue.parts, [](const auto& part) {
        if (part.second.is_stuck) slurm::cancel(part.second.id);
        return part.second.is_stuck;
    });
    if (queue.merge && queue.merge->is_stuck) {
        slurm::cancel(queue.merge->id);
        queue.merge.reset();
    }
}

/// Parts that have not all their samples, and that no task is about to make.
std::vector<std::uint64_t> parts_to_submit(const JobPlan& plan, const slurm::Queue& queue)
{
    std::vector<std::uint64_t> parts;
    for (std::uint64_t part = 1; part <= plan.parts; ++part) {
        const SampleRange range = plan.samples_of(part);
        if (!queue.parts.contains(part) && look_at_part(plan, part).samples < range.second - range.first)
            parts.push_back(part);
    }
    return parts;
}

int print_scripts(const JobPlan& plan)
{
    std::vector<std::uint64_t> all;
    for (std::uint64_t part = 1; part <= plan.parts; ++part) all.push_back(part);
    print(slurm::task_script(plan, all, slurm::warning_before(plan.scheduler_options)));
    print("\n" + slurm::merge_script(plan, "NUMBER_OF_THE_ARRAY"));
    return exit_ok;
}

/// Hands over what is missing, and a merge that waits for all that is under way.
int submit_missing(JobPlan plan, Reporter& reporter)
{
    auto queue = slurm::queue_of(plan);
    if (!queue) throw Error("", "", "Slurm doesn't answer: what is under way is not known, so nothing was submitted");
    forget_stuck(*queue);
    const std::vector<std::uint64_t> parts = parts_to_submit(plan, *queue);
    if (parts.empty()) {
        reporter.note(queue->parts.empty() ? "all parts are there" : "all parts are there or under way");
        if (!queue->parts.empty() || queue->merge) return exit_ok;
        plan.submissions.push_back({"", slurm::submit(slurm::merge_script(plan, ""), plan.folder().string())});
        plan.write();
        reporter.note(
            fmt::format("submitted job {}: merge to {}", plan.submissions.back().merge, plan.outputs.front().string()));
        return exit_ok;
    }
    Submission submission;
    const std::string folder = plan.folder().string();
    submission.array =
        slurm::submit(slurm::task_script(plan, parts, slurm::warning_before(plan.scheduler_options)), folder);
    // Known before anything else can fail: tasks that nobody knows of would be made twice.
    plan.submissions.push_back(submission);
    plan.write();
    if (queue->merge)
        for (const Submission& s : plan.submissions)
            if (!s.merge.empty()) slurm::cancel(s.merge);
    std::string arrays;
    for (const Submission& s : plan.submissions)
        if (!s.array.empty()) arrays += (arrays.empty() ? "" : ":") + s.array;
    plan.submissions.back().merge = slurm::submit(slurm::merge_script(plan, arrays), folder);
    plan.write();
    reporter.note(fmt::format("submitted array {}: {} of {} samples a pixel each; job {}: merge to {}",
                              submission.array, parts.size() == 1 ? "1 part" : fmt::format("{} parts", parts.size()),
                              plan.samples / plan.parts, plan.submissions.back().merge, plan.outputs.front().string()));
    reporter.note(fmt::format("fathom status {} tells how far they are", plan.outputs.front().string()));
    return exit_ok;
}

int run_submit(const SubmitOptions& o)
{
    Reporter reporter(o.render.quiet ? ReportMode::quiet : default_report_mode());
    JobPlan plan;
    if (o.fix) {
        plan = JobPlan::read(JobPlan::folder_of(o.render.scene.file));
    } else {
        check_usage(o);
        for (const fs::path& output : o.render.picture.outputs) check_output(output);
        plan = plan_of(o, reporter);
    }
    if (o.dry_run) return print_scripts(plan);
    slurm::check_is_here();
    if (const std::uint64_t largest = slurm::largest_task_number(); plan.parts > largest)
        throw UsageError(fmt::format("--parts: this cluster takes arrays of up to {} tasks (MaxArraySize)", largest));
    if (!o.fix) plan = joined_with_earlier(std::move(plan));
    make_folder(plan.folder());
    // Later tasks need what the first ones needed.
    if (!o.unchecked && plan.submissions.empty()) check_nodes_see(plan, reporter);
    return submit_missing(std::move(plan), reporter);
}

}  // namespace

namespace {

void add_cluster_options(Command& command, SubmitOptions& o)
{
    const auto add_word = [&](const std::string& name, const std::string& value, const std::string& help) {
        command.add_value("--" + name, value, help,
                          [&o, name](const std::string& text) { o.scheduler.push_back("--" + name + "=" + text); });
    };
    command.add_flag("--slurm", o.slurm, "by Slurm: an array of jobs, and one that merges what they made");
    command.add_value("--parts", "N", "how many jobs: each renders so many of the samples of all pixels",
                      [&](const std::string& text) { o.parts = parse_integer(text, 1, 1'000'000); });
    add_word("partition", "NAME", "of the cluster (default: the cluster's)");
    add_word("time", "T",
             "the most that each job may take, as Slurm has it: minutes, H:MM:SS or D-HH; what is not done "
             "by then goes on in another turn");
    add_word("account", "NAME", "whom it is charged to");
    add_word("cpus-per-task", "N", "threads of each job (default: the cluster's, mostly 1)");
    command.add_value("--sbatch", "'OPTIONS'", "more of them, as `sbatch` has them", [&](const std::string& text) {
        for (const std::string& word : split(text, ' '))
            if (!word.empty()) o.scheduler.push_back(word);
    });
    command.add_flag("--fix", o.fix, "SCENE is a picture that was submitted before: hand over what is missing of it");
    command.add_flag("--dry-run", o.dry_run, "print the scripts, and submit nothing");
    command.add_flag("--unchecked", o.unchecked, "don't ask a node first whether it sees scene and folder");
    command.add_flag("-q,--quiet", o.render.quiet, "print only errors");
}

}  // namespace

void add_submit(CLI::App& program, Run& run)
{
    const auto o = std::make_shared<SubmitOptions>();
    const auto command = std::make_shared<Command>(
        program, "submit", "Have a cluster render a picture in parts; again, what is missing of it");
    const std::size_t first = command->option_count();
    add_scene_options(*command, o->render.scene);
    add_pixel_options(*command, o->render);
    add_settings_options(*command, o->render.settings);
    add_every_option(*command, o->render);
    const std::size_t first_of_picture = command->option_count();
    add_picture_options(*command, o->render.picture);
    const std::size_t last = command->option_count();
    add_sample_options(*command, o->render);
    add_cluster_options(*command, *o);
    command->set_footer(
        "SCENE, and where the picture goes, must be in a folder that all nodes of the cluster see. Parts are kept "
        "beside\n"
        "the picture, in a folder of its name and .parts, and go on from what they have when they are started "
        "again.\n\n"
        "Examples:\n"
        "  fathom submit scene.json --spp 4096 --slurm --parts 64 --time 30:00 -o out.exr\n"
        "  fathom status out.exr                         how far they are\n"
        "  fathom submit --fix out.exr                   what is missing, once more\n"
        "  fathom submit scene.json --slurm --parts 64 -o out.exr --dry-run\n\n"
        "Exit codes: 0 done; 1 error; 2 wrong usage.");
    command->set_run(run, [o, command, first, first_of_picture, last] {
        o->render_words = command->given(first, first_of_picture);
        o->picture_words = command->given(first_of_picture, last);
        return run_submit(*o);
    });
}

}  // namespace fathom::cli
