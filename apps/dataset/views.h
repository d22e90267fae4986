// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fathom/ground_truth.h"
#include "render/render_plan.h"

namespace fathom::cli {

/// Cameras of --views or --cameras.
std::vector<Camera> view_cameras(const RenderOptions& options, const LoadedScene& loaded);

/// Ground truth that a data set needs of each view.
struct TruthRequest {
    bool layers = false, masks = false, flow = false;
};

/// A rendered view of a data set.
struct View {
    std::size_t index = 0;
    Image image;  ///< as `fathom render` writes it, with the ground truth that --ground-truth asks for
    PinholeCamera camera;
    GroundTruth truth;  ///< empty unless requested, as are masks and flow
    std::vector<ObjectMask> masks;
    std::vector<Vec2f> flow_forward, flow_backward;  ///< to the next and the previous view, where there is one
    std::vector<SceneObject> objects;                ///< at the time of the view
    Summary summary;
};

/// The views of a model: cameras around it, cameras of a file, or the frames of its animation. Reading, compiling and
/// rendering may happen on different threads, one after the other.
class ModelViews {
public:
    /// Prepares and compiles a model. Throws Error and UsageError.
    ///
    /// options   options of `fathom render`, which have been checked
    /// contents  the model
    /// reporter  receives what was added and decided
    ModelViews(const RenderOptions& options, SceneFileContents contents, Reporter& reporter);
    ModelViews(const ModelViews&) = delete;
    ModelViews& operator=(const ModelViews&) = delete;

    std::size_t count() const;
    const RenderPlan& plan() const { return *plan_; }
    const SceneDescription& description() const { return edit_->description(); }
    const Warnings& warnings() const { return warnings_; }
    void add_warning(const std::string& text, std::size_t times) { warnings_.add(text, times); }
    /// Renders view i; indices must ascend from call to call. Returns nothing if `cancel` became true.
    std::optional<View> render(std::size_t i, const TruthRequest& request, const std::atomic<bool>& cancel,
                               Reporter& reporter);
    /// The job of view i.
    RenderJob job(std::size_t i);

private:
    /// The scene at the time of a view.
    struct State {
        Scene scene;
        std::vector<SceneObject> objects;
    };

    void compile(Reporter& reporter);
    const State& state(std::size_t i);
    void add_truth(View& view, const TruthRequest& request);
    void add_layers(Image& image, const View& view) const;

    RenderOptions options_;
    LoadedScene loaded_;
    std::optional<RenderPlan> plan_;
    std::optional<EditableScene> edit_;
    LitScene lit_;
    std::vector<Camera> cameras_;          ///< empty: the frames of --frames by the scene's camera
    std::map<std::size_t, State> states_;  ///< of the frames around the current one; a single one without --frames
    Warnings warnings_;
};

}  // namespace fathom::cli
