#pragma once
#include <string>

#include "formats/json/json.h"

namespace fathom {

/// A number by the fewest digits that give the same bits again, 0.8 and not 0.800000011920929; 1 and not 1.0.
Json number_json(float value);
Json number_json(double value);
/// In a unit in which reading multiplies by `unit`: such digits that the product has the same bits, if there are some.
template <class T>
Json number_json(T value, double unit);

/// Laid out for people: on one line what fits there. Text that is no UTF-8 has U+FFFD in its place.
std::string json_text(const Json& json);

}  // namespace fathom
