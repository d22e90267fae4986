#include "still.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "../commands.h"
#include "../film_info.h"
#include "../interrupt.h"
#include "../sample_plan.h"
#include "checkpoint.h"
#include "rendering.h"

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

/// What is made of a film: pictures, and what is told.
class PictureWriter {
public:
    PictureWriter(const RenderOptions& options, const RenderPlan& plan, const PictureOptions& files, Reporter& reporter)
        : o_(options), plan_(plan), files_(files), reporter_(reporter)
    {
    }

    bool write(const Film& film, const Summary& summary)
    {
        Image image = film.image(plan_.settings.alpha, o_.aov_variance);
        if (o_.aov_samples) image.layers.push_back(sample_count_layer(film));
        image.attributes = attributes(o_, plan_, film, summary);
        if (plan_.denoiser) add_denoised(image, *plan_.denoiser, o_.aovs);
        return write_pictures(files_, image, o_.mergeable ? &film : nullptr, plan_.write, reporter_);
    }

private:
    const RenderOptions& o_;
    const RenderPlan& plan_;
    const PictureOptions& files_;
    Reporter& reporter_;
};

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

int render_picture(const RenderOptions& o, const RenderPlan& plan, const PictureOptions& files, const RenderJob& job,
                   Summary summary, Reporter& reporter)
{
    constexpr double default_every_s = 60;
    std::optional<Checkpoint> checkpoint;
    if (!o.checkpoint.empty()) checkpoint.emplace(o.checkpoint, o.every_s.value_or(default_every_s), reporter);
    Film film = checkpoint ? checkpoint->open(job, plan.range, plan.scene_parts) : Film(job);
    const std::uint64_t samples_before = film.samples_per_pixel();

    PictureWriter pictures(o, plan, files, reporter);
    Rendering rendering(o, job, reporter);
    const double start_s = seconds_since_start();
    const auto save = [&](const Film& now) {
        std::map<std::string, std::string> said = attributes(o, plan, now, summary);
        if (o.part)
            add_progress(now, double(now.samples_per_pixel() - samples_before) / (seconds_since_start() - start_s),
                         said);
        said[parts_attribute] = plan.scene_parts;
        checkpoint->write(now, plan.settings.alpha, said);
    };
    rendering.run(film, plan.range, [&](const Film& now) {
        const bool is_wanted = picture_is_wanted();
        if (checkpoint && (is_wanted || checkpoint->is_due())) save(now);
        if (is_wanted) pictures.write(now, summary);
    });
    summary.render_s = rendering.render_s;
    summary.costs = rendering.costs;
    summary.samples_per_pixel = film.samples_per_pixel();
    if (rendering.cut_short && film.samples().empty()) {
        reporter.error("interrupted before the first pass was done: no picture is written");
        return exit_interrupted;
    }

    const double write_start_s = seconds_since_start();
    if (checkpoint && film.samples_per_pixel() > samples_before) save(film);
    const bool all_written = pictures.write(film, summary);
    if (checkpoint) checkpoint->finish();
    if (!plan.denoiser) tell_fireflies(film, plan.write.display, reporter);
    summary.write_s = seconds_since_start() - write_start_s;
    warn_of_dropped(film, reporter);
    if (rendering.cut_short)
        reporter.note(fmt::format("interrupted: the picture has {} samples a pixel", film.samples_per_pixel()));
    reporter.summary(summary);
    if (o.stats) reporter.cost_sheet(summary);
    if (!all_written) return exit_error;
    return rendering.cut_short ? exit_interrupted : exit_ok;
}

}  // namespace fathom::cli
