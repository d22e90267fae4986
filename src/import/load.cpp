#include "fathom/error.h"
#include "fathom/load.h"

namespace fathom {

SceneDescription load_scene(const std::filesystem::path& file, const LoadOptions&, Warnings&)
{
    throw Error(file.string(), "", "no reader for this format yet");
}

Completed complete_scene(SceneDescription&, const CompleteOptions&) { return {}; }

}  // namespace fathom
