#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <cmath>

#include "import/assimp/assimp_convert.h"
#include "import/assimp/module.h"

namespace fathom {

namespace {

/// The map from the file's axes and unit to y up and metres; FBX writes them down, Assimp leaves them to us. (Collada
/// and 3DS come turned already.)
Transform file_to_world(const aiScene& scene, bool turn_up)
{
    Transform t;
    if (!scene.mMetaData) return t;
    const auto axis = [&](const char* name, int otherwise) {
        std::int32_t value = otherwise;
        scene.mMetaData->Get(name, value);
        return value >= 0 && value < 3 ? std::size_t(value) : std::size_t(otherwise);
    };
    const auto sign = [&](const char* name) {
        std::int32_t value = 1;
        scene.mMetaData->Get(name, value);
        return value < 0 ? -1.0 : 1.0;
    };
    if (turn_up) {
        const std::size_t x = axis("CoordAxis", 0), y = axis("UpAxis", 1), z = axis("FrontAxis", 2);
        if (x != y && y != z && z != x) {
            t.m = {};
            t.m[0][x] = sign("CoordAxisSign");
            t.m[1][y] = sign("UpAxisSign");
            t.m[2][z] = sign("FrontAxisSign");
        }
    }
    // Centimetres a unit.
    double unit = 100;
    float unit_float = 100;
    if (!scene.mMetaData->Get("UnitScaleFactor", unit) && scene.mMetaData->Get("UnitScaleFactor", unit_float))
        unit = unit_float;
    if (unit > 0 && std::isfinite(unit))
        for (auto& row : t.m)
            for (double& value : row) value *= unit / 100;
    return t;
}

void read(const std::filesystem::path& file, bool turn_up, AssimpAnswer& answer)
{
    Assimp::Importer importer;
    if (!importer.IsExtensionSupported(file.extension().string())) {
        answer.error = "no reader knows this format";
        return;
    }
    // Polygons are cut by ourselves, and the other steps cost time or memory for nothing that we need.
    const aiScene* scene = importer.ReadFile(
        file.string(), aiProcess_JoinIdenticalVertices | aiProcess_GenUVCoords | aiProcess_TransformUVCoords);
    if (!scene) {
        answer.error = importer.GetErrorString();
        if (answer.error == "std::bad_alloc") answer.error = "the scene does not fit into memory";
        if (answer.error.empty()) answer.error = "the file can't be read";
        return;
    }
    if (!scene->mRootNode || scene->mNumMeshes == 0) {
        answer.error = "there are no meshes in it";
        return;
    }
    AssimpConverter(*scene, file, answer).convert(file_to_world(*scene, turn_up));
    if (scene->mNumAnimations > 0) answer.warnings.push_back("animations are not played: the pose at rest is shown");
}

}  // namespace

}  // namespace fathom

extern "C" {

FATHOM_API extern const char fathom_assimp_version[];
const char fathom_assimp_version[] = FATHOM_VERSION;

FATHOM_API void fathom_assimp_read(const std::filesystem::path& file, bool turn_up, fathom::AssimpAnswer& answer)
{
    try {
        fathom::read(file, turn_up, answer);
    } catch (const std::exception& e) {
        answer.error = e.what();
    } catch (...) {
        answer.error = "the file can't be read";
    }
}
}
