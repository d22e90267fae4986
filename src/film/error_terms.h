// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "fathom/film.h"

namespace fathom {

/// Weighted squared error of a pixel that was rendered twice, averaged over its channels.
struct ProbeTerm {
    int x = 0, y = 0;      ///< within the rendered pixels
    bool decides = false;  ///< see Probe
    double seen = 0;       ///< half of the squared difference of both results
    double suggested = 0;  ///< variance of the first result, as if its samples were independent
    double samples = 1;    ///< see FilmMoments::effective_samples
};

/// Weighted squared errors of a film's rendered pixels, averaged over channels, as variances suggest them.
struct ErrorTerms {
    int width = 0;               ///< number of pixels in a row
    std::vector<float> paths;    ///< of paths from the camera, as if their samples were independent
    std::vector<float> splats;   ///< of light paths
    std::vector<float> samples;  ///< see FilmMoments::effective_samples
    std::vector<ProbeTerm> probes;
};

/// Computes the terms of a film with at least two samples per pixel.
///
/// is_relative  each channel of a pixel is weighted by 1 / (r^2 + 0.01), where r estimates the pixel without noise;
///              false: by 1
ErrorTerms error_terms(const Film& film, bool is_relative);

}  // namespace fathom
