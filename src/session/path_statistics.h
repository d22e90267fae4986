// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "guiding/records.h"

namespace fathom {

/// Records of paths, with their mean cost and variance.
struct PathStatistics {
    struct Part {
        const GuidingRecords* records;
        const double* squared_brightness;  ///< indexed by pixel; `samples` consecutive paths belong to one pixel
    };
    std::vector<Part> parts;
    std::size_t samples = 0;  ///< number of paths per pixel
    double vertices = 0;      ///< mean number of vertices of a path
    double variance = 0;      ///< variance of a path over the squared brightness of its pixel
};

/// Calls f(record, number of later records of its path, squared brightness of its pixel) for all records of a part.
template <class F>
void for_records(const PathStatistics::Part& part, std::size_t samples, const F& f)
{
    auto at = part.records->surfaces.begin();
    std::size_t path = 0;
    for (const std::uint8_t count : part.records->counts) {
        const double square = part.squared_brightness[path++ / samples];
        for (int after = count - 1; after >= 0; --after, ++at) f(*at, after, square);
    }
}

}  // namespace fathom
