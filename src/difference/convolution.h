// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

namespace fathom {

/// One channel of an image, row by row.
struct Plane {
    int width = 0, height = 0;
    std::vector<float> values;

    Plane(int w, int h) : width(w), height(h), values(std::size_t(w) * std::size_t(h)) {}
};

/// Weights of an odd number of pixels, the center in the middle.
using Kernel = std::vector<float>;

/// Convolves the columns with one kernel and the rows with another, of any odd lengths. Pixels outside the image have
/// the value of the nearest pixel inside.
Plane convolve(const Plane& plane, const Kernel& horizontal, const Kernel& vertical);

}  // namespace fathom
