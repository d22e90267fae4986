// SPDX-License-Identifier: Apache-2.0
#include "render/comparison.h"

#include <fmt/format.h>

#include "fathom/film_file.h"

namespace fathom::cli {

namespace {

/// Attribute of EXR files that contain the sums of a film.
constexpr const char* sums_attribute = "fathom.sums.version";

/// A reason not to test two images for noise, as a sentence; empty if there is none.
std::string noise_obstacle(const NamedImage& image, const NamedImage& reference)
{
    for (const NamedImage* each : {&image, &reference}) {
        if (!each->image.is_linear) return "only EXR files state their noise, with --mergeable or --aov variance";
        if (const std::string obstacle = noise_test_obstacle(each->image); !obstacle.empty())
            return fmt::format("{} {}; render it with --mergeable or --aov variance", each->name, obstacle);
    }
    return "";
}

/// Whether both images are renders with the same samples, which unchanged scenes give the same bits.
bool has_same_samples(const Image& a, const Image& b)
{
    for (const char* name : {"fathom.seed", "fathom.samples"}) {
        const auto in_a = a.attributes.find(name), in_b = b.attributes.find(name);
        if (in_a == a.attributes.end() || in_b == b.attributes.end() || in_a->second != in_b->second) return false;
    }
    return true;
}

}  // namespace

void add_variance(Image& image, const Film& film)
{
    if (image.find("variance")) return;
    image.layers.push_back(*film.image(false, true).find("variance"));
    image.attributes["fathom.samples_per_pixel"] = fmt::format("{}", film.samples_per_pixel());
}

NamedImage read_comparable(const std::filesystem::path& file)
{
    NamedImage result{read_image(file), file.string()};
    result.image.uint_channels.clear();
    if (result.image.attributes.contains(sums_attribute) && std::filesystem::is_regular_file(file))
        add_variance(result.image, FilmFile(file).read());
    return result;
}

Comparison compare(const NamedImage& image, const NamedImage& reference, const CompareOptions& options)
{
    Comparison result{image.name, reference.name, options, {}, {}, {}};
    result.difference = compare_images(image.image, image.name, reference.image, reference.name, options);
    if (!options.layer.empty())
        result.no_noise_test = "it is made for colors without --layer";
    else
        result.no_noise_test = noise_obstacle(image, reference);
    if (!result.no_noise_test.empty()) return result;
    result.noise = test_noise(image.image, reference.image);
    if (!result.difference.is_same() && has_same_samples(image.image, reference.image))
        result.difference.notes.emplace_back(
            "both have the same seed and samples: without a change of scene, settings or version, they would be equal");
    return result;
}

}  // namespace fathom::cli
