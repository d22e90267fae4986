// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>

#include "dataset/dataset.h"
#include "dataset/view_cameras.h"
#include "render/series.h"

namespace fathom::cli {

namespace {

bool wants_flow(const DatasetOptions& o)
{
    return std::find(o.layers.begin(), o.layers.end(), TruthLayer::flow) != o.layers.end();
}

void check_views(const RenderOptions& o)
{
    const DatasetOptions& d = o.dataset;
    if (d.is_placed && d.views == 0) throw UsageError("--on: says where --views N places cameras; add --views");
    if (d.views > 0 && !d.cameras.empty()) throw UsageError("--views, --cameras: give one of them");
    if (!d.has_views()) return;
    if (!o.series.frames.empty() || o.series.turntable > 0)
        throw UsageError("--views, --cameras: show one moment from many places; leave out --frames and --turntable");
    if (!o.scene.camera.empty() || o.scene.look_from || o.scene.look_at || o.scene.up)
        throw UsageError("--views, --cameras: place the camera; leave out --camera, --look-from, --look-at and --up");
    if (!d.cameras.empty() && (o.scene.fov_deg || o.scene.orbit_deg))
        throw UsageError("--cameras: the file says where cameras are; leave out --fov, --orbit and --view");
}

/// The size of the images of --cameras, and the camera by whose image of the whole model its lighting is judged.
void set_view_options(RenderOptions& o)
{
    if (!o.dataset.cameras.empty() && !o.scene.size)
        o.scene.size = read_camera_file(o.dataset.cameras, {}).size.value_or(Size{800, 800});
    if (!o.scene.orbit_deg) o.scene.orbit_deg = {30, 20};
}

/// Numbers the images of --views and --cameras without --dataset.
void number_views(RenderOptions& o)
{
    const std::uint64_t count =
        o.dataset.views > 0 ? o.dataset.views : read_camera_file(o.dataset.cameras, o.scene.size).cameras.size();
    for (std::uint64_t i = 0; i < count; ++i) o.series.frames.push_back(i);
    check_series(o, o.dataset.views > 0 ? "--views" : "--cameras");
}

void check_images(RenderOptions& o)
{
    if (!o.dataset.models.empty()) throw UsageError("--models: renders data sets; add --dataset FORMAT -o FOLDER");
    if (wants_flow(o.dataset))
        throw UsageError("--ground-truth: flow needs further images of the scene; add --dataset FORMAT");
    if (o.dataset.has_views()) number_views(o);
}

void check_folder(const RenderOptions& o)
{
    if (o.images.outputs.size() != 1) throw UsageError("--dataset: name the folder for its files with -o FOLDER");
    if (o.images.outputs[0] == "/dev/stdout") throw UsageError("--dataset: a folder can't go to the standard output");
    if (!o.images.format.empty())
        throw UsageError("--dataset: decides the formats of images; leave out --output-format");
}

void check_models(const RenderOptions& o)
{
    if (!o.dataset.models.empty() && !o.scene.file.empty())
        throw UsageError(fmt::format("--models: takes the place of SCENE; leave out {}", o.scene.file.string()));
    if (o.samples.part && o.dataset.models.empty())
        throw UsageError("--part: renders a part of the models of --models, not of one data set");
}

void check_rendering(const RenderOptions& o)
{
    if (o.samples.time_s)
        throw UsageError("--dataset: choose the samples of each view with --spp or --error; leave out --time");
    if (o.samples.range || o.film.mergeable || !o.checkpoint.file.empty() || o.only_sample || o.watches)
        throw UsageError(
            "--dataset: renders whole images; leave out --samples, --mergeable, --checkpoint, --only-sample and "
            "--watch");
}

}  // namespace

void check_dataset(RenderOptions& o)
{
    check_views(o);
    if (o.dataset.has_views()) set_view_options(o);
    if (o.dataset.format == DatasetFormat::none) return check_images(o);
    check_folder(o);
    check_models(o);
    check_rendering(o);
    if (!o.dataset.has_views() && o.series.frames.empty())
        throw UsageError("--dataset: choose its views with --views N, --cameras FILE or --frames A:B");
    // A floor would be an object among the others, and a backdrop would be learned as part of the model.
    if (o.scene.ground == GroundChoice::automatic) o.scene.ground = GroundChoice::none;
    const bool has_alpha = o.dataset.format != DatasetFormat::bop && o.dataset.format != DatasetFormat::coco;
    if (!o.settings.background && has_alpha) {
        o.settings.transparent = true;
        o.settings.background = Color{0, 0, 0};
    }
}

}  // namespace fathom::cli
