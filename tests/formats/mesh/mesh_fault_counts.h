// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "fathom/load.h"

namespace fathom::test {

/// Total count of a mesh warning, for example the 1,204 of "37 meshes contain degenerate triangles, 1,204 in all;
/// ignored".
inline std::size_t count_in_all(const Warnings& warnings, const std::string& fault)
{
    std::size_t sum = 0;
    for (const auto& [message, times] : warnings.counts()) {
        const std::size_t end = message.find(" in all;");
        if (message.find(fault) == std::string::npos || end == std::string::npos) continue;
        std::string digits;
        for (std::size_t at = message.rfind(' ', end - 1) + 1; at < end; ++at)
            if (message[at] != ',') digits += message[at];
        sum += std::stoul(digits);
    }
    return sum;
}

}  // namespace fathom::test
