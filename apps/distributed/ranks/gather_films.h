#pragma once
#include "distributed/ranks/ranks.h"
#include "fathom/render.h"

namespace fathom::cli {

/// Adds the films of all ranks to `into`, at rank 0, in pieces: what it takes beside the films is a few MB. All ranks
/// must call it. Ranks pass on what two others send them, added to their own, so it takes about as long for a hundred
/// ranks as for three. `own` stays as it is; at rank 0 it is not read.
///
/// into        of rank 0, which has that rank's samples already; nullptr at the others
/// patience_s  how long nothing may move once the run has been interrupted. Throws Ranks::Lost then, or if a rank is
///             lost; `into` is to be thrown away
void gather_films(Ranks& ranks, const Film& own, Film* into, double patience_s);

}  // namespace fathom::cli
