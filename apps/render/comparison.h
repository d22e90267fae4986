// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "fathom/film.h"
#include "fathom/image_difference.h"
#include "fathom/noise_test.h"

namespace fathom::cli {

/// An image to be compared, and its name in messages.
struct NamedImage {
    Image image;
    std::string name;
};

/// The differences of two images and, where both state their noise, whether noise explains them.
struct Comparison {
    std::string image_name, reference_name;
    CompareOptions options;
    ImageDifference difference;
    std::optional<NoiseTest> noise;
    std::string no_noise_test;  ///< why there is no test, in a sentence; empty if there is one

    bool is_explained_by_noise() const { return noise && noise->is_noise(); }
};

/// Reads an image for a comparison. That of a film file gets a layer "variance" from its sums.
NamedImage read_comparable(const std::filesystem::path& file);
/// Adds a layer "variance" from the sums of the image's film, if there is none.
void add_variance(Image& image, const Film& film);

/// Compares an image with a reference. Throws Error if they can't be compared.
Comparison compare(const NamedImage& image, const NamedImage& reference, const CompareOptions& options);

}  // namespace fathom::cli
