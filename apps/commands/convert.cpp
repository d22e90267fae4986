// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "commands/commands.h"
#include "fathom/save.h"
#include "options/command.h"
#include "options/scene_options.h"
#include "report/reporter.h"

namespace fathom::cli {

namespace {

constexpr CommandText convert_text{
    "convert", "Convert a scene or model to a Fathom scene file or to GLB",
    "A converted JSON scene renders to the same bits. Meshes, curves, points and embedded images go to a folder\n"
    "next to it, named after it (scene.json: scene-files); image files stay where they are.\n"
    "GLB is one file, for other programs. Fathom warns about what glTF can't represent, and leaves it out.\n\n"
    "Examples:\n  fathom convert model.glb scene.json\n  fathom convert scene.pbrt model.glb\n\n"
    "Exit codes: 0 success; 1 error; 2 wrong usage."};

struct ConvertOptions {
    SceneOptions scene;
    std::filesystem::path output;
    bool quiet = false;
};

int run_convert(const ConvertOptions& o)
{
    const bool is_glb = o.output.extension() == ".glb";
    if (!is_glb && o.output.extension() != ".json")
        throw UsageError(
            fmt::format("{}: OUTPUT is JSON or GLB: its name must end in .json or .glb", o.output.string()));
    Reporter reporter(o.quiet ? ReportMode::quiet : default_report_mode());
    Warnings warnings;
    const SceneDescription scene = [&] {
        const Reporter::Phase phase(reporter, "load", "reading " + o.scene.file.string());
        return load_scene(o.scene.file, load_options(o.scene), warnings);
    }();
    (is_glb ? save_glb : save_scene)(scene, o.output, warnings);
    reporter.warnings(warnings);
    reporter.note(fmt::format("wrote {}", o.output.string()));
    return exit_ok;
}

void add_options(Command& command, ConvertOptions& o)
{
    add_file_options(command, o.scene);
    command.add_positional("OUTPUT", o.output, "file to write, *.json or *.glb");
    add_quiet_option(command, o.quiet);
}

}  // namespace

void add_convert(CLI::App& program, Run& run)
{
    add_command<ConvertOptions>(program, run, convert_text, add_options, run_convert);
}

}  // namespace fathom::cli
