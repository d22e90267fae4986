#include "render/image_writer.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "options/sample_plan.h"
#include "render/checkpoint.h"
#include "report/film_info.h"

namespace fathom::cli {

namespace {

/// Tells what the picture's noise is made of where few samples make much of it, and what hides them.
void tell_fireflies(const Film& film, const DisplayTransform& display, Reporter& reporter)
{
    constexpr double much = 0.2;
    /// Times what is shown as white.
    constexpr double limit = 10;
    const Film::Fireflies fireflies = film.fireflies();
    if (fireflies.noise < much || film.key().settings.clamp_indirect) return;
    reporter.fireflies(fireflies, limit * std::exp2(-display.exposure_ev));
}

/// The denoised picture, as a layer; its aids go unless they are `wanted`.
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

std::map<std::string, std::string> attributes(const RenderOptions& o, const RenderPlan& plan, const Film& film,
                                              const Summary& summary)
{
    const RenderSettings& s = plan.settings;
    std::map<std::string, std::string> said = {
        {"fathom.version", FATHOM_VERSION},
        {"fathom.scene", o.scene.file.string()},
        {"fathom.camera", plan.scene.camera},
        {"fathom.seed", fmt::format("{}", s.seed)},
        {"fathom.samples", text_of(film.samples())},
        {"fathom.samples_per_pixel", fmt::format("{}", film.samples_per_pixel())},
        {"fathom.dropped_samples", fmt::format("{}", film.dropped_samples())},
        {"fathom.filter", filter_names[std::size_t(s.filter)]},
        {"fathom.max_depth", s.max_depth < 0 ? "none" : fmt::format("{}", s.max_depth)},
        {"fathom.roulette_depth", fmt::format("{}", s.roulette_depth)},
        {"fathom.light_sampling", s.light_sampling ? "on" : "off"},
        {"fathom.guiding", s.guiding ? "on" : "off"},
        {"fathom.crop", s.crop ? fmt::format("{},{},{},{}", s.crop->x0, s.crop->y0, s.crop->x1, s.crop->y1) : "none"},
        {"fathom.clamp_indirect", s.clamp_indirect ? fmt::format("{:g}", *s.clamp_indirect) : "none"},
        {"fathom.simd", simd_name()},
        {"fathom.rays", fmt::format("{}", summary.costs.all_rays())},
        {"fathom.load_s", fmt::format("{:.3f}", summary.load_s)},
        {"fathom.build_s", fmt::format("{:.3f}", summary.build_s)},
        {"fathom.render_s", fmt::format("{:.3f}", summary.render_s)}};
    if (plan.samples) said[planned_samples_attribute] = fmt::format("{}", *plan.samples);
    if (o.part) said[planned_parts_attribute] = fmt::format("{}", o.part->count);
    std::vector<std::string> layers;
    if (s.alpha) layers.emplace_back("A");
    if (o.aov_variance) layers.emplace_back("variance");
    if (o.aov_samples) layers.emplace_back("samples");
    if (!layers.empty()) said[wanted_layers_attribute] = fmt::format("{}", fmt::join(layers, ","));
    return said;
}

/// What is told of a part to those who look at all of them: how noisy it is, and how fast it goes.
void add_progress(const Film& film, double samples_per_s, std::map<std::string, std::string>& said)
{
    if (samples_per_s > 0) said[samples_per_s_attribute] = fmt::format("{:.6g}", samples_per_s);
    if (film.samples_per_pixel() < 2) return;
    const FilmNoise noise = noise_of(film);
    if (noise.mean > 0) said[noise_attribute] = fmt::format("{:.6g}", noise.standard_error / noise.mean);
}

void warn_of_dropped(const Film& film, Reporter& reporter)
{
    if (film.dropped_samples() == 0) return;
    Warnings dropped;
    std::string text = fmt::format("{} samples were no number or infinite; they count as black, which is a bias",
                                   film.dropped_samples());
    if (const auto place = film.dropped_sample())
        text += fmt::format(" (--only-sample {},{},{} replays one)", place->x, place->y, place->sample);
    dropped.add(text);
    reporter.warnings(dropped);
}

}  // namespace

PictureWriter::PictureWriter(const RenderOptions& options, const RenderPlan& plan, const PictureOptions& files,
                             Reporter& reporter)
    : o_(options), plan_(plan), files_(files), reporter_(reporter)
{
}

bool PictureWriter::write(const Film& film, const Summary& summary)
{
    Image image = film.image(plan_.settings.alpha, o_.aov_variance);
    if (o_.aov_samples) image.layers.push_back(sample_count_layer(film));
    image.attributes = attributes(o_, plan_, film, summary);
    if (plan_.denoiser) add_denoised(image, *plan_.denoiser, o_.aovs);
    return write_pictures(files_, image, o_.mergeable ? &film : nullptr, plan_.write, reporter_);
}

std::map<std::string, std::string> PictureWriter::state_attributes(const Film& film, const Summary& summary,
                                                                   double samples_per_s) const
{
    std::map<std::string, std::string> said = attributes(o_, plan_, film, summary);
    if (o_.part) add_progress(film, samples_per_s, said);
    said[parts_attribute] = plan_.scene_parts;
    return said;
}

void PictureWriter::tell(const Film& film, const Summary& summary, bool cut_short)
{
    if (!plan_.denoiser) tell_fireflies(film, plan_.write.display, reporter_);
    warn_of_dropped(film, reporter_);
    if (cut_short)
        reporter_.note(fmt::format("interrupted: the picture has {} samples a pixel", film.samples_per_pixel()));
    reporter_.summary(summary);
    if (o_.stats) reporter_.cost_sheet(summary);
}

}  // namespace fathom::cli
