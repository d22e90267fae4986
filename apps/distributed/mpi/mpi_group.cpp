#include "distributed/mpi/mpi_group.h"

#include <fmt/format.h>

#include "fathom/error.h"
#include "process/modules.h"

namespace fathom::cli {

mpi::Group* open_group(const RankEnvironment& environment)
{
    void* const module = open_module(
        mpi::module_file, mpi::version_symbol,
        fmt::format("started as one of {} ranks ({}), but this installation has no {}, which knows MPI: build it where "
                    "MPI is installed, or add --mpi off for as many renders of their own",
                    environment.count, environment.variable, mpi::module_file),
        true);
    std::string trouble;
    mpi::Group* const group = function_of<mpi::Open>(module, mpi::module_file, mpi::open_symbol)(trouble);
    if (!group) throw Error("", "", "MPI can't be used: " + trouble);
    if (group->count() != environment.count)
        throw OtherLauncher{fmt::format(
            "started as one of {} ranks ({}), but {}, which {} was built with, knows of {}: use the mpirun that "
            "belongs to it",
            environment.count, environment.variable, group->library(), mpi::module_file, group->count())};
    return group;
}

}  // namespace fathom::cli
