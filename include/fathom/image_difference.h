// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fathom/api.h"
#include "fathom/image.h"

namespace fathom {

/// What compare_images() compares, and how strictly.
struct CompareOptions {
    std::string layer;     ///< Name of the layer, such as "depth"; empty: the image itself.
    double tolerance = 0;  ///< Pixels whose values differ by more, in any channel, count as different.
};

/// Perceived difference of two images by FLIP: P. Andersson, J. Nilsson, T. Akenine-Moeller, M. Oskarsson, K. Astroem
/// and M. Fairchild 2020, "FLIP: A Difference Evaluator for Alternating Images". Linear images are compared at several
/// exposures: P. Andersson, J. Nilsson, P. Shirley and T. Akenine-Moeller 2021, "Visualizing Errors in Rendered High
/// Dynamic Range Images". Viewing conditions are those of the papers: 67 pixels per degree.
struct Flip {
    double mean = 0;         ///< Mean over all pixels, 0 (equal) to 1.
    double max = 0;          ///< Largest value.
    std::vector<float> map;  ///< Value of each pixel, 0 to 1: width * height.
    int exposures = 0;       ///< Number of exposures; 0 if the images are not linear, or equal.
    double first_ev = 0;     ///< Lowest exposure in stops.
    double last_ev = 0;      ///< Highest exposure in stops.
};

/// Differences of two images as colors. Alpha is not included: colors are those on a black background. Pixels with
/// values that are not finite are left out of the means.
struct ColorDifference {
    double mse = 0;                 ///< Mean squared difference of red, green and blue, as stored in the files.
    double peak = 1;                ///< Value that `psnr_db` refers to: 1, or the largest value of a linear reference.
    std::optional<double> psnr_db;  ///< 10 log10(peak^2 / mse) in decibels; nothing if `mse` or `peak` is 0.
    double relmse = 0;              ///< Mean of (x - r)^2 / (r^2 + 0.01) of linear Rec.709, where r is the reference.
    Flip flip;                      ///< Perceived difference.
};

/// Differences of an image and a reference.
struct ImageDifference {
    /// The channel in which two pixels differ most.
    struct Largest {
        double difference = 0;  ///< Absolute difference; infinite if only one of the values is finite.
        int x = 0, y = 0;       ///< Column from the left and row from the top.
        std::string channel;    ///< Name of the channel.
        float value = 0;        ///< Value of the image.
        float reference = 0;    ///< Value of the reference.
    };
    int width = 0, height = 0;             ///< Size of both images in pixels.
    bool is_linear = false;                ///< Whether values are linear, not encoded as sRGB.
    std::uint64_t different_pixels = 0;    ///< Number of pixels that differ by more than the tolerance.
    std::uint64_t invalid_pixels = 0;      ///< Number of pixels with a NaN or infinite value in either image.
    Largest largest;                       ///< The largest difference, whatever the tolerance is.
    std::vector<float> differences;        ///< Largest absolute difference over the channels of each pixel.
    std::optional<ColorDifference> color;  ///< Nothing for layers that are no colors, such as depth.
    std::vector<std::string> notes;        ///< What was converted or assumed before the comparison, in sentences.

    /// Returns whether no pixel differs by more than the tolerance.
    bool is_same() const { return different_pixels == 0; }
};

/// Compares an image with a reference: two images as read_image() returns them.
///
/// Values are compared as they are stored: codes as numbers from 0 to 1, radiance as it is. A value that is NaN in both
/// images, or the same infinity, is equal. An image without alpha counts as opaque. Linear images in different color
/// spaces are converted to Rec.709.
///
/// image_name, reference_name  The images in messages, such as names of files.
///
/// Throws Error if sizes or channels differ, if a layer is missing, if one image is linear and the other is not, or if
/// memory is short.
FATHOM_API ImageDifference compare_images(const Image& image, const std::string& image_name, const Image& reference,
                                          const std::string& reference_name, const CompareOptions& options = {});

}  // namespace fathom
