// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::fuzz {

/// A reader of untrusted files. For any input it returns or throws fathom::Error; anything else is a bug.
struct Target {
    std::string_view name;
    void (*run)(const std::string& bytes);
    std::vector<std::string> (*seeds)();  ///< small valid files to start from
};

std::span<const Target> targets();

}  // namespace fathom::fuzz
