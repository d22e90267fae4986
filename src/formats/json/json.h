#pragma once
#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

#include "formats/mesh/indexed_map.h"

namespace fathom {

/// Keeps the order of keys, which is the order of cameras and materials.
using Json = nlohmann::basic_json<IndexedMap>;

enum class DuplicateKeys { last_wins, error };

/// Parses UTF-8 JSON. Throws Error with line and column for what is not JSON, and if asked for, for a key that stands
/// twice in one object.
///
/// file  for messages
Json parse_json(const std::string& file, std::string_view text, DuplicateKeys duplicates);

/// "a string", "an object", "null": for messages.
const char* json_type(const Json& value);

}  // namespace fathom
