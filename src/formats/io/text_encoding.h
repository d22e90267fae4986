// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace fathom {

/// Whether a text is UTF-16 or UTF-32, by its byte order mark or a zero byte beside its first character.
bool is_wide_text(std::string_view text);

/// The text without a byte order mark of UTF-8, which some programs write. Throws Error for UTF-16 and UTF-32.
std::string_view utf8_text(const std::string& file, std::string_view text);

}  // namespace fathom
