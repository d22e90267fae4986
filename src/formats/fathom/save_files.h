#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "fathom/load.h"

namespace fathom {

/// Names of which no two are equal.
class UniqueNames {
public:
    /// `wanted`, made UTF-8, or `other` where it is empty; with a number behind it where that is taken.
    std::string add(const std::string& wanted, const std::string& other);

private:
    std::map<std::string, int> used_;  ///< and the last number that was put behind
};

/// The files beside a scene's own that saving it writes, in a folder named after it.
class SaveFiles {
public:
    SaveFiles(const SceneDescription& scene, const std::filesystem::path& target);

    using Write = std::function<void(const std::filesystem::path&)>;
    /// A file of that name, of which letters, digits, dots and dashes are kept; returns its path as the scene has it.
    std::string add(const std::string& name, const std::string& extension, Write write);
    /// A path to an earlier file as the scene has it: relative if it can be; empty if no text in UTF-8 can say it.
    std::string refer(const std::filesystem::path& file) const;

    /// Writes them all. Throws Error before it begins if one, or the target, is a file that the scene was read from.
    void write() const;

private:
    void check(const std::filesystem::path& file) const;

    const SceneDescription& scene_;
    std::filesystem::path target_, folder_;
    std::vector<std::pair<std::filesystem::path, Write>> files_;
};

}  // namespace fathom
