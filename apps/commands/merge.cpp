#include <fmt/format.h>
#include <algorithm>
#include <memory>

#include "commands/commands.h"
#include "fathom/error.h"
#include "fathom/film_file.h"
#include "fathom/memory.h"
#include "options/arguments.h"
#include "options/image_options.h"
#include "options/machine_options.h"
#include "options/sample_plan.h"
#include "render/film_memory.h"
#include "render/overwrite_guard.h"
#include "report/reporter.h"

namespace fathom::cli {

namespace {

struct MergeOptions {
    std::vector<std::filesystem::path> parts;
    PictureOptions picture;
    bool skip_overlaps = false, no_sums = false, quiet = false;
};

/// What the parts are to become together.
struct Merged {
    Film film;
    std::map<std::string, std::string> attributes;  ///< of the first part
    bool alpha = false, variance = false, counts = false;
    std::uint64_t planned_samples = 0;
};

/// Samples of one part that another has too; empty if there are none.
std::string overlap(const Film& film, const FilmFile& part)
{
    for (const SampleRange& r : part.samples())
        for (const SampleRange& there : film.samples())
            if (r.first < there.second && there.first < r.second)
                return text_of({{std::max(r.first, there.first), std::min(r.second, there.second)}});
    return "";
}

/// Whether a part's picture has a layer, or was to have it: checkpoints keep no layers that can be made again.
bool has_layer(const FilmFile& part, const char* channel, const char* layer)
{
    const auto wanted = part.attributes().find(wanted_layers_attribute);
    const std::vector<std::string> names =
        wanted == part.attributes().end() ? std::vector<std::string>{} : split(wanted->second, ',');
    return std::find(part.channels().begin(), part.channels().end(), channel) != part.channels().end() ||
           std::find(names.begin(), names.end(), layer) != names.end();
}

/// Adds part by part, none of which is in memory as a whole.
///
/// left_out  gets a line for each part that is
Merged merge_parts(const MergeOptions& o, Reporter& reporter, std::vector<std::string>& left_out)
{
    const Reporter::Phase phase(reporter, "merge", "merging");
    std::optional<Merged> merged;
    for (const std::filesystem::path& file : o.parts) {
        const FilmFile part(file);
        if (!merged) {
            // The first decides what else the picture holds.
            const auto has = [&](const char* channel, const char* layer) { return has_layer(part, channel, layer); };
            FilmUse use;
            use.is_mergeable = !o.no_sums && writes_exr(o.picture);
            use.extra_channels = (has("variance.R", "variance") ? 3 : 0) + (has("samples.Y", "samples") ? 1 : 0);
            check_memory(file.string(), film_needs(part.key().settings, use, o.picture));
            merged = Merged{part.read(), part.attributes(), has("A", "A"), has("variance.R", "variance"),
                            has("samples.Y", "samples")};
        } else if (const std::string both = overlap(merged->film, part); !both.empty() && o.skip_overlaps) {
            left_out.push_back(fmt::format("left out: {}, as samples {} are there already", file.string(), both));
        } else {
            part.add_to(merged->film);
        }
        merged->planned_samples =
            std::max(merged->planned_samples, planned_number(part.attributes(), planned_samples_attribute));
    }
    return std::move(*merged);
}

int run_merge(const MergeOptions& o)
{
    if (o.picture.outputs.empty()) throw UsageError("-o: say where the picture goes");
    for (const auto& file : o.picture.outputs) check_output(file);
    for (const auto& part : o.parts) check_outputs_are_not(o.picture.outputs, part, "a part of this picture");
    Reporter reporter(o.quiet ? ReportMode::quiet : default_report_mode());

    const WriteOptions write = write_options(o.picture, {}, reporter);
    const std::optional<Denoiser> denoiser = open_denoiser(o.picture, 0, reporter);

    std::vector<std::string> left_out;
    Merged merged = merge_parts(o, reporter, left_out);
    for (const std::string& line : left_out) reporter.note(line);
    const Film& film = merged.film;
    Image image = film.image(merged.alpha, merged.variance);
    if (merged.counts) image.layers.push_back(sample_count_layer(film));
    const std::uint64_t planned_parts = planned_number(merged.attributes, planned_parts_attribute);
    image.attributes = std::move(merged.attributes);
    if (merged.planned_samples > 0)
        image.attributes[planned_samples_attribute] = fmt::format("{}", merged.planned_samples);
    // Times of one part say nothing of the whole.
    for (const char* name : {"fathom.load_s", "fathom.build_s", "fathom.render_s", "fathom.rays", "fathom.denoiser",
                             noise_attribute, samples_per_s_attribute})
        image.attributes.erase(name);
    image.attributes["fathom.samples"] = text_of(film.samples());
    image.attributes["fathom.samples_per_pixel"] = fmt::format("{}", film.samples_per_pixel());
    image.attributes["fathom.dropped_samples"] = fmt::format("{}", film.dropped_samples());
    if (denoiser) denoiser->add_to(image);
    const bool all_written = write_pictures(o.picture, image, o.no_sums ? nullptr : &film, write, reporter);
    reporter.note(fmt::format("{} samples a pixel: {}", film.samples_per_pixel(), text_of(film.samples())));
    if (const auto missing = missing_samples(film.samples(), merged.planned_samples); !missing.empty())
        reporter.note("missing: " + missing_text(missing, merged.planned_samples, planned_parts));
    return all_written ? exit_ok : exit_error;
}

}  // namespace

void add_merge(CLI::App& program, Run& run)
{
    const auto options = std::make_shared<MergeOptions>();
    Command command(program, "merge", "Join pictures of disjoint sample ranges of one scene");
    command.add_positionals("PART", options->parts,
                            "film files of `fathom render --part`, --samples, --mergeable or --checkpoint");
    add_picture_options(command, options->picture);
    add_machine_options(command);
    command.add_flag("--skip-overlaps", options->skip_overlaps,
                     "leave parts out, by name, some of whose samples an earlier one has (default: refuse them)");
    command.add_flag("--no-sums", options->no_sums, "leave the sums out of EXR: smaller, but the end of merging");
    command.add_flag("-q,--quiet", options->quiet, "print only errors");
    command.set_footer(
        "The result is, bit for bit, the picture that one run makes. Any parts will do, in any order; what is still\n"
        "missing is told.\n\n"
        "Examples:\n"
        "  fathom render scene.json --samples 0:64 -o a.exr\n"
        "  fathom render scene.json --samples 64:128 -o b.exr\n"
        "  fathom merge a.exr b.exr -o all.exr -o all.png\n\n"
        "Exit codes: 0 done; 1 error; 2 wrong usage.");
    command.set_run(run, [options] { return run_merge(*options); });
}

}  // namespace fathom::cli
