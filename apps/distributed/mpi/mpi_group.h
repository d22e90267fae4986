#pragma once
#include <string>

#include "distributed/mpi/module.h"
#include "distributed/ranks/environment.h"

namespace fathom::cli {

/// MPI knows of another number of ranks than the environment tells, as each for itself: the module is of another MPI.
struct OtherLauncher {
    std::string words;
};

/// Meets the other ranks by the module. Throws Error or OtherLauncher.
mpi::Group* open_group(const RankEnvironment& environment);

}  // namespace fathom::cli
