// SPDX-License-Identifier: Apache-2.0
#include "distributed/mpi/mpi_group.h"

#include <fmt/format.h>

#include "fathom/error.h"
#include "process/modules.h"

namespace fathom::cli {

mpi::Group* open_mpi_group(const RankEnvironment& environment)
{
    void* const module = open_module(
        mpi::module_file, mpi::version_symbol,
        fmt::format(
            "started as one of {} ranks ({}), but this installation has no MPI module ({}): build it where MPI is "
            "installed, or add --mpi off to render separately",
            environment.count, environment.variable, mpi::module_file),
        true);
    std::string trouble;
    mpi::Group* const group = find_function<mpi::Open>(module, mpi::module_file, mpi::open_symbol)(trouble);
    if (!group) throw Error("", "", "MPI can't be used: " + trouble);
    if (group->count() != environment.count)
        throw LauncherMismatch{fmt::format(
            "started as one of {} ranks ({}), but {}, with which {} was built, has {}: use the mpirun of that MPI",
            environment.count, environment.variable, group->library(), mpi::module_file, group->count())};
    return group;
}

}  // namespace fathom::cli
