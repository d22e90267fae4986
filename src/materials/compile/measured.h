// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "compile/compiler.h"

namespace fathom {

/// Adds the tables of all measured surfaces, which materials share. Throws Error if they have too many values.
void compile_measured_tables(Compiler& c);

}  // namespace fathom
