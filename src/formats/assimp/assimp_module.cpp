// SPDX-License-Identifier: Apache-2.0
#include <assimp/DefaultIOSystem.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cmath>

#include "formats/assimp/assimp_convert.h"
#include "formats/assimp/module.h"

namespace fathom {

namespace {

/// Transform from the file's axes and unit to y up and meters. Assimp applies the axes of Collada and 3DS, but leaves
/// those of FBX to its users.
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
    // UnitScaleFactor is in centimeters per unit.
    double unit = 100;
    float unit_float = 100;
    if (!scene.mMetaData->Get("UnitScaleFactor", unit) && scene.mMetaData->Get("UnitScaleFactor", unit_float))
        unit = unit_float;
    if (unit > 0 && std::isfinite(unit))
        for (auto& row : t.m)
            for (double& value : row) value *= unit / 100;
    return t;
}

/// Assimp's file access: regular files only, and only files of one folder if the request says so.
class Files : public Assimp::DefaultIOSystem {
public:
    Files(const AssimpRequest& request, std::vector<std::filesystem::path>& opened) : request_(request), opened_(opened)
    {
    }

    bool Exists(const char* file) const override { return may_open(file) && DefaultIOSystem::Exists(file); }
    Assimp::IOStream* Open(const char* file, const char* mode) override
    {
        // Writing is refused, and so are pipes, which might block.
        if (mode[0] != 'r' || !may_open(file)) return nullptr;
        Assimp::IOStream* const stream = DefaultIOSystem::Open(file, mode);
        if (stream) opened_.emplace_back(file);
        return stream;
    }

private:
    bool may_open(const char* file) const
    {
        std::error_code error;
        if (!std::filesystem::is_regular_file(file, error)) return false;
        const std::filesystem::path& folder = request_.folder;
        if (folder.empty() || file == request_.file) return true;
        const std::filesystem::path real = std::filesystem::canonical(file, error);
        return !error && std::mismatch(folder.begin(), folder.end(), real.begin(), real.end()).first == folder.end();
    }

    const AssimpRequest& request_;
    std::vector<std::filesystem::path>& opened_;
};

void read(const AssimpRequest& request, AssimpAnswer& answer)
{
    const std::filesystem::path& file = request.file;
    Assimp::Importer importer;
    importer.SetIOHandler(new Files(request, answer.scene.files));  // the importer takes ownership
    if (!importer.IsExtensionSupported(file.extension().string())) {
        answer.error = "this format is not supported";
        return;
    }
    // Fathom triangulates polygons itself, and other postprocessing costs time or memory without use.
    const aiScene* scene = importer.ReadFile(
        file.string(), aiProcess_JoinIdenticalVertices | aiProcess_GenUVCoords | aiProcess_TransformUVCoords);
    if (!scene) {
        answer.error = importer.GetErrorString();
        if (answer.error == "std::bad_alloc") answer.error = "the scene does not fit into memory";
        if (answer.error.empty()) answer.error = "the file can't be read";
        return;
    }
    if (!scene->mRootNode || scene->mNumMeshes == 0) {
        answer.error = "it contains no meshes";
        return;
    }
    AssimpConverter(*scene, file, answer).convert(file_to_world(*scene, request.turn_up));
    if (scene->mNumAnimations > 0) answer.warnings.push_back("animations are not supported: the rest pose is used");
}

}  // namespace

}  // namespace fathom

extern "C" {

FATHOM_API extern const char fathom_assimp_version[];
const char fathom_assimp_version[] = FATHOM_VERSION;

FATHOM_API void fathom_assimp_read(const fathom::AssimpRequest& request, fathom::AssimpAnswer& answer)
{
    try {
        fathom::read(request, answer);
    } catch (const std::exception& e) {
        answer.error = e.what();
    } catch (...) {
        answer.error = "the file can't be read";
    }
}
}
