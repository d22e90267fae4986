#include "fathom/save.h"

#include "export/scene_json.h"
#include "image/output_file.h"
#include "scene/check.h"

namespace fathom {

void save_scene(const SceneDescription& scene, const std::filesystem::path& file, Warnings& warnings)
{
    check_scene(scene);
    SaveFiles files(scene, file);
    const std::string text = json_text(scene_json(scene, file.string(), files, warnings));
    OutputFile out(file);
    files.write();
    out.write(text.data(), text.size());
    out.commit();
}

}  // namespace fathom
