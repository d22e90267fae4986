// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "distributed/mpi/module.h"
#include "distributed/ranks/environment.h"

namespace fathom::cli {

/// MPI and the environment disagree on the number of ranks: the module was built with another MPI than the launcher's.
struct LauncherMismatch {
    std::string message;
};

/// Opens the module and joins the other ranks. Throws Error or LauncherMismatch.
mpi::Group* open_mpi_group(const RankEnvironment& environment);

}  // namespace fathom::cli
