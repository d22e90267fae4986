#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace fathom {

bool is_data_uri(std::string_view uri);

/// The bytes of `data:[type][;base64],...`; nothing if it is damaged.
std::optional<std::string> decode_data_uri(std::string_view uri);

/// "a%20b" to "a b"; what is no valid escape stays as it is.
std::string decode_percent(std::string_view text);

}  // namespace fathom
