// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "fathom/load.h"

namespace fathom {

/// Generates unique names.
class UniqueNames {
public:
    /// Returns `wanted` in valid UTF-8, or `other` if it is empty, with a number appended if the name is taken.
    std::string add(const std::string& wanted, const std::string& other);

private:
    std::map<std::string, int> used_;  ///< names, with the last number that was appended
};

/// The files that saving a scene writes beside the scene file, in a folder named after it.
class SaveFiles {
public:
    SaveFiles(const SceneDescription& scene, const std::filesystem::path& target);

    using Write = std::function<void(const std::filesystem::path&)>;
    /// Registers a file and returns its path relative to the scene file. Only letters, digits, dots and dashes of
    /// `name` are kept.
    std::string add(const std::string& name, const std::string& extension, Write write);
    /// Returns the path to write into the scene file for an existing file: relative if possible; empty if it can't be
    /// expressed in UTF-8.
    std::string refer(const std::filesystem::path& file) const;

    /// Writes all files. Throws Error, before writing any, if a file or the target is one that the scene was read from.
    void write() const;

private:
    void check(const std::filesystem::path& file) const;

    const SceneDescription& scene_;
    std::filesystem::path target_, folder_;
    std::vector<std::pair<std::filesystem::path, Write>> files_;
};

}  // namespace fathom
