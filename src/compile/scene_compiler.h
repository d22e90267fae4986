#pragma once
#include <memory>
#include <string>
#include <vector>

#include "compile/compiler.h"
#include "compile/fingerprint.h"
#include "compile/scene_data.h"
#include "scene/check.h"

namespace fathom {

/// What is no longer as it was when a scene was compiled.
struct SceneChanges {
    SceneParts parts;          ///< nodes: elsewhere; meshes: movable ones with other vertices
    bool environment = false;  ///< not its picture
};

/// Makes a scene of a description, which must stay where it is, and brings it up to date.
class SceneCompiler {
public:
    SceneCompiler(const SceneDescription& scene, std::string camera, TreeBuild build)
        : scene_(scene), camera_(std::move(camera)), build_(build)
    {
    }

    const std::string& camera() const { return camera_; }
    /// Throws Error as Scene::compile.
    std::shared_ptr<Scene::Data> compile(Warnings& warnings);
    /// Changes what compile() gave, which nobody may look at meanwhile, to what it would give now, in the same render
    /// space. False if that takes compiling all of it; it is then spoilt, as after an Error.
    bool update(Scene::Data& data, const SceneChanges& changes, Warnings& warnings);
    /// Takes the radius that the scene now has; false if compile() would also put it elsewhere, or scale it otherwise.
    bool refresh_space();

private:
    Compiler compiler(Warnings& warnings) { return {scene_, space_, *tables_, warnings, displaced_, light_images_}; }
    bool keeps_displaced(const SceneChanges& changes, bool other_times) const;
    bool keeps_places(const FlattenedScene& now) const;
    void check_moved(const Compiler& c, const FlattenedScene& now, const std::vector<int>& meshes) const;
    std::vector<int> with_moving(std::vector<int> meshes) const;
    bool update_vertices(Compiler& c, const std::vector<int>& meshes, bool other_times);
    bool update_materials(Compiler& c);
    void finish(Scene::Data& data) const;

    const SceneDescription& scene_;
    const std::string camera_;
    const TreeBuild build_;
    RenderSpace space_;
    std::shared_ptr<SceneTables> tables_;
    FlattenedScene occurrences_;
    DisplacedShapes displaced_;
    LightImages light_images_;
    InstancedGeometry contents_;
    std::vector<std::size_t> triangles_;  ///< of shapes that instances place, by shape
    Fingerprints fingerprints_;
};

}  // namespace fathom
