// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace fathom {

/// A file read sequentially, in pieces or as a whole. It is not memory-mapped: the program would crash if another
/// program truncated the file.
class InputFile {
public:
    /// Opens the file; contents without a known size, such as a pipe's, are read at once. Throws Error with the reason
    /// if it can't be read: missing, a directory, a device, no permission.
    explicit InputFile(const std::filesystem::path& file);
    /// Wraps contents that are in memory already.
    ///
    /// name  name of the file, for messages
    InputFile(std::string name, std::string bytes);
    InputFile(InputFile&& other) noexcept;
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;
    ~InputFile();

    const std::string& name() const { return name_; }
    /// Size in bytes when the file was opened, without a skipped byte order mark.
    std::uint64_t size() const { return size_; }

    /// The first 4 KB, or all of a shorter file, independent of the read position.
    std::string_view head() const { return std::string_view(start_).substr(0, 4096); }
    /// Skips the byte order mark of UTF-8; must be called before reading. Throws Error if the text is UTF-16 or UTF-32.
    void skip_byte_order_mark();
    /// Reads the whole file; later reads come from memory. Throws Error if it doesn't fit into memory.
    const std::string& bytes();
    /// Moves the whole contents out of this object.
    std::string take() &&;
    /// Reads the next `size` bytes, fewer only at the end of the file. Throws Error if reading fails.
    std::size_t read(char* to, std::size_t size);

private:
    void read_to_the_end(bool has_size);
    std::size_t read_some(char* to, std::size_t size);

    std::string name_;
    int descriptor_ = -1;     ///< -1 if start_ holds the whole file
    std::uint64_t size_ = 0;  ///< in bytes
    std::string start_;       ///< the beginning, read to recognize the format, or the whole file
    std::uint64_t at_ = 0;    ///< position of the next read
    std::size_t mark_ = 0;    ///< size of the skipped byte order mark, which start_ lacks
};

}  // namespace fathom
