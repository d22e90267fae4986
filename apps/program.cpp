#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <new>

#include "commands.h"
#include "fathom/error.h"

namespace fathom::cli {

namespace {

int complain(std::string message, int code)
{
    std::replace(message.begin(), message.end(), '\n', ' ');
    fmt::print(stderr, "fathom: {}\n", message);
    return code;
}

/// CLI11's words, but where they don't say what is the matter.
std::string usage_message(const std::string& message)
{
    const std::size_t often = message.find(": At Most 1 required but received ");
    if (often != std::string::npos) return message.substr(0, often) + " is given more than once";
    return message;
}

}  // namespace

int run_program(int argc, char** argv)
{
    CLI::App app("Fathom, a path tracer for CPUs: a scene file in, a picture out.", "fathom");
    app.require_subcommand(1);
    app.footer(
        "Examples:\n"
        "  fathom render scene.json                      256 samples a pixel, to scene.png\n"
        "  fathom render model.glb --time 1m -o a.exr -o a.png\n"
        "  fathom info model.glb\n"
        "`fathom COMMAND --help` tells a command's options.\n\n"
        "Exit codes: 0 done; 1 a file, the scene or the machine is not as it must be;\n"
        "2 wrong usage; 130 interrupted (the picture so far is written).");
    Run run;
    add_render(app, run);
    add_merge(app, run);
    add_info(app, run);
    add_view(app, run);
    add_version(app, run);
    try {
        app.parse(argc, argv);
        return run();
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help
        return complain(fmt::format("{} (see fathom --help)", usage_message(error.what())), exit_usage);
    } catch (const UsageError& error) {
        return complain(error.what(), exit_usage);
    } catch (const Error& error) {
        return complain(error.what(), exit_error);
    } catch (const std::bad_alloc&) {
        return complain("there is not enough memory", exit_error);
    } catch (const std::exception& error) {
        return complain(error.what(), exit_error);
    }
}

}  // namespace fathom::cli
