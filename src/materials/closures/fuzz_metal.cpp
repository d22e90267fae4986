// SPDX-License-Identifier: Apache-2.0
#include "materials/compile/inputs.h"

namespace fathom {

void compile_fuzz_metal(Compiler&, const Material& m, MaterialRecord& t)
{
    t.set_parameters(FuzzMetalRecord{m.fuzz});
}

}  // namespace fathom
