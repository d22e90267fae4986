// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "compile/compiler.h"
#include "compile/fingerprint.h"
#include "compile/scene_data.h"
#include "scene/check.h"

namespace fathom {

/// Changes since a scene was compiled.
struct SceneChanges {
    SceneParts parts;          ///< moved nodes, and movable meshes with new vertices
    bool environment = false;  ///< the environment changed, but not its image
};

/// Compiles a description, which must outlive it, and applies later changes.
class SceneCompiler {
public:
    SceneCompiler(const SceneDescription& scene, std::string camera, BvhQuality build)
        : scene_(scene), camera_(std::move(camera)), build_(build)
    {
    }

    const std::string& camera() const { return camera_; }
    /// Compiles all of the scene. Throws Error as Scene::compile.
    std::shared_ptr<Scene::Data> compile(Warnings& warnings);
    /// Updates the result of compile() in place, in the same render space; nobody may use it meanwhile. Returns false
    /// if full compilation is needed; the data is invalid then, as after an Error.
    bool update(Scene::Data& data, const SceneChanges& changes, Warnings& warnings);
    /// Updates the scene's radius; returns false if compile() would choose another origin or scale of render space.
    bool refresh_space();

private:
    Compiler compiler(Warnings& warnings)
    {
        return {scene_, space_, *tables_, warnings, displaced_, light_images_, textured_emissions_};
    }
    bool displacement_unchanged(const SceneChanges& changes, bool other_times) const;
    bool static_shapes_unmoved(const FlattenedScene& now) const;
    void check_moved(const Compiler& c, const FlattenedScene& now, const std::vector<int>& meshes) const;
    std::vector<int> with_moving(std::vector<int> meshes) const;
    bool update_vertices(Compiler& c, const std::vector<int>& meshes, bool other_times);
    bool update_materials(Compiler& c);
    void finish(Scene::Data& data) const;

    const SceneDescription& scene_;
    const std::string camera_;
    const BvhQuality build_;
    RenderSpace space_;
    std::shared_ptr<SceneTables> tables_;
    FlattenedScene occurrences_;
    DisplacedShapes displaced_;
    LightImages light_images_;
    TexturedEmissions textured_emissions_;
    InstancedGeometry contents_;
    std::vector<std::size_t> triangles_;  ///< number of triangles of instanced shapes, by shape
    Fingerprints fingerprints_;
};

}  // namespace fathom
