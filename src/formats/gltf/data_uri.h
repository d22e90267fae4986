// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace fathom {

bool is_data_uri(std::string_view uri);

/// Decodes `data:[type][;base64],...`; nothing if it is malformed.
std::optional<std::string> decode_data_uri(std::string_view uri);

/// Decodes percent escapes ("a%20b" to "a b"); invalid escapes are kept.
std::string decode_percent(std::string_view text);

}  // namespace fathom
