// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <new>
#include <sstream>
#include <string_view>
#include <vector>

#include "commands/commands.h"
#include "distributed/ranks/environment.h"
#include "fathom/error.h"
#include "options/command_tables.h"
#include "options/config_file.h"
#include "process/streams.h"

namespace fathom::cli {

namespace {

int report_error(std::string message, int code)
{
    std::replace(message.begin(), message.end(), '\n', ' ');
    write_stderr(fmt::format("fathom: {}\n", message));
    return code;
}

/// Prints the text that --help or --version asks for.
int print_requested_text(const CLI::App& app, const CLI::ParseError& request)
{
    std::ostringstream text;
    app.exit(request, text, text);
    write_stdout(text.str());
    return exit_ok;
}

/// CLI11's message, reworded where it is hard to understand.
std::string usage_message(const std::string& message)
{
    const std::size_t repeated = message.find(": At Most 1 required but received ");
    if (repeated != std::string::npos) return message.substr(0, repeated) + " is given more than once";
    return message;
}

/// The words of the command line and of its --config file in reverse, as CLI11 expects them. `--denoise auto` becomes
/// `--denoise=auto`: an option with an optional value would otherwise take a following file name for it.
std::vector<std::string> reversed_words(int argc, char** argv, const CLI::App& app)
{
    std::vector<std::string> words;
    for (int i = 1; i < argc; ++i) {
        if (!words.empty() && words.back() == "--denoise" && std::string_view(argv[i]) == "auto")
            words.back() += "=auto";
        else
            words.emplace_back(argv[i]);
    }
    words = with_config_file(std::move(words), command_tables(app));
    std::reverse(words.begin(), words.end());
    return words;
}

/// Makes the scene of `fathom render` optional if --models takes its place. It is required otherwise, since CLI11 would
/// else take a scene behind `-o FILE` for a second output.
void make_scene_optional(CLI::App& app, const std::vector<std::string>& words)
{
    const bool has_models = std::any_of(words.begin(), words.end(), [](const std::string& word) {
        return word == "--models" || word.starts_with("--models=");
    });
    if (has_models) app.get_subcommand("render")->get_option("SCENE")->required(false);
}

/// Throws UsageError for a command that must not run once per rank.
void check_ranks(const CLI::App& app, const RankEnvironment& ranks)
{
    const std::string command = app.get_subcommands().front()->get_name();
    if (ranks.count == 1 || command == "render" || command == "info" || command == "version") return;
    throw UsageError(fmt::format("'fathom {}' runs as one process, not as {} ranks ({}): leave out mpirun", command,
                                 ranks.count, ranks.variable));
}

int parse_and_run(int argc, char** argv)
{
    CLI::App app("", "fathom");
    const RankEnvironment ranks = rank_environment();
    const auto report_once = [&](const std::string& message) {
        if (ranks.rank == 0) return report_error(message, exit_usage);
        let_rank0_report_first();
        return report_error(fmt::format("rank {}: {}", ranks.rank, message), exit_usage);
    };
    Run run;
    add_commands(app, run);
    try {
        std::vector<std::string> words = reversed_words(argc, argv, app);
        make_scene_optional(app, words);
        app.parse(std::move(words));
        check_ranks(app, ranks);
        return run();
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return print_requested_text(app, error);
        return report_once(fmt::format("{} (see fathom --help)", usage_message(error.what())));
    } catch (const UsageError& error) {
        return report_once(error.what());
    } catch (const Error& error) {
        return report_error(error.what(), exit_error);
    } catch (const std::bad_alloc&) {
        return report_error("there is not enough memory", exit_error);
    } catch (const std::exception& error) {
        return report_error(error.what(), exit_error);
    }
}

}  // namespace

void add_commands(CLI::App& program, Run& run)
{
    program.description("Fathom, a path tracer for CPUs: renders 3D models to physically correct images.");
    program.require_subcommand(1);
    program.set_version_flag("--version", "fathom " FATHOM_VERSION, "print the version; `fathom version` prints more");
    program.footer(
        "Examples:\n"
        "  fathom render scene.json                           256 samples per pixel, to scene.png\n"
        "  fathom render model.glb --time 1m -o a.exr -o a.png\n"
        "  fathom info model.glb\n"
        "`fathom COMMAND --help` lists the options of a command.\n\n"
        "Exit codes: 0 success; 1 error in a file, in the scene or on the machine;\n"
        "2 wrong usage; 130 interrupted (the image so far is written).");
    add_render(program, run);
    add_merge(program, run);
    add_submit(program, run);
    add_status(program, run);
    add_info(program, run);
    add_convert(program, run);
    add_diff(program, run);
    add_why(program, run);
    add_view(program, run);
    add_version(program, run);
    add_completion(program, run);
    add_man(program, run);
}

int run_program(int argc, char** argv)
{
    int code = exit_error;
    try {
        code = parse_and_run(argc, argv);
    } catch (const Error& error) {
        code = report_error(error.what(), exit_error);
    }
    return code == exit_ok && stderr_failed() ? exit_error : code;
}

}  // namespace fathom::cli
