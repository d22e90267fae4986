// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace fathom::cli {

/// Rank and number of ranks of this process, as a launcher (mpirun, srun) passes them in the environment.
struct RankEnvironment {
    int rank = 0, count = 1;
    std::string variable;  ///< name of the variable that holds `count`
};
/// Understands the variables of Open MPI, of MPICH and its relatives (PMI), and of srun with PMIx; without them, the
/// result is rank 0 of 1.
RankEnvironment rank_environment();

/// Called by other ranks than 0 before they report an error that rank 0 probably has too: rank 0 reports it at once,
/// and mpirun then ends this process before the function returns.
void let_rank0_report_first();

/// Cores that a process may use, as ranges: "0-3,8"; empty if unknown.
///
/// process  process id; 0: this process
std::string cores_of(int process);

}  // namespace fathom::cli
