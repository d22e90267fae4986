// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "dataset/views.h"
#include "run.h"
#include "scene.h"

namespace fathom::python {

/// The views of a scene, rendered one by one.
class Views {
public:
    /// Prepares and compiles the scene; it may be changed afterwards.
    ///
    /// words  options of `fathom render`
    /// take   the scene may be taken apart, since it isn't used afterwards
    void prepare(Scene& scene, const std::vector<std::string>& words, bool take);
    std::size_t count() const { return views_->count(); }
    /// Renders view i; indices must ascend from call to call. Returns null if `cancel` became true.
    std::shared_ptr<const cli::View> render(std::size_t i, cli::TruthRequest request, const std::atomic<bool>& cancel);
    const SceneDescription& description() const { return views_->description(); }

    DisplayChoice display;
    std::vector<std::string> notes;  ///< what was added and decided, in sentences
    Warnings warnings;
    bool is_busy = false;  ///< a thread renders; read and written with the interpreter lock

private:
    cli::Reporter reporter_{cli::ReportMode::silent};
    std::unique_ptr<cli::ModelViews> views_;
};

}  // namespace fathom::python
