#include <fmt/format.h>
#include <memory>

#include "commands/commands.h"
#include "fathom/save.h"
#include "options/arguments.h"
#include "options/image_options.h"
#include "options/scene_options.h"
#include "report/reporter.h"

namespace fathom::cli {

namespace {

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
            fmt::format("{}: scenes are written as JSON or GLB: a name that ends in .json or .glb", o.output.string()));
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

}  // namespace

void add_convert(CLI::App& program, Run& run)
{
    const auto options = std::make_shared<ConvertOptions>();
    Command command(program, "convert", "Write a scene or model as Fathom's own scene file, or as GLB");
    add_file_options(command, options->scene);
    command.add_positional("OUTPUT", options->output, "the file to write, *.json or *.glb");
    command.add_flag("-q,--quiet", options->quiet, "print only errors");
    command.set_footer(
        "JSON renders to the same bits. Meshes, curves, points and embedded pictures are written to a folder beside "
        "it, "
        "named\n"
        "after it (scene.json: scene-files); pictures that are files are referred to where they are.\n"
        "GLB is one file, for other programs; what glTF can't say is told, and left out.\n\n"
        "Examples:\n  fathom convert model.glb scene.json\n  fathom convert scene.pbrt model.glb\n\n"
        "Exit codes: 0 done; 1 error; 2 wrong usage.");
    command.set_run(run, [options] { return run_convert(*options); });
}

}  // namespace fathom::cli
