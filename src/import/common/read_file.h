#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace fathom {

/// The bytes of a file. Throws Error that says why they can't be had: missing, a directory, no permission, no memory.
std::string read_file(const std::filesystem::path& file);

/// As read_file, and throws Error if the file is empty.
std::string read_nonempty_file(const std::filesystem::path& file);

/// Text from a file made fit for a message: one line, at most 80 characters, control characters as `?`.
std::string printable(std::string_view text);

}  // namespace fathom
