#include <memory>
#include <nlohmann/json.hpp>

#include "commands/commands.h"
#include "options/arguments.h"
#include "process/streams.h"
#include "report/film_info.h"
#include "report/scene_info.h"

namespace fathom::cli {

namespace {

using nlohmann::ordered_json;

struct InfoOptions {
    SceneOptions scene;
    bool json = false;
};

}  // namespace

void add_info(CLI::App& program, Run& run)
{
    const auto options = std::make_shared<InfoOptions>();
    Command command(program, "info", "Tell what is in a scene, model or film file");
    add_file_options(command, options->scene);
    command.add_flag("--json", options->json, "as JSON");
    command.set_footer(
        "Format, files, counts, sizes, memory, cameras, lights, materials by what they use, pictures, settings that "
        "the\n"
        "file says, and what of it is left out or approximated. Of a film file: its samples and what is missing of\n"
        "them, seed, settings, layers, noise; all of it is read, so damage shows.\n\n"
        "Examples:\n  fathom info model.glb\n  fathom info scene.json --json\n  fathom info film.exr\n\n"
        "Exit codes: 0 done; 1 error; 2 wrong usage.");
    command.set_run(run, [options] {
        const bool is_film = is_film_file(options->scene.file);
        const ordered_json info = is_film ? describe_film(options->scene.file) : describe_scene(options->scene);
        if (options->json)
            print(info.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n');
        else if (is_film)
            print_film_text(info);
        else
            print_scene_text(info);
        return int(exit_ok);
    });
}

}  // namespace fathom::cli
