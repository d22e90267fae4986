// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>

#include "commands/commands.h"
#include "fathom/error.h"
#include "fathom/film_file.h"
#include "fathom/image_error.h"
#include "fathom/memory.h"
#include "options/arguments.h"
#include "options/image_options.h"
#include "options/machine_options.h"
#include "options/sample_plan.h"
#include "render/film_memory.h"
#include "render/image_files.h"
#include "render/overwrite_guard.h"
#include "report/reporter.h"

namespace fathom::cli {

namespace {

constexpr CommandText merge_text{
    "merge", "Merge film files of one scene into one image",
    "The result is bit for bit the image of one run. Parts can be given in any order; missing samples are "
    "reported.\n\n"
    "Examples:\n"
    "  fathom render scene.json --samples 0:64 -o a.exr\n"
    "  fathom render scene.json --samples 64:128 -o b.exr\n"
    "  fathom merge a.exr b.exr -o all.exr -o all.png\n\n"
    "Exit codes: 0 success; 1 error; 2 wrong usage."};

struct MergeOptions {
    std::vector<std::filesystem::path> parts;
    ImageOptions images;
    bool skip_overlaps = false, no_sums = false, quiet = false;
};

/// The merged film, and what its image holds.
struct MergedFilm {
    Film film;
    std::map<std::string, std::string> attributes;  ///< attributes of the first part
    bool has_alpha = false, has_variance = false, has_counts = false, has_error = false;
    std::uint64_t planned_samples = 0;
};

/// First range of samples that both the film and the part have; empty if there is none.
std::string overlap(const Film& film, const FilmFile& part)
{
    for (const SampleRange& r : part.samples())
        for (const SampleRange& s : film.samples())
            if (r.first < s.second && s.first < r.second)
                return sample_ranges_text({{std::max(r.first, s.first), std::min(r.second, s.second)}});
    return "";
}

/// Whether a part has a layer, or was to have it: checkpoints leave out layers that the sums imply.
bool has_layer(const FilmFile& part, const char* channel, const char* layer)
{
    const auto wanted = part.attributes().find(wanted_layers_attribute);
    const std::vector<std::string> names =
        wanted == part.attributes().end() ? std::vector<std::string>{} : split(wanted->second, ',');
    return std::find(part.channels().begin(), part.channels().end(), channel) != part.channels().end() ||
           std::find(names.begin(), names.end(), layer) != names.end();
}

/// Merges the parts in a stream, without loading any of them as a whole.
///
/// left_out  gets a line for each skipped part
MergedFilm merge_parts(const MergeOptions& o, Reporter& reporter, std::vector<std::string>& left_out)
{
    const Reporter::Phase phase(reporter, "merge", "merging");
    std::optional<MergedFilm> merged;
    for (const std::filesystem::path& file : o.parts) {
        const FilmFile part(file);
        if (!merged) {
            // The first part decides which layers the image has.
            const auto has = [&](const char* channel, const char* layer) { return has_layer(part, channel, layer); };
            FilmUse use;
            use.is_mergeable = !o.no_sums && writes_exr(o.images);
            use.extra_channels = (has("variance.R", "variance") ? 3 : 0) + (has("samples.Y", "samples") ? 1 : 0) +
                                 (has("error.R", "error") ? 3 : 0);
            check_memory(file.string(), film_memory(part.key().settings, use, o.images));
            merged = MergedFilm{part.read(),
                                part.attributes(),
                                has("A", "A"),
                                has("variance.R", "variance"),
                                has("samples.Y", "samples"),
                                has("error.R", "error")};
        } else if (const std::string both = overlap(merged->film, part); !both.empty() && o.skip_overlaps) {
            left_out.push_back(fmt::format("skipped {}: another part has its samples {}", file.string(), both));
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
    if (o.images.outputs.empty()) throw UsageError("-o: name the image to write");
    for (const auto& file : o.images.outputs) check_output(file);
    for (const auto& part : o.parts) check_outputs_are_not(o.images.outputs, part, "a part of this image");
    Reporter reporter(o.quiet ? ReportMode::quiet : default_report_mode());

    const WriteOptions write = resolve_write_options(o.images, {}, reporter);
    const std::optional<Denoiser> denoiser = open_denoiser(o.images, 0, reporter);

    std::vector<std::string> left_out;
    MergedFilm merged = merge_parts(o, reporter, left_out);
    for (const std::string& line : left_out) reporter.note(line);
    const Film& film = merged.film;
    Image image = film.image(merged.has_alpha, merged.has_variance);
    if (merged.has_error) image.layers.push_back(standard_error(film));
    if (merged.has_counts) image.layers.push_back(sample_count_layer(film));
    const std::uint64_t planned_parts = planned_number(merged.attributes, planned_parts_attribute);
    image.attributes = std::move(merged.attributes);
    if (merged.planned_samples > 0)
        image.attributes[planned_samples_attribute] = fmt::format("{}", merged.planned_samples);
    // These attributes of one part are wrong for the whole.
    for (const char* name : {"fathom.load_s", "fathom.build_s", "fathom.render_s", "fathom.rays", "fathom.denoiser",
                             noise_attribute, samples_per_s_attribute})
        image.attributes.erase(name);
    image.attributes["fathom.samples"] = sample_ranges_text(film.samples());
    image.attributes["fathom.samples_per_pixel"] = fmt::format("{}", film.samples_per_pixel());
    image.attributes["fathom.dropped_samples"] = fmt::format("{}", film.invalid_samples());
    if (denoiser) denoiser->add_to(image);
    const bool all_written = write_images(o.images, image, o.no_sums ? nullptr : &film, write, reporter);
    reporter.note(
        fmt::format("{} samples per pixel: {}", film.samples_per_pixel(), sample_ranges_text(film.samples())));
    if (const std::optional<ImageError> error = estimate_error(film))
        reporter.image_error({*error, ErrorMetric::relative, film.samples_per_pixel()});
    if (const auto missing = missing_samples(film.samples(), merged.planned_samples); !missing.empty())
        reporter.note("missing: " + missing_text(missing, merged.planned_samples, planned_parts));
    return all_written ? exit_ok : exit_error;
}

void add_options(Command& command, MergeOptions& o)
{
    command.add_positionals(
        "PART", o.parts, "film files, written by `fathom render` with --part, --samples, --mergeable or --checkpoint");
    add_image_options(command, o.images, "");
    add_machine_options(command);
    command.begin_group("Merging");
    command.add_flag({"--skip-overlaps", "", "skip parts with samples that an earlier part has, and report them",
                      "overlaps are an error"},
                     o.skip_overlaps);
    command.add_flag(
        {"--no-sums", "", "write EXR without the exact sums: the file is smaller, but can't be merged again", ""},
        o.no_sums);
    add_quiet_option(command, o.quiet);
}

}  // namespace

void add_merge(CLI::App& program, Run& run)
{
    add_command<MergeOptions>(program, run, merge_text, add_options, run_merge);
}

}  // namespace fathom::cli
