#include <memory>

#include "arguments.h"
#include "commands.h"
#include "fathom/error.h"
#include "scene_options.h"

namespace fathom::cli {

void add_view(CLI::App& program, Run& run)
{
    const auto options = std::make_shared<SceneOptions>();
    Command command(program, "view", "Show a scene in a window as it becomes clear");
    add_scene_options(command, *options);
    command.set_footer("Example:\n  fathom view model.glb\n\nExit codes: 0 done; 1 error; 2 wrong usage.");
    command.set_run(run, [options]() -> int { throw Error("", "", "this build has no window"); });
}

}  // namespace fathom::cli
