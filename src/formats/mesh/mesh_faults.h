#pragma once
#include <array>
#include <cstddef>
#include <set>
#include <string>

#include "fathom/load.h"

namespace fathom {

/// Counts what is wrong with the meshes of a scene and of the files it refers to. Each kind of fault is one warning:
/// "scene.xml: 37 meshes of 12 files contain degenerate triangles, 1,204 in all; ignored".
class MeshFaults {
public:
    enum Kind { degenerate_triangles, normals_without_direction, values_not_finite };

    /// One mesh of a file has this fault so many times; 0: it has not.
    void add(Kind kind, const std::string& file, std::size_t times);
    /// Adds the warnings; they name the scene, or the one file that all such meshes are from.
    void report(const std::string& scene, Warnings& warnings) const;

private:
    struct Count {
        std::size_t meshes = 0, times = 0;
        std::set<std::string> files;
    };
    std::array<Count, 3> counts_;
};

/// A number as people write it: 1,204.
std::string with_commas(std::size_t number);

}  // namespace fathom
