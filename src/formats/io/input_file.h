#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace fathom {

/// A file that is read from its beginning to its end, by pieces or whole. Not mapped into memory: a map of a file that
/// another program cuts short ends this one.
class InputFile {
public:
    /// Opens it; what has no size, as a pipe without a name may be, is read at once. Throws Error that says why it
    /// can't be read: missing, a directory, a device, no permission.
    explicit InputFile(const std::filesystem::path& file);
    /// What is in memory already. name: for messages
    InputFile(std::string name, std::string bytes);
    InputFile(InputFile&& other) noexcept;
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;
    ~InputFile();

    const std::string& name() const { return name_; }
    /// How long it was when it was opened, without a byte order mark that was skipped.
    std::uint64_t size() const { return size_; }

    /// What it begins with: 4 KB, or all there is. Wherever it has been read to.
    std::string_view head() const { return std::string_view(start_).substr(0, 4096); }
    /// Skips the byte order mark of UTF-8; call it before reading. Throws Error if the text is in UTF-16 or UTF-32.
    void skip_byte_order_mark();
    /// All of it. Afterwards pieces come from there. Throws Error if it does not fit into memory.
    const std::string& bytes();
    /// All of it, to be kept: nothing is left here.
    std::string take() &&;
    /// The next bytes, fewer than asked for only at the end. Throws Error if the system can't read them.
    std::size_t read(char* to, std::size_t size);

private:
    void read_to_the_end(bool has_size);
    std::size_t read_some(char* to, std::size_t size);

    std::string name_;
    int descriptor_ = -1;     ///< -1: start_ is all there is
    std::uint64_t size_ = 0;  ///< in bytes
    std::string start_;       ///< what was read to know what it is, or everything
    std::uint64_t at_ = 0;    ///< where the next piece begins
    std::size_t mark_ = 0;    ///< bytes of the byte order mark, which start_ lacks
};

}  // namespace fathom
