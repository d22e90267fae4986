// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fathom/scene_builder.h"
#include "fathom/scene_file.h"
#include "options/scene_options.h"
#include "render/scene_setup.h"

namespace fathom::python {

/// A job that several images refer to. It is removed when its scene is compiled anew, since the library can reuse a
/// compiled scene only if no job of it exists.
using SharedJob = std::shared_ptr<std::optional<RenderJob>>;

/// A scene that was completed and compiled for the options of a render.
struct PreparedScene {
    std::vector<std::string> words;  ///< options that it was prepared for
    cli::LoadedScene loaded;         ///< without its description, except for what plans of further images read
    std::optional<EditableScene> edit;
    LitScene lit;
    bool is_edited = false;        ///< `edit` has changed since `lit` was compiled
    std::optional<Camera> camera;  ///< replaces the camera that the scene was compiled for; in world space
    std::vector<std::weak_ptr<std::optional<RenderJob>>> jobs;
    bool is_busy = false;  ///< a thread compiles or renders it; read and written with the interpreter lock

    /// Compiles the changes.
    void compile_again(Warnings& warnings);
    /// The job of the current state.
    SharedJob make_job(const RenderSettings& settings);
};

/// A scene that Python code fills and changes. Changes go to the compiled scene too, as far as the library can compile
/// them alone; other changes make the next render prepare the scene anew.
class Scene {
public:
    explicit Scene(SceneFileContents contents);

    const SceneDescription& description() const { return builder.scene(); }
    /// The description, for changes that need a new preparation.
    SceneDescription& restructure();

    std::shared_ptr<PreparedScene> prepared() const { return prepared_; }
    /// The compiled scene for these options, if there is one.
    std::shared_ptr<PreparedScene> prepared(const std::vector<std::string>& words) const;
    void set_prepared(std::shared_ptr<PreparedScene> scene) { prepared_ = std::move(scene); }
    /// A copy of everything that a preparation starts from, or the original, which leaves this scene empty.
    SceneFileContents contents(bool take);

    void set_transform(int node, const Transform& transform);
    void set_motion(int node, std::vector<NodeKey> keys);
    void set_vertices(int mesh, std::vector<Vec3f> positions, std::vector<Vec3f> normals);
    void set_vertex_motion(int mesh, std::vector<MeshKey> keys);
    void set_material(int material, const std::string& json);
    void set_light(int node, const std::string& json);
    void set_environment(const std::string& json);
    /// Makes the camera, which is in world space, the first one of the scene.
    void set_camera(const std::string& json);
    void set_shape_material(int node, int shape, int material);
    /// Whether the last render compiled the whole scene, not only changes.
    bool was_compiled_whole() const { return !prepared_ || prepared_->edit->recompiled(); }
    /// Adds an image, which invalidates nothing as long as no object refers to it.
    void add_image(const std::string& name, std::vector<std::byte> bytes) { builder.add_image(name, std::move(bytes)); }

    SceneBuilder builder;
    bool is_busy = false;  ///< a thread renders the scene; read and written with the interpreter lock

private:
    /// Applies a change to the compiled scene, if there is one.
    template <class Change>
    void change_prepared(const Change& change)
    {
        if (!prepared_) return;
        change(*prepared_->edit);
        prepared_->is_edited = true;
    }
    template <class Thing>
    void make_movable(std::vector<Thing> SceneDescription::* things, int index);

    SceneFileContents rest_;  ///< without its scene, which the builder holds
    std::shared_ptr<PreparedScene> prepared_;
    bool has_own_camera_ = false;  ///< the first camera is one that set_camera() added
};

/// Marks a scene as busy while it exists. The interpreter lock must be held at both ends.
class BusyScene {
public:
    explicit BusyScene(Scene& scene) : scene_(scene), prepared_(scene.prepared())
    {
        if (scene.is_busy || (prepared_ && prepared_->is_busy))
            throw std::runtime_error("the scene is being rendered; wait until that is done");
        mark(true);
    }
    BusyScene(const BusyScene&) = delete;
    BusyScene& operator=(const BusyScene&) = delete;
    ~BusyScene() { mark(false); }

private:
    void mark(bool busy)
    {
        scene_.is_busy = busy;
        if (prepared_) prepared_->is_busy = busy;
    }

    Scene& scene_;
    std::shared_ptr<PreparedScene> prepared_;
};

}  // namespace fathom::python
