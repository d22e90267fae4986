// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace fathom {

/// Whether the bytes begin with gzip's signature.
inline bool is_gzip(std::string_view bytes)
{
    return bytes.starts_with("\x1f\x8b");
}

/// Decompresses a gzip file. Throws Error, naming `file`, if it is damaged or truncated.
std::string gunzip(const std::string& file, std::string_view bytes);

}  // namespace fathom
