// SPDX-License-Identifier: Apache-2.0
#include "views.h"

#include "options/render_words.h"

namespace fathom::python {

namespace {

cli::RenderOptions parse_view_options(const std::vector<std::string>& words)
{
    cli::RenderOptions options;
    std::vector<std::string> all = words;
    all.emplace_back("scene");
    cli::parse_render_words(all, options);
    // Arrays of views are those of the NPZ layout; no file is written.
    options.dataset.format = cli::DatasetFormat::npz;
    options.images.outputs = {"views"};
    options.writes_images = false;
    options.uses_mpi = false;
    cli::check_options(options);
    return options;
}

}  // namespace

void Views::prepare(Scene& scene, const std::vector<std::string>& words, bool take)
{
    reporter_.forward(
        {.note = [this](const std::string& note) { notes.push_back(note); }, .error = {}, .warnings = {}});
    cli::RenderOptions options = parse_view_options(words);
    options.scene.file = scene.description().file;
    const ThreadLimit limit = cli::limit_threads(options.settings, reporter_);
    SceneFileContents contents = scene.contents(take);
    display.hints = contents.scene.hints;
    views_ = std::make_unique<cli::ModelViews>(options, std::move(contents), reporter_);
    display.exposure_ev = views_->plan().write.display.exposure_ev;
    warnings = views_->warnings();
}

std::shared_ptr<const cli::View> Views::render(std::size_t i, cli::TruthRequest request,
                                               const std::atomic<bool>& cancel)
{
    std::optional<cli::View> view = views_->render(i, request, cancel, reporter_);
    return view ? std::make_shared<const cli::View>(std::move(*view)) : nullptr;
}

}  // namespace fathom::python
