// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "fathom/api.h"
#include "fathom/image.h"

namespace fathom {

/// A test whether noise explains the differences of two renders.
///
/// Images are divided into blocks. For each block, and for the whole image, Welch's t-test (B. L. Welch 1947, "The
/// generalization of Student's problem when several different population variances are involved") compares the means of
/// red, green and blue, with the variances of their pixels. Numbers of samples may differ. For each pixel, the larger
/// of both variances of a sample counts for both images, because few samples may have missed rare bright paths. By
/// Bonferroni's correction, a change is found where p times the number of tests is below `significance`, which limits
/// the probability that noise is taken for a change anywhere in the image.
struct NoiseTest {
    /// A rectangle of pixels whose difference noise does not explain.
    struct Change {
        int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< Pixels x0 <= x < x1, y0 <= y < y1.
        std::string channel;                 ///< The channel with the smallest p: R, G or B.
        double mean = 0;                     ///< Mean of the image in this channel, linear Rec.709.
        double reference_mean = 0;           ///< Mean of the reference.
        double standard_error = 0;           ///< Standard error of the difference of the means.
        double p = 0;                        ///< Corrected probability of such a difference by noise, 0 to 1.
    };
    double significance = 0.01;   ///< Limit of the corrected probability.
    int block_side = 16;          ///< Side of the blocks in pixels.
    std::uint64_t blocks = 0;     ///< Number of blocks.
    double smallest_p = 1;        ///< The smallest corrected probability.
    bool whole_changed = false;   ///< Whether the mean of the whole image differs by more than noise.
    std::vector<Change> changes;  ///< Blocks that differ by more than noise, smallest p first.

    /// Returns whether noise explains all differences.
    bool is_noise() const { return !whole_changed && changes.empty(); }
};

/// Returns why an image can't be tested for noise, as the end of a sentence that begins with its name; empty if it can.
/// The image needs red, green and blue, a layer "variance", and its number of samples: the attribute
/// "fathom.samples_per_pixel" or a layer "samples".
FATHOM_API std::string noise_test_obstacle(const Image& image);

/// Tests whether noise explains the differences of two images of one size for which noise_test_obstacle() is empty.
FATHOM_API NoiseTest test_noise(const Image& image, const Image& reference);

}  // namespace fathom
