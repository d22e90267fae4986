#pragma once
#include "formats/mitsuba/elements.h"

namespace fathom::mitsuba {

/// Makes an element of a file of Mitsuba 0.x, its children upgraded already, one that says the same today: tags, names,
/// and parameters that are told otherwise now. `default` elements keep their names, since `$name` means those: they are
/// no matter of this. Source: the manual of Mitsuba 0.6, and what Mitsuba 3.9.1 makes of the names. Where the two
/// differ it is the former's picture: skies have +y up, a texture's offset is added after its scale, a spectrum of one
/// number is white.
void upgrade(Element& element);

}  // namespace fathom::mitsuba
