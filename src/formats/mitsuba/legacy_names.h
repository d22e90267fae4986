// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/mitsuba/elements.h"

namespace fathom::mitsuba {

/// Upgrades an element of Mitsuba 0.x to Mitsuba 3: tags, names, and parameters with other semantics. Its children must
/// have been upgraded. `default` elements keep their names, because `$name` refers to them.
///
/// Sources: the manual of Mitsuba 0.6, and the names that Mitsuba 3.9.1 upgrades. Where they differ, Mitsuba 0.6's
/// rendering is matched: skies have +y up, a texture's offset is added after scaling, and a spectrum of one number is
/// white.
void upgrade(Element& element);

}  // namespace fathom::mitsuba
