// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/compile/inputs.h"

namespace fathom {

/// The parameters that principled and Disney materials share, without the index of a record in another table.
inline PrincipledRecord principled_record(const Material& m, MaterialRecord& t)
{
    PrincipledRecord record;
    set_number(m.roughness, record.roughness, record.roughness_texture, t);
    set_number(m.metallic, record.metallic, record.metallic_texture, t);
    record.ior = m.ior;
    record.flags = facet_flags(m);
    return record;
}

}  // namespace fathom
