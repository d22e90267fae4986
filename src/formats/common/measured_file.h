#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "formats/common/load_context.h"

namespace fathom {

/// A measured surface from the bytes of a file of the RGL's database (.bsdf). Spectra become colours in daylight.
/// Throws Error.
///
/// file: for messages
MeasuredBrdf read_measured(const std::filesystem::path& file, std::string_view bytes);

/// Those that a scene refers to, each read once.
class MeasuredFiles {
public:
    MeasuredFiles(LoadContext& context, SceneDescription& scene) : context_(context), scene_(scene) {}

    /// The index into SceneDescription::measured of what is in a file. Throws Error.
    int index_of(const std::filesystem::path& file);

private:
    LoadContext& context_;
    SceneDescription& scene_;
    std::map<std::filesystem::path, int> indices_;
};

}  // namespace fathom
