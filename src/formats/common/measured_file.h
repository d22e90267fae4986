// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "formats/common/load_context.h"

namespace fathom {

/// Reads a measured BRDF from a file of the RGL material database (.bsdf). Spectra become colors under D65. Throws
/// Error.
///
/// file  name of the file, for messages
MeasuredBrdf read_measured(const std::filesystem::path& file, std::string_view bytes);

/// The measured BRDFs that a scene refers to; each file is read once.
class MeasuredFiles {
public:
    MeasuredFiles(LoadContext& context, SceneDescription& scene) : context_(context), scene_(scene) {}

    /// Index into SceneDescription::measured of the BRDF in a file, which is read on first use. Throws Error.
    int index_of(const std::filesystem::path& file);

private:
    LoadContext& context_;
    SceneDescription& scene_;
    std::map<std::filesystem::path, int> indices_;
};

}  // namespace fathom
