// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

#include "formats/mesh/indexed_map.h"

namespace fathom {

/// JSON values whose objects keep the order of their keys, which is the order of cameras and materials.
using Json = nlohmann::basic_json<IndexedMap>;

enum class DuplicateKeys { last_wins, error };

/// Parses UTF-8 JSON. Throws Error with line and column for invalid JSON and, if requested, for duplicate keys in an
/// object.
///
/// file  name of the file, for messages
Json parse_json(const std::string& file, std::string_view text, DuplicateKeys duplicates);

/// Name of the value's type for messages: "a string", "an object", "null".
const char* json_type(const Json& value);

}  // namespace fathom
