// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "formats/json/json.h"

namespace fathom {

/// A number with the fewest digits that round-trip: 0.8 instead of 0.800000011920929, and 1 instead of 1.0.
Json number_json(float value);
Json number_json(double value);
/// A number in a unit that the reader multiplies by `unit`, with digits whose product round-trips, if there are any.
template <class T>
Json number_json(T value, double unit);

/// Formats JSON for readability: whatever fits into one line is written in one line. Invalid UTF-8 becomes U+FFFD.
std::string json_text(const Json& json);

}  // namespace fathom
