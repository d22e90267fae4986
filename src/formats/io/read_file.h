#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace fathom {

/// The bytes of a file, or of a pipe without a name, as standard input may be. Throws Error that says why they can't be
/// had: missing, a directory, a device, no permission, no memory.
std::string read_file(const std::filesystem::path& file);

/// Text from a file made fit for a message: one line, at most 80 characters, control characters as `?`.
std::string printable(std::string_view text);

}  // namespace fathom
