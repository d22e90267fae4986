// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace fathom {

/// The contents of a file or pipe, such as standard input. Throws Error with the reason if it can't be read: missing, a
/// directory, a device, no permission, no memory.
std::string read_file(const std::filesystem::path& file);

/// Prepares text from a file for a message: one line of at most 80 characters, with control characters as `?`.
std::string printable(std::string_view text);

}  // namespace fathom
