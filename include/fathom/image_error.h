// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "fathom/api.h"
#include "fathom/film.h"
#include "fathom/image.h"

namespace fathom {

/// How the error of an image x is measured, where r is the image without noise. Squares are averaged over red, green
/// and blue of linear Rec.709 radiance.
enum class ErrorMetric {
    relative,    ///< Root of the mean over pixels of (x - r)^2 / (r^2 + 0.01).
    absolute,    ///< Root of the mean over pixels of (x - r)^2.
    worst_block  ///< The relative error of the block of 32x32 pixels where it is largest.
};

/// The set of probes, pixels that were rendered twice, that an estimate uses. A render that stops once the error is
/// small must decide by some of them and report by the others: the reported error would otherwise be too small.
enum class ErrorProbes { all, deciding, reporting };

/// Estimated error of an image: what remains of the noise. Bias, such as that of a limited path length, is not
/// included.
struct ImageError {
    double error = 0;  ///< Estimated error.
    double low = 0;    ///< Lower end of the interval that contains the error with 95 % confidence.
    double high = 0;   ///< Upper end of that interval.
    /// Share of the squared error, 0 to 1, in pixels whose light comes from fewer than four samples.
    double few_share = 0;
    /// Shape of the generalized Pareto distribution of the largest squared errors of these pixels; 0 if their share is
    /// below 0.1. From 0.7 on, samples that are rarer and brighter than all that were seen may decide the error, and
    /// neither it nor its interval can be trusted (Vehtari, Simpson, Gelman, Yao and Gabry 2024, "Pareto Smoothed
    /// Importance Sampling").
    double tail_shape = 0;
    double top_share = 0;  ///< Share of the squared error in the noisiest 0.1 % of the pixels, 0 to 1.
    double rest = 0;       ///< Error without the noisiest 0.1 % of the pixels.

    /// Returns whether the error and its interval can be trusted: the tail is not too heavy, and the interval not wider
    /// than a factor of 2.5.
    bool is_reliable() const { return tail_shape < 0.7 && high <= 2.5 * low; }
};

/// Estimates the error of a film's image from its probes (RenderSettings::error_probes). Returns nothing if the film
/// has fewer than 8 probes or 2 samples per pixel.
///
/// The variance of a pixel's samples overstates its error, because the samples are spread evenly. The pixels with a
/// second result show by what factor: its square error is half of the squared difference of both results. The interval
/// follows from the differences between pixels.
FATHOM_API std::optional<ImageError> estimate_error(const Film& film, ErrorMetric metric = ErrorMetric::relative,
                                                    ErrorProbes probes = ErrorProbes::all);

/// Returns a layer "error" with the standard error of each pixel (R, G, B; linear radiance): the root of its variance,
/// corrected by what the probes around it show. Without probes, it is not corrected and too large.
FATHOM_API Image::Layer standard_error(const Film& film);

}  // namespace fathom
