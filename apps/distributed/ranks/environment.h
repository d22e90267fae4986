#pragma once
#include <string>

namespace fathom::cli {

/// What a launcher (mpirun, srun) tells a process that is one of several.
struct RankEnvironment {
    int rank = 0, count = 1;
    std::string variable;  ///< the one that tells of `count`
};
/// {0, 1} where the environment tells of none. Reads the environments of Open MPI, of MPICH and its kin (PMI), and of
/// srun with PMIx.
RankEnvironment rank_environment();

/// To be called by other ranks than 0 before they tell what is probably wrong at all of them: rank 0 tells it at once,
/// and mpirun then ends this process before this returns.
void leave_the_word_to_rank_0();

/// Cores of a process, as ranges: "0-3,8"; empty where the system doesn't tell.
///
/// process  0: this one
std::string cores_of(int process);

}  // namespace fathom::cli
