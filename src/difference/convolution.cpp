// SPDX-License-Identifier: Apache-2.0
#include "difference/convolution.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <algorithm>

namespace fathom {

namespace {

template <class Row>
void for_rows(int height, const Row& row)
{
    tbb::parallel_for(tbb::blocked_range<int>(0, height, 8), [&](const tbb::blocked_range<int>& range) {
        for (int y = range.begin(); y < range.end(); ++y) row(y);
    });
}

}  // namespace

Plane convolve(const Plane& plane, const Kernel& horizontal, const Kernel& vertical)
{
    const int width = plane.width, height = plane.height;
    const auto row_of = [width](auto& p, int y) { return p.values.data() + std::size_t(y) * std::size_t(width); };
    Plane rows(width, height), result(width, height);
    for_rows(height, [&](int y) {
        const int radius = int(horizontal.size()) / 2;
        const float* from = row_of(plane, y);
        std::vector<float> padded(std::size_t(width + 2 * radius));
        for (int x = -radius; x < width + radius; ++x)
            padded[std::size_t(x + radius)] = from[std::clamp(x, 0, width - 1)];
        float* to = row_of(rows, y);
        for (std::size_t k = 0; k < horizontal.size(); ++k)
            for (int x = 0; x < width; ++x) to[x] += horizontal[k] * padded[std::size_t(x) + k];
    });
    for_rows(height, [&](int y) {
        const int radius = int(vertical.size()) / 2;
        float* to = row_of(result, y);
        for (int k = -radius; k <= radius; ++k) {
            const float* from = row_of(rows, std::clamp(y + k, 0, height - 1));
            for (int x = 0; x < width; ++x) to[x] += vertical[std::size_t(k + radius)] * from[x];
        }
    });
    return result;
}

}  // namespace fathom
