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
#include "process/streams.h"

namespace fathom::cli {

namespace {

int complain(std::string message, int code)
{
    std::replace(message.begin(), message.end(), '\n', ' ');
    say(fmt::format("fathom: {}\n", message));
    return code;
}

/// --help and --version: CLI11 knows the texts.
int tell(const CLI::App& app, const CLI::ParseError& request)
{
    std::ostringstream text;
    app.exit(request, text, text);
    print(text.str());
    return exit_ok;
}

/// CLI11's words, but where they don't say what is the matter.
std::string usage_message(const std::string& message)
{
    const std::size_t often = message.find(": At Most 1 required but received ");
    if (often != std::string::npos) return message.substr(0, often) + " is given more than once";
    return message;
}

/// The words of the command line, last first, as CLI11 takes them; `--denoise auto` as `--denoise=auto`: an option that
/// may do without a value would take the name of a file for one.
std::vector<std::string> words_of(int argc, char** argv)
{
    std::vector<std::string> words;
    for (int i = 1; i < argc; ++i) {
        if (!words.empty() && words.back() == "--denoise" && std::string_view(argv[i]) == "auto")
            words.back() += "=auto";
        else
            words.emplace_back(argv[i]);
    }
    std::reverse(words.begin(), words.end());
    return words;
}

/// Throws UsageError for a command of which as many copies as there are ranks would do harm.
void check_command(const CLI::App& app, const RankEnvironment& ranks)
{
    const std::string command = app.get_subcommands().front()->get_name();
    if (ranks.count == 1 || command == "render" || command == "info" || command == "version") return;
    throw UsageError(fmt::format("'fathom {}' is of one process, not of {} ranks ({}): leave out mpirun", command,
                                 ranks.count, ranks.variable));
}

/// What the command line asks for; returns the exit code.
int parse_and_run(int argc, char** argv)
{
    CLI::App app("Fathom, a path tracer for CPUs: a scene file in, a picture out.", "fathom");
    app.require_subcommand(1);
    app.set_version_flag("--version", "fathom " FATHOM_VERSION, "Print the version (`fathom version` tells more)");
    app.footer(
        "Examples:\n"
        "  fathom render scene.json                      256 samples a pixel, to scene.png\n"
        "  fathom render model.glb --time 1m -o a.exr -o a.png\n"
        "  fathom info model.glb\n"
        "`fathom COMMAND --help` tells a command's options.\n\n"
        "Exit codes: 0 done; 1 a file, the scene or the machine is not as it must be;\n"
        "2 wrong usage; 130 interrupted (the picture so far is written).");
    const RankEnvironment ranks = rank_environment();
    const auto complain_once = [&](const std::string& message) {
        if (ranks.rank == 0) return complain(message, exit_usage);
        leave_the_word_to_rank_0();
        return complain(fmt::format("rank {}: {}", ranks.rank, message), exit_usage);
    };
    Run run;
    add_render(app, run);
    add_merge(app, run);
    add_submit(app, run);
    add_status(app, run);
    add_info(app, run);
    add_convert(app, run);
    add_view(app, run);
    add_version(app, run);
    try {
        app.parse(words_of(argc, argv));
        check_command(app, ranks);
        return run();
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return tell(app, error);
        return complain_once(fmt::format("{} (see fathom --help)", usage_message(error.what())));
    } catch (const UsageError& error) {
        return complain_once(error.what());
    } catch (const Error& error) {
        return complain(error.what(), exit_error);
    } catch (const std::bad_alloc&) {
        return complain("there is not enough memory", exit_error);
    } catch (const std::exception& error) {
        return complain(error.what(), exit_error);
    }
}

}  // namespace

int run_program(int argc, char** argv)
{
    int code = exit_error;
    try {
        code = parse_and_run(argc, argv);
    } catch (const Error& error) {
        code = complain(error.what(), exit_error);
    }
    return code == exit_ok && could_not_say() ? exit_error : code;
}

}  // namespace fathom::cli
