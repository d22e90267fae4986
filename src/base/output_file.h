// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace fathom {

/// A file that appears under its name only when it is complete: commit() renames a temporary file to `target`.
///
/// The target /dev/stdout is the standard output, to which commit() copies a nameless temporary file.
///
/// Without commit() nothing remains and an existing file stays as it was. Symbolic links in the path are followed,
/// except links that another user put into a folder that others can write to: these are refused. The temporary name and
/// the name of the previous file are never written through a link. Every function throws Error naming `target`.
class OutputFile {
public:
    explicit OutputFile(const std::filesystem::path& target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// Appends bytes at the current position.
    void write(const void* bytes, std::size_t size);
    void write(const std::vector<unsigned char>& bytes) { write(bytes.data(), bytes.size()); }
    /// Writes the whole content at once, in place of write(). The page cache is bypassed (O_DIRECT) where the system
    /// allows it.
    ///
    /// bytes  aligned to 4096 bytes
    void write_whole(const void* bytes, std::size_t size);
    /// Current position in the file, in bytes from its start.
    std::uint64_t report();
    /// Moves the position of the next write, in bytes from the file's start.
    void seek(std::uint64_t position);
    /// Flushes the file to the disk and renames it to the target.
    ///
    /// previous  name that an existing file is kept under, beside the target. A complete file exists at every moment;
    ///           for a moment `previous` may be the newer of both
    void commit(const std::filesystem::path& previous = {});

private:
    void open_temporary();
    void copy_to_stdout();
    void rename_keeping_earlier(const std::filesystem::path& previous) const;
    void sync_folder() const;
    void copy_permissions() const;
    [[noreturn]] void fail(const std::string& what, int error) const;

    std::string name_;              ///< path as the user gave it, for messages
    std::filesystem::path target_;  ///< the path with symbolic links resolved
    std::filesystem::path folder_;
    std::filesystem::path temporary_;
    bool nameless_ = false;  ///< opened with O_TMPFILE: has no name yet and vanishes if the program is killed
    bool is_stdout_ = false;
    std::FILE* file_ = nullptr;
};

}  // namespace fathom
