// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <set>
#include <string>

#include "fathom/load.h"

namespace fathom {

/// Counts the defects of a scene's meshes. Each kind of defect is reported in one warning, such as "scene.xml: 37
/// meshes of 12 files contain degenerate triangles, 1,204 in all; ignored".
class MeshFaults {
public:
    enum Kind { degenerate_triangles, normals_without_direction, values_not_finite };

    /// Records that one mesh of a file has the defect `times` times; 0 is ignored.
    void add(Kind kind, const std::string& file, std::size_t times);
    /// Adds the warnings, which name the scene, or the one file if all affected meshes come from the same file.
    void report(const std::string& scene, Warnings& warnings) const;

private:
    struct Count {
        std::size_t meshes = 0, times = 0;
        std::set<std::string> files;
    };
    std::array<Count, 3> counts_;
};

/// Formats a number with thousands separators: 1,204.
std::string thousands_separated(std::size_t number);

}  // namespace fathom
