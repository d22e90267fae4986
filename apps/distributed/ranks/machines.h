#pragma once
#include <string>
#include <vector>

namespace fathom::cli {

/// Where a rank runs.
struct RankPlace {
    std::string host;
    std::string cores;           ///< that it may run on: "0-3,8"
    std::string launcher_cores;  ///< those of what started it
    int threads = 1;             ///< that a process with these cores makes good use of: a container may allow fewer

    std::string text() const;
    /// The inverse.
    static RankPlace parse(const std::string& text);
};
RankPlace place_here();

/// Threads for each rank: ranks that may run on the same cores share them; one at least.
std::vector<int> shared_threads(const std::vector<RankPlace>& places);
int machines_of(const std::vector<RankPlace>& places);
/// Cores that no rank may run on though what started the ranks may, on all machines; and how many these may.
struct IdleCores {
    int idle = 0, all = 0;
};
IdleCores idle_cores(const std::vector<RankPlace>& places);

}  // namespace fathom::cli
