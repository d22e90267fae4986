#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::fuzz {

/// A reader of files that others made. Whatever the bytes, it returns or throws fathom::Error; all else is a bug.
struct Target {
    std::string_view name;
    void (*run)(const std::string& bytes);
    std::vector<std::string> (*seeds)();  ///< small valid files to begin with
};

std::span<const Target> targets();

}  // namespace fathom::fuzz
