// SPDX-License-Identifier: Apache-2.0
#include "fathom/save.h"

#include "base/output_file.h"
#include "formats/fathom/scene_json.h"
#include "formats/gltf/glb.h"
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

void save_glb(const SceneDescription& scene, const std::filesystem::path& file, Warnings& warnings)
{
    check_scene(scene);
    const std::string bytes = glb_bytes(scene, file.string(), warnings);
    SaveFiles(scene, file).write();  // GLB has no other files; write() only checks the target's name
    OutputFile out(file);
    out.write(bytes.data(), bytes.size());
    out.commit();
}

}  // namespace fathom
