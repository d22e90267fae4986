// SPDX-License-Identifier: Apache-2.0
#include "run.h"

#include "commands/commands.h"
#include "fathom/error.h"
#include "options/render_words.h"
#include "render/film_memory.h"
#include "render/rendering.h"

namespace fathom::python {

namespace {

/// An image in memory keeps all layers and sums, as EXR files do.
constexpr const char* image_in_memory = "image.exr";

cli::RenderOptions parse_options(const std::vector<std::string>& words, std::vector<std::string>& scene_words)
{
    cli::RenderOptions options;
    std::vector<std::string> all = words;
    all.emplace_back("scene");
    scene_words = cli::parse_render_words(all, options);
    options.images.outputs = {image_in_memory};
    options.writes_images = false;
    options.uses_mpi = false;
    cli::check_options(options);
    return options;
}

/// Returns a description without geometry, which is enough to plan further images.
SceneDescription outline_of(const SceneDescription& scene)
{
    SceneDescription outline;
    outline.file = scene.file, outline.files = scene.files, outline.hints = scene.hints;
    return outline;
}

}  // namespace

WriteOptions DisplayChoice::resolve(const std::vector<std::string>& words) const
{
    std::vector<std::string> ignored;
    const cli::RenderOptions options = parse_options(words, ignored);
    cli::Reporter reporter(cli::ReportMode::silent);
    WriteOptions write = cli::resolve_write_options(options.images, hints, reporter);
    if (exposure_ev && !options.images.exposure_ev) write.display.exposure_ev = *exposure_ev;
    return write;
}

void Run::start(Scene& scene, const std::vector<std::string>& words, bool take, const Film* resume,
                const std::atomic<bool>& cancel, const AfterPass& after_pass)
{
    const double start_s = cli::seconds_since_start();
    reporter_.forward({.note = [this](const std::string& note) { notes.push_back(note); },
                       .error = {},
                       .warnings =
                           [this](const Warnings& more) {
                               for (const auto& [text, count] : more.counts()) warnings.add(text, count);
                           }});
    std::vector<std::string> scene_words;
    options_ = parse_options(words, scene_words);
    options_.scene.file = scene.description().file;
    const ThreadLimit limit = cli::limit_threads(options_.settings, reporter_);
    prepare(scene, scene_words, take);
    cli::check_film_memory(*plan_);
    summary_.build_s = cli::seconds_since_start() - start_s;
    planned_samples = plan_->samples.time_s ? 0 : double(plan_->samples.range.second - plan_->samples.range.first);
    job_ = prepared_->make_job(plan_->settings);
    film = std::make_shared<FilmBox>(FilmBox{Film(**job_), {}, plan_->write});
    if (resume) film->film.merge(*resume);
    std::optional<double> end_s = plan_->samples.time_s;
    if (end_s) *end_s += start_s;
    sample(plan_->samples.range, end_s, cancel, after_pass);
}

void Run::prepare(Scene& scene, const std::vector<std::string>& scene_words, bool take)
{
    std::optional<Denoiser> denoiser = cli::open_denoiser(options_.images, options_.settings.threads, reporter_);
    prepared_ = scene.prepared(scene_words);
    const bool is_new = !prepared_;
    if (is_new) {
        scene.set_prepared(nullptr);
        prepared_ = std::make_shared<PreparedScene>();
        prepared_->words = scene_words;
        prepared_->loaded = cli::set_up_scene(scene.contents(take), options_.scene);
    }
    cli::LoadedScene& loaded = prepared_->loaded;
    plan_.emplace(cli::make_plan(options_, loaded, std::move(denoiser), nullptr, reporter_));
    if (is_new)
        compile_first(*prepared_);
    else if (prepared_->is_edited)
        prepared_->compile_again(warnings);
    if (!options_.dataset.layers.empty()) plan_->objects = scene_objects(prepared_->edit->description());
    display.hints = loaded.description.hints;
    display.exposure_ev = prepared_->lit.exposure_ev;
    if (!take) scene.set_prepared(prepared_);
    cli::apply_light(prepared_->lit, options_.images, plan_->settings, plan_->write.display, reporter_);
    cli::decide_on_caustics(
        prepared_->lit,
        {options_.scene.file.string(), options_.settings.caustics, cli::light_trial_effort(*plan_, prepared_->lit)},
        plan_->settings, warnings, reporter_);
}

void Run::compile_first(PreparedScene& prepared)
{
    cli::LoadedScene& loaded = prepared.loaded;
    if (!loaded.build) loaded.build = cli::choose_tree_build(options_, *plan_);
    SceneDescription outline = outline_of(loaded.description);
    prepared.edit.emplace(cli::make_edit(loaded, options_.scene));
    loaded.description = std::move(outline);
    prepared.lit = cli::compile_with_light(*prepared.edit, loaded, options_.scene, plan_->settings, warnings);
}

void Run::more(std::optional<std::uint64_t> samples, std::optional<double> time_s, const std::atomic<bool>& cancel,
               const AfterPass& after_pass)
{
    if (!job_ || !*job_)
        throw Error("", "", "no more samples can be added to this image: its scene has changed or was forgotten");
    const ThreadLimit limit = cli::limit_threads(options_.settings, reporter_);
    const std::vector<SampleRange>& done = film->film.samples();
    const std::uint64_t end = done.empty() ? 0 : done.back().second;
    const SampleRange wanted{end, samples ? std::min(end + *samples, max_samples) : max_samples};
    if (time_s) *time_s += cli::seconds_since_start();
    sample(wanted, time_s, cancel, after_pass);
}

void Run::sample(SampleRange wanted, std::optional<double> time_s, const std::atomic<bool>& cancel,
                 const AfterPass& after_pass)
{
    cli::ErrorWatch watch(options_.samples.error);
    cli::Rendering rendering(**job_, time_s, watch, cancel, reporter_);
    rendering.run(film->film, wanted, after_pass);
    summary_.render_s += rendering.render_s;
    summary_.costs += rendering.costs;
    summary_.samples_per_pixel = film->film.samples_per_pixel();
    cli::ImageWriter writer(*plan_, options_.images, reporter_);
    writer.add_ground_truth(**job_);
    image_ = std::make_shared<const Image>(writer.image(film->film, summary_));
    film->attributes = image_->attributes;
    if (!film->film.samples().empty()) writer.report_noise(film->film, {watch, rendering.end()});
}

void Run::forget_scene()
{
    job_.reset();
    plan_.reset();
    prepared_.reset();
    film.reset();
}

}  // namespace fathom::python
