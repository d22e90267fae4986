// SPDX-License-Identifier: Apache-2.0
#include "session/job.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstring>

#include "fathom/error.h"
#include "film/film_data.h"

namespace fathom {

namespace {

/// Throws Error for cameras whose numbers overflow floats in render space, where rays would not be finite.
void check_camera(const CameraRecord& record, const Camera& camera)
{
    std::array<float, sizeof(CameraRecord) / sizeof(float)> numbers;
    std::memcpy(numbers.data(), &record, sizeof record);
    // The first number is a flag, which is not checked.
    for (std::size_t i = 1; i < numbers.size(); ++i)
        if (!std::isfinite(numbers[i]) || std::fabs(numbers[i]) > 1e18f)
            throw Error("", fmt::format("camera '{}'", camera.name),
                        "its position, size, aperture, focus distance or shutter is not finite, or far too large for "
                        "this scene");
    const float* f = record.forward;
    if (!(f[0] * f[0] + f[1] * f[1] + f[2] * f[2] > 0.5f))
        throw Error("", fmt::format("camera '{}'", camera.name), "its position and its look_at point are the same");
}

}  // namespace

RenderJob::RenderJob(const Scene& scene, const RenderSettings& settings) : RenderJob(scene, scene.camera(), settings) {}

RenderJob::RenderJob(const Scene& scene, const Camera& camera, const RenderSettings& settings)
{
    check_settings(settings);
    const Scene::Data& compiled = scene.data();
    const CameraRecord record = compiled.camera_record(camera, settings.width, settings.height);
    check_camera(record, camera);
    const SceneTables& tables = *compiled.tables;
    if (tables.moving && (record.shutter_open != tables.shutter_open || record.shutter_close != tables.shutter_close))
        throw Error("", fmt::format("camera '{}'", camera.name),
                    "its shutter times differ from those that the moving scene was compiled for");
    data_ = std::make_shared<const Data>(
        Data{scene,
             camera,
             record,
             {settings, compiled.key(record)},
             settings.guiding ? std::make_unique<TrainedGuiding>() : nullptr,
             settings.light_paths > 0 ? std::make_unique<LearnedLightTargets>() : nullptr,
             settings.gathers_caustics() ? std::make_unique<LearnedCausticRadius>() : nullptr});
}

const Scene& RenderJob::scene() const
{
    return data_->scene;
}
const Camera& RenderJob::camera() const
{
    return data_->camera;
}
const FilmKey& RenderJob::key() const
{
    return data_->key;
}

Film::Film(const RenderJob& job) : Film(job.key()) {}

void Film::reset(const RenderJob& job)
{
    data_->reset(job.key());
}

}  // namespace fathom
