// SPDX-License-Identifier: Apache-2.0
#include "render/image_writer.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "dataset/truth_layers.h"
#include "options/sample_plan.h"
#include "render/checkpoint.h"
#include "render/image_files.h"
#include "report/film_info.h"

namespace fathom::cli {

namespace {

/// Reports fireflies if few samples make much of the noise.
void report_fireflies(const Film& film, const DisplayTransform& display, Reporter& reporter)
{
    constexpr double min_share_of_noise = 0.2;
    constexpr double clamp_over_white = 10;
    const Film::Fireflies fireflies = film.fireflies();
    if (fireflies.noise < min_share_of_noise || film.key().settings.clamp_indirect) return;
    reporter.fireflies(fireflies, clamp_over_white * std::exp2(-display.exposure_ev));
}

/// Adds the denoised layer, and removes the layers that only guide the denoiser unless they are `wanted`.
void add_denoised(Image& image, const Denoiser& denoiser, const std::vector<Aov>& wanted)
{
    denoiser.add_to(image);
    std::erase_if(image.layers, [&](const Image::Layer& layer) {
        const auto is_extra = [&](Aov aov, const char* name) {
            return layer.name == name && std::find(wanted.begin(), wanted.end(), aov) == wanted.end();
        };
        return is_extra(Aov::albedo, "albedo") || is_extra(Aov::normal, "normal");
    });
}

std::map<std::string, std::string> image_attributes(const RenderPlan& plan, const Film& film, const Summary& summary)
{
    const RenderSettings& s = plan.settings;
    std::map<std::string, std::string> attributes = {
        {"fathom.version", FATHOM_VERSION},
        {"fathom.scene", plan.scene_options.file.string()},
        {"fathom.camera", plan.scene.camera},
        {"fathom.seed", fmt::format("{}", s.seed)},
        {"fathom.samples", sample_ranges_text(film.samples())},
        {"fathom.samples_per_pixel", fmt::format("{}", film.samples_per_pixel())},
        {"fathom.dropped_samples", fmt::format("{}", film.invalid_samples())},
        {"fathom.filter", filter_names[std::size_t(s.filter)]},
        {"fathom.max_depth", s.max_depth < 0 ? "none" : fmt::format("{}", s.max_depth)},
        {"fathom.roulette_depth", fmt::format("{}", s.roulette_depth)},
        {"fathom.light_sampling", s.light_sampling ? "on" : "off"},
        {"fathom.guiding", s.guiding ? "on" : "off"},
        {"fathom.light_paths", fmt::format("{:g}", s.light_paths)},
        {"fathom.merge_caustics", s.gathers_caustics() ? "on" : "off"},
        {"fathom.crop", s.crop ? fmt::format("{},{},{},{}", s.crop->x0, s.crop->y0, s.crop->x1, s.crop->y1) : "none"},
        {"fathom.clamp_indirect", s.clamp_indirect ? fmt::format("{:g}", *s.clamp_indirect) : "none"},
        {"fathom.simd", simd_name()},
        {"fathom.rays", fmt::format("{}", summary.costs.all_rays())},
        {"fathom.load_s", fmt::format("{:.3f}", summary.load_s)},
        {"fathom.build_s", fmt::format("{:.3f}", summary.build_s)},
        {"fathom.render_s", fmt::format("{:.3f}", summary.render_s)}};
    if (plan.samples.planned) attributes[planned_samples_attribute] = fmt::format("{}", *plan.samples.planned);
    if (plan.samples.part) attributes[planned_parts_attribute] = fmt::format("{}", plan.samples.part->count);
    std::vector<std::string> layers;
    if (s.alpha) layers.emplace_back("A");
    if (plan.film.aov_variance) layers.emplace_back("variance");
    if (plan.film.aov_samples) layers.emplace_back("samples");
    if (plan.film.aov_error) layers.emplace_back("error");
    if (!layers.empty()) attributes[wanted_layers_attribute] = fmt::format("{}", fmt::join(layers, ","));
    return attributes;
}

/// Adds noise and speed of a part, which `fathom status` sums over all parts.
void add_part_progress(const Film& film, double samples_per_s, std::map<std::string, std::string>& attributes)
{
    if (samples_per_s > 0) attributes[samples_per_s_attribute] = fmt::format("{:.6g}", samples_per_s);
    if (film.samples_per_pixel() < 2) return;
    const FilmNoise noise = film_noise(film);
    if (noise.mean > 0) attributes[noise_attribute] = fmt::format("{:.6g}", noise.standard_error / noise.mean);
}

/// Reports the error of the image if it was to be estimated and the film has enough samples.
void report_error(const Film& film, const ErrorEnd& end, Reporter& reporter)
{
    const ErrorWatch& watch = end.watch;
    const std::optional<ImageError> error = watch.final_error(film);
    if (!error) return;
    ErrorReport report{*error, watch.options().metric, film.samples_per_pixel()};
    report.after_twice = watch.forecast(film, error->error, 2);
    report.goal = watch.options().goal;
    report.is_reached = watch.is_reached();
    report.end = end.end;
    if (watch.expected_samples() > report.samples) report.needed = watch.expected_samples();
    reporter.image_error(report);
}

void warn_about_dropped_samples(const Film& film, Reporter& reporter)
{
    if (film.invalid_samples() == 0) return;
    Warnings dropped;
    std::string text = fmt::format("{} samples were NaN or infinite; they count as black, which biases the image",
                                   film.invalid_samples());
    if (const auto place = film.invalid_sample())
        text += fmt::format(" (--only-sample {},{},{} replays one)", place->x, place->y, place->sample);
    dropped.add(text);
    reporter.warnings(dropped);
}

}  // namespace

ImageWriter::ImageWriter(const RenderPlan& plan, const ImageOptions& files, Reporter& reporter)
    : plan_(plan), files_(files), reporter_(reporter)
{
}

void ImageWriter::add_ground_truth(const RenderJob& job)
{
    if (!plan_.dataset.layers.empty())
        truth_ = truth_layers(trace_ground_truth(job, plan_.objects), plan_.dataset.layers);
}

Image ImageWriter::image(const Film& film, const Summary& summary) const
{
    Image image = film.image(plan_.settings.alpha, plan_.film.aov_variance);
    if (plan_.film.aov_error) image.layers.push_back(standard_error(film));
    if (plan_.film.aov_samples) image.layers.push_back(sample_count_layer(film));
    image.attributes = image_attributes(plan_, film, summary);
    if (plan_.denoiser) add_denoised(image, *plan_.denoiser, plan_.film.aovs);
    image.layers.insert(image.layers.end(), truth_.begin(), truth_.end());
    return image;
}

bool ImageWriter::write(const Film& film, const Summary& summary)
{
    return write_images(files_, image(film, summary), plan_.film.mergeable ? &film : nullptr, plan_.write, reporter_);
}

bool ImageWriter::is_like_reference(const Film& film, const Summary& summary) const
{
    if (!plan_.reference) return true;
    const Comparison comparison = plan_.reference->compare_with(image(film, summary), film, plan_.write);
    reporter_.comparison(comparison);
    return comparison.difference.is_same();
}

std::map<std::string, std::string> ImageWriter::checkpoint_attributes(const Film& film, const Summary& summary,
                                                                      double samples_per_s) const
{
    std::map<std::string, std::string> attributes = image_attributes(plan_, film, summary);
    if (plan_.samples.part) add_part_progress(film, samples_per_s, attributes);
    attributes[parts_attribute] = plan_.scene_digest;
    return attributes;
}

void ImageWriter::report_noise(const Film& film, const ErrorEnd& error)
{
    report_error(film, error, reporter_);
    if (!plan_.denoiser) report_fireflies(film, plan_.write.display, reporter_);
    warn_about_dropped_samples(film, reporter_);
}

void ImageWriter::report_result(const Film& film, const Summary& summary, bool was_interrupted, const ErrorEnd& error)
{
    report_noise(film, error);
    if (was_interrupted)
        reporter_.note(fmt::format("interrupted: the image has {} samples per pixel", film.samples_per_pixel()));
    reporter_.summary(summary);
    if (plan_.stats) reporter_.cost_sheet(summary);
}

}  // namespace fathom::cli
