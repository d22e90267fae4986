#include <fmt/format.h>
#include <algorithm>
#include <memory>

#include "arguments.h"
#include "commands.h"
#include "fathom/error.h"
#include "inputs.h"
#include "picture_options.h"
#include "reporter.h"

namespace fathom::cli {

namespace {

struct MergeOptions {
    std::vector<std::filesystem::path> parts;
    PictureOptions picture;
    bool no_sums = false, quiet = false;
};

bool has_channel(const Image& image, const std::string& channel)
{
    const Image::Layer* layer = image.find("");
    return layer && std::find(layer->channels.begin(), layer->channels.end(), channel) != layer->channels.end();
}

/// The library knows sums, not the files that they came from.
template <class Action>
auto naming(const std::filesystem::path& file, Action action)
{
    try {
        return action();
    } catch (const Error& error) {
        if (!error.file().empty()) throw;
        throw Error(file.string(), error.place(), error.message());
    }
}

Film film_of(const Image& part, const std::filesystem::path& file)
{
    return naming(file, [&] { return Film::from_sums(load_sums(part, file.string())); });
}

int run_merge(const MergeOptions& o)
{
    if (o.picture.outputs.empty()) throw UsageError("-o: say where the picture goes");
    for (const auto& file : o.picture.outputs) check_output(file);
    for (const auto& part : o.parts) check_outputs_are_not(o.picture.outputs, part, "a part of this picture");
    Reporter reporter(o.quiet ? ReportMode::quiet : default_report_mode());

    const WriteOptions write = write_options(o.picture, {}, reporter);
    const std::optional<Denoiser> denoiser = open_denoiser(o.picture, 0, reporter);

    // The first part decides what else the picture holds.
    bool alpha = false, variance = false, counts = false;
    std::map<std::string, std::string> attributes;
    Film film = [&] {
        const Image first = read_image(o.parts.front());
        alpha = has_channel(first, "A");
        variance = first.find("variance");
        counts = first.find("samples");
        attributes = first.attributes;
        return film_of(first, o.parts.front());
    }();
    for (std::size_t i = 1; i < o.parts.size(); ++i) {
        const Film part = film_of(read_image(o.parts[i]), o.parts[i]);
        naming(o.parts[i], [&] { film.merge(part); });
    }
    Image image = film.image(alpha, variance);
    if (counts) image.layers.push_back(sample_count_layer(film));
    // Times of one part say nothing of the whole.
    for (const char* name : {"fathom.load_s", "fathom.build_s", "fathom.render_s", "fathom.rays"})
        attributes.erase(name);
    std::erase_if(attributes, [](const auto& attribute) { return attribute.first.rfind("fathom.sums.", 0) == 0; });
    attributes["fathom.samples"] = text_of(film.samples());
    attributes["fathom.samples_per_pixel"] = fmt::format("{}", film.samples_per_pixel());
    attributes["fathom.dropped_samples"] = fmt::format("{}", film.dropped_samples());
    image.attributes = std::move(attributes);
    image.attributes.erase("fathom.denoiser");
    if (denoiser) denoiser->add_to(image);
    if (writes_exr(o.picture) && !o.no_sums) store_sums(film.sums(), image);
    const bool all_written = write_pictures(o.picture, image, write, reporter);
    reporter.note(fmt::format("{} samples a pixel: {}", film.samples_per_pixel(), text_of(film.samples())));
    return all_written ? exit_ok : exit_error;
}

}  // namespace

void add_merge(CLI::App& program, Run& run)
{
    const auto options = std::make_shared<MergeOptions>();
    Command command(program, "merge", "Join pictures of disjoint sample ranges of one scene");
    command.add_positionals("PART", options->parts, "EXR files of `fathom render --samples` or --mergeable");
    add_picture_options(command, options->picture);
    command.add_flag("--no-sums", options->no_sums, "leave the sums out of EXR: smaller, but the end of merging");
    command.add_flag("-q,--quiet", options->quiet, "print only errors");
    command.set_footer(
        "The result is, bit for bit, the picture that one run makes.\n\n"
        "Examples:\n"
        "  fathom render scene.json --samples 0:64 -o a.exr\n"
        "  fathom render scene.json --samples 64:128 -o b.exr\n"
        "  fathom merge a.exr b.exr -o all.exr -o all.png\n\n"
        "Exit codes: 0 done; 1 error; 2 wrong usage.");
    command.set_run(run, [options] { return run_merge(*options); });
}

}  // namespace fathom::cli
