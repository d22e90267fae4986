// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "distributed/ranks/ranks.h"
#include "fathom/render.h"

namespace fathom::cli {

/// Merges the films of all ranks into `into`, at rank 0, in pieces that take a few MB beside the films. All ranks must
/// call it. The ranks form a binary tree: each adds its own sums to those of two others and passes them on, so a
/// hundred ranks take about as long as three. `own` stays unchanged; at rank 0 it is not read.
///
/// into        the film of rank 0, which has that rank's samples already; nullptr at the others
/// patience_s  how long a transfer may stall once the run is interrupted. Then, or if a rank is lost, throws
///             Ranks::RankLost, and `into` is invalid
void gather_films(Ranks& ranks, const Film& own, Film* into, double patience_s);

}  // namespace fathom::cli
