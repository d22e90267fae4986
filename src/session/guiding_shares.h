// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "session/path_statistics.h"

namespace fathom {

/// Sets GuidingTables::shares: for each region the one of several shares that makes the second moment of contributions
/// least. met: unguided paths from which the histograms were not learned; a histogram fits its own records too well.
void set_shares(const PathStatistics& met, GuidingTables& tables);

}  // namespace fathom
