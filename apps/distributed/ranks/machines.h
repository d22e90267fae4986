// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace fathom::cli {

/// Machine and cores on which a rank runs.
struct RankPlace {
    std::string host;
    std::string cores;           ///< cores that the rank may use: "0-3,8"
    std::string launcher_cores;  ///< cores that its parent process may use
    int threads = 1;             ///< useful number of threads; a container may allow fewer than cores

    std::string text() const;
    /// Inverse of text().
    static RankPlace parse(const std::string& text);
};
RankPlace current_place();

/// Number of threads for each rank, at least 1: ranks that may use the same cores share them.
std::vector<int> assign_threads(const std::vector<RankPlace>& places);
int count_machines(const std::vector<RankPlace>& places);
/// Cores that the launcher may use but no rank may, and all that the launcher may use, summed over machines.
struct IdleCores {
    int idle = 0, all = 0;
};
IdleCores idle_cores(const std::vector<RankPlace>& places);

}  // namespace fathom::cli
