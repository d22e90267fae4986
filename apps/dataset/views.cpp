// SPDX-License-Identifier: Apache-2.0
#include "dataset/views.h"

#include <algorithm>
#include <tuple>

#include "commands/commands.h"
#include "dataset/truth_layers.h"
#include "dataset/view_cameras.h"
#include "render/film_memory.h"
#include "render/image_writer.h"
#include "render/rendering.h"

namespace fathom::cli {

std::vector<Camera> view_cameras(const RenderOptions& o, const LoadedScene& loaded)
{
    if (!o.dataset.cameras.empty()) return read_camera_file(o.dataset.cameras, loaded.size).cameras;
    CameraRing ring{o.dataset.views, o.dataset.placement, 0, 20, o.settings.seed};
    if (o.scene.orbit_deg) std::tie(ring.azimuth_deg, ring.elevation_deg) = *o.scene.orbit_deg;
    Camera lens = world_camera(loaded.description, loaded.camera);
    if (!o.scene.fov_deg) lens.fov_y = Camera().fov_y;
    const Bounds bounds =
        loaded.player ? world_bounds(loaded.description, *loaded.player) : world_bounds(loaded.description);
    return cameras_around(bounds, ring, lens, double(loaded.size.width) / loaded.size.height);
}

namespace {

/// The options with what views do without unless it is asked for: learning for guiding, which starts anew for each view
/// and would take a quarter of the time of a small image, and an estimate of the error, which nothing shows.
RenderOptions view_options(RenderOptions o)
{
    if (!o.settings.guiding) o.settings.guiding = false;
    if (!o.samples.error.goal) o.samples.error.is_estimated = false;
    return o;
}

}  // namespace

ModelViews::ModelViews(const RenderOptions& options, SceneFileContents contents, Reporter& reporter)
    : options_(view_options(options)), loaded_(set_up_scene(std::move(contents), options_.scene))
{
    if (options_.dataset.has_views()) cameras_ = view_cameras(options_, loaded_);
    std::optional<Denoiser> denoiser = open_denoiser(options_.images, options_.settings.threads, reporter);
    plan_.emplace(make_plan(options_, loaded_, std::move(denoiser), nullptr, reporter));
    if (!loaded_.build) loaded_.build = choose_tree_build(options_, *plan_);
    compile(reporter);
    check_film_memory(*plan_);
}

void ModelViews::compile(Reporter& reporter)
{
    edit_.emplace(make_edit(loaded_, options_.scene));
    lit_ = compile_with_light(*edit_, loaded_, options_.scene, plan_->settings, warnings_);
    apply_light(lit_, options_.images, plan_->settings, plan_->write.display, reporter);
    decide_on_caustics(lit_,
                       {options_.scene.file.string(), options_.settings.caustics, light_trial_effort(*plan_, lit_)},
                       plan_->settings, warnings_, reporter);
    for (Camera& camera : cameras_) {
        // Motion is compiled for the shutter of the scene's camera.
        camera.shutter_open = lit_.scene.camera().shutter_open;
        camera.shutter_close = lit_.scene.camera().shutter_close;
    }
    states_[0] = {lit_.scene, scene_objects(description(), lit_.scene.camera().shutter_open)};
    lit_.scene = {};
}

std::size_t ModelViews::count() const
{
    return cameras_.empty() ? std::max<std::size_t>(1, options_.series.frames.size()) : cameras_.size();
}

const ModelViews::State& ModelViews::state(std::size_t i)
{
    if (!cameras_.empty()) i = 0;
    if (const auto known = states_.find(i); known != states_.end()) return known->second;
    states_.erase(states_.begin(), states_.lower_bound(i > 2 ? i - 2 : 0));
    set_time(*edit_, loaded_, options_.scene, double(options_.series.frames[i]) / options_.series.fps);
    State& fresh = states_[i];
    fresh.scene = edit_->compile_bit_exact(warnings_);
    fresh.objects = scene_objects(description(), fresh.scene.camera().shutter_open);
    return fresh;
}

RenderJob ModelViews::job(std::size_t i)
{
    const Scene& scene = state(i).scene;
    return cameras_.empty() ? RenderJob(scene, plan_->settings) : RenderJob(scene, cameras_[i], plan_->settings);
}

std::optional<View> ModelViews::render(std::size_t i, const TruthRequest& request, const std::atomic<bool>& cancel,
                                       Reporter& reporter)
{
    View view;
    view.index = i;
    const RenderJob job = this->job(i);
    Film film(job);
    ErrorWatch watch(plan_->samples.error);
    Rendering rendering(job, plan_->samples.time_s, watch, cancel, reporter);
    rendering.run(film, plan_->samples.range, [](const Film&) {});
    if (rendering.was_interrupted) return {};
    view.summary.render_s = rendering.render_s;
    view.summary.costs = rendering.costs;
    view.summary.samples_per_pixel = film.samples_per_pixel();
    const ImageWriter writer(*plan_, options_.images, reporter);
    view.image = writer.image(film, view.summary);
    view.camera = pinhole_camera(job);
    view.objects = state(i).objects;
    add_truth(view, request);
    add_layers(view.image, view);
    return view;
}

void ModelViews::add_layers(Image& image, const View& view) const
{
    for (Image::Layer& layer : truth_layers(view.truth, options_.dataset.layers))
        image.layers.push_back(std::move(layer));
    if (!view.flow_forward.empty()) image.layers.push_back(flow_layer("truth.flow-forward", view.flow_forward));
    if (!view.flow_backward.empty()) image.layers.push_back(flow_layer("truth.flow-backward", view.flow_backward));
}

void ModelViews::add_truth(View& view, const TruthRequest& request)
{
    const std::size_t i = view.index;
    const RenderJob here = job(i);
    if (request.layers || request.flow) view.truth = trace_ground_truth(here, view.objects);
    if (request.masks) view.masks = trace_masks(here, view.objects);
    if (!request.flow) return;
    if (i > 0) view.flow_backward = optical_flow(view.truth, here, job(i - 1));
    if (i + 1 < count()) view.flow_forward = optical_flow(view.truth, here, job(i + 1));
}

}  // namespace fathom::cli
