// SPDX-License-Identifier: Apache-2.0
#include "formats/mesh/mesh_faults.h"

#include <fmt/format.h>

namespace fathom {

namespace {

/// The parts of a warning: the defect and its treatment.
struct Text {
    const char *fault, *outcome;
};
constexpr Text texts[] = {
    {"degenerate triangles", "ignored"},
    {"normals of zero length or not finite", "replaced by normals of the adjacent faces"},
    {"texture coordinates, tangents or colors that are not finite", "replaced by 0"},
};

std::string several(std::size_t count, const char* one, const char* many)
{
    return fmt::format("{} {}", thousands_separated(count), count == 1 ? one : many);
}

}  // namespace

std::string thousands_separated(std::size_t number)
{
    std::string text = fmt::format("{}", number);
    for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, ",");
    return text;
}

void MeshFaults::add(Kind kind, const std::string& file, std::size_t times)
{
    if (times == 0) return;
    Count& count = counts_[kind];
    ++count.meshes;
    count.times += times;
    count.files.insert(file);
}

void MeshFaults::report(const std::string& scene, Warnings& warnings) const
{
    for (std::size_t kind = 0; kind < counts_.size(); ++kind) {
        const Count& count = counts_[kind];
        if (count.meshes == 0) continue;
        const bool is_one_file = count.files.size() == 1;
        warnings.add(
            fmt::format("{}: {}{} {} {}, {} in all; {}", is_one_file ? *count.files.begin() : scene,
                        several(count.meshes, "mesh", "meshes"),
                        is_one_file ? "" : fmt::format(" of {} files", thousands_separated(count.files.size())),
                        count.meshes == 1 ? "contains" : "contain", texts[kind].fault, thousands_separated(count.times),
                        texts[kind].outcome));
    }
}

}  // namespace fathom
