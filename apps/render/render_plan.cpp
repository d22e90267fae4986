// SPDX-License-Identifier: Apache-2.0
#include "render/render_plan.h"

#include <fmt/format.h>
#include <algorithm>

#include "distributed/ranks/ranks.h"
#include "fathom/memory.h"
#include "fathom/scene_digest.h"
#include "render/film_memory.h"
#include "render/series.h"

namespace fathom::cli {

namespace {

/// Adds the layers that guide the denoiser.
void add_denoiser_layers(RenderSettings& settings)
{
    for (Aov aov : {Aov::albedo, Aov::normal})
        if (std::find(settings.aovs.begin(), settings.aovs.end(), aov) == settings.aovs.end())
            settings.aovs.push_back(aov);
}

RenderSettings plan_settings(const RenderOptions& o, const LoadedScene& scene, bool is_denoised)
{
    RenderSettings settings = resolve_settings(o.settings, scene.description.hints, o.scene.file.string());
    settings.width = scene.size.width;
    settings.height = scene.size.height;
    settings.crop = o.film.crop;
    settings.aovs = o.film.aovs;
    settings.measure_stages = o.stats;
    settings.error_probes = o.samples.error.is_estimated && !o.only_sample;
    if (is_denoised) add_denoiser_layers(settings);
    const std::string size = fmt::format("{}x{}", settings.width, settings.height);
    if (o.film.crop && (o.film.crop->x1 > settings.width || o.film.crop->y1 > settings.height))
        throw UsageError(fmt::format("--crop: the image is {}", size));
    if (o.only_sample && (o.only_sample->x >= settings.width || o.only_sample->y >= settings.height))
        throw UsageError(fmt::format("--only-sample: the image is {}", size));
    return settings;
}

std::vector<MemoryEstimate> plan_film_memory(const RenderPlan& plan)
{
    FilmUse use;
    use.has_checkpoint = !plan.checkpoint.file.empty();
    use.is_mergeable = plan.film.mergeable && writes_exr(plan.images);
    use.extra_channels =
        (plan.film.aov_variance ? 3 : 0) + (plan.film.aov_error ? 3 : 0) + (plan.film.aov_samples ? 1 : 0);
    return film_memory(plan.settings, use, plan.images);
}

/// Memory for scene and film with a BVH of this quality.
std::vector<MemoryEstimate> plan_memory(const RenderOptions& o, const RenderPlan& plan, BvhQuality build)
{
    std::vector<MemoryEstimate> needs = estimate_memory(plan.scene.description, build);
    if (!o.only_sample)
        for (MemoryEstimate& need : plan_film_memory(plan)) needs.push_back(std::move(need));
    return needs;
}

/// Whether the plan has this number of samples over all pixels, and per pixel, or this time. Films that are merged must
/// agree, so they always count as long.
bool is_long(const RenderPlan& plan, double samples, double samples_per_pixel, double time_s)
{
    if (plan.film.mergeable || plan.samples.is_partial || !plan.checkpoint.file.empty()) return true;
    if (plan.samples.time_s) return *plan.samples.time_s >= time_s;
    if (!plan.samples.planned) return true;
    const double planned = double(*plan.samples.planned);
    return planned >= samples_per_pixel && planned * plan.settings.width * plan.settings.height >= samples;
}

/// Whether guiding is worth the time that learning takes.
bool guiding_pays(const RenderPlan& plan)
{
    return is_long(plan, 1 << 22, 8, 10);
}

/// The BVH quality that finishes soonest. High quality takes about 1.5 us more to build for each triangle, and saves
/// about 5 % of a sample's microsecond (docs/performance.md).
BvhQuality fastest_build(const SceneDescription& scene, double samples)
{
    constexpr double min_samples_per_triangle = 32;
    // Displacement decides the number of triangles only while compiling.
    for (const Material& material : scene.materials)
        if (material.displacement.height.value != 0) return BvhQuality::standard;
    double triangles = 0;
    for (const Mesh& mesh : scene.meshes) triangles += double(mesh.indices.size()) / 3;
    return triangles > 0 && samples >= min_samples_per_triangle * triangles ? BvhQuality::high : BvhQuality::standard;
}

/// Rough number of samples that one BVH is used for. An animation rebuilds it for each frame.
double samples_per_build(const RenderOptions& o, const RenderPlan& plan)
{
    constexpr double samples_per_s = 1e6;
    if (o.only_sample || (o.series.frames.size() > 1 && o.series.turntable == 0)) return 1;
    if (plan.samples.time_s) return *plan.samples.time_s * samples_per_s;
    const double per_pixel = double(plan.samples.range.second - plan.samples.range.first) *
                             double(std::max<std::uint64_t>(1, o.series.turntable));
    const Crop crop = plan.settings.rendered_pixels();
    return per_pixel * double(crop.x1 - crop.x0) * double(crop.y1 - crop.y0);
}

/// Whether the image is denoised. Rank 0 decides, since it alone opens the denoiser.
bool agree_on_denoising(bool has_denoiser, Ranks* ranks)
{
    return ranks ? !ranks->agree(has_denoiser ? "denoised" : "").empty() : has_denoiser;
}

}  // namespace

RenderPlan make_plan(const RenderOptions& o, const LoadedScene& loaded, std::optional<Denoiser> denoiser, Ranks* ranks,
                     Reporter& reporter)
{
    const RenderHints& hints = loaded.description.hints;
    const std::string file = o.scene.file.string();
    RenderPlan plan{loaded, o.scene, o.images, o.dataset};
    plan.settings = plan_settings(o, loaded, agree_on_denoising(denoiser.has_value(), ranks));
    plan.write = resolve_write_options(o.images, hints, reporter);
    plan.film = o.film;
    plan.checkpoint = o.checkpoint;
    plan.denoiser = std::move(denoiser);
    plan.ranks = ranks;
    plan.has_guiding_option = o.settings.guiding.has_value();
    plan.stats = o.stats;
    check_memory(file, plan_memory(o, plan, loaded.build.value_or(BvhQuality::standard)));
    if (o.dataset.format == DatasetFormat::none) check_outputs(o, plan.settings.width, plan.settings.height);
    if (!o.reference.file.empty()) plan.reference.emplace(o.reference, plan.settings.width, plan.settings.height);
    plan.samples = resolve_samples(o.samples, hints, file, default_render_samples);
    if (!o.checkpoint.file.empty()) plan.scene_digest = scene_digest(loaded.description);
    if (!plan.has_guiding_option) plan.settings.guiding = guiding_pays(plan);
    report_added(loaded, reporter);
    return plan;
}

std::optional<TrialEffort> light_trial_effort(const RenderPlan& plan, const LitScene& lit)
{
    if (is_long(plan, 1 << 25, 8, 30)) return TrialEffort::full;
    // Smooth glass promises more gain, so that renders of half the length are worth a trial.
    const double length = lit.has_smooth_glass ? 0.5 : 1;
    if (is_long(plan, length * (1 << 21), 8, length * 2)) return TrialEffort::quick;
    return {};
}

void check_film_memory(const RenderPlan& plan)
{
    check_memory(plan.scene_options.file.string(), plan_film_memory(plan));
}

BvhQuality choose_tree_build(const RenderOptions& o, const RenderPlan& plan)
{
    const BvhQuality build = fastest_build(plan.scene.description, samples_per_build(o, plan));
    double bytes = 0;
    for (const MemoryEstimate& need : plan_memory(o, plan, build)) bytes += need.bytes;
    return bytes <= double(available_memory_bytes()) ? build : BvhQuality::standard;
}

void announce_plan(const RenderPlan& plan, Reporter& reporter)
{
    if (plan.samples.is_default)
        reporter.note(
            fmt::format("{} samples per pixel by default; choose with --spp or --time", *plan.samples.planned));
    if (plan.samples.is_partial && !plan.film.mergeable && plan.checkpoint.file.empty())
        reporter.note(fmt::format("the samples of {} can't be merged later: only EXR keeps their sums, add -o FILE.exr",
                                  plan.samples.part ? "--part" : "--samples"));
    if (plan.settings.clamp_indirect)
        reporter.note(fmt::format("biased: indirect light is clamped at {:g}", *plan.settings.clamp_indirect));
    if (const std::string warning = kernel_choice().warning; !warning.empty()) reporter.note(warning);
}

}  // namespace fathom::cli
