// SPDX-License-Identifier: Apache-2.0
#include "materials/compile/inputs.h"

namespace fathom {

void compile_metal(Compiler&, const Material& m, MaterialRecord& t)
{
    MetalRecord record;
    set_number(m.roughness, record.roughness, record.roughness_texture, t);
    record.flags = facet_flags(m);
    t.set_parameters(record);
}

}  // namespace fathom
