// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "commands/commands.h"
#include "options/command.h"
#include "process/streams.h"
#include "report/film_info.h"
#include "report/scene_info.h"

namespace fathom::cli {

namespace {

constexpr CommandText info_text{
    "info", "Describe a scene, model or film file",
    "For a scene: format, files, counts, sizes, memory, cameras, lights, materials and their features, images,\n"
    "settings in the file, and what is ignored or approximated. For a film file: its samples and the missing\n"
    "ones, seed, settings, layers and noise; the whole file is read, so that damage is detected.\n\n"
    "Examples:\n  fathom info model.glb\n  fathom info scene.json --json\n  fathom info film.exr\n\n"
    "Exit codes: 0 success; 1 error; 2 wrong usage."};

struct InfoOptions {
    SceneOptions scene;
    bool json = false;
};

int run_info(const InfoOptions& o)
{
    const bool is_film = is_film_file(o.scene.file);
    const nlohmann::ordered_json info = is_film ? describe_film(o.scene.file) : describe_scene(o.scene);
    if (o.json)
        write_stdout(info.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n');
    else if (is_film)
        print_film_text(info);
    else
        print_scene_text(info);
    return exit_ok;
}

void add_options(Command& command, InfoOptions& o)
{
    add_file_options(command, o.scene);
    add_json_option(command, o.json);
}

}  // namespace

void add_info(CLI::App& program, Run& run)
{
    add_command<InfoOptions>(program, run, info_text, add_options, run_info);
}

}  // namespace fathom::cli
