// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/api.h"
#include "fathom/description.h"

namespace fathom {

/// Returns the name that a kind of material has in scene files.
FATHOM_API const char* name_in_files(MaterialKind kind);

}  // namespace fathom
