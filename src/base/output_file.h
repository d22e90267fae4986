#pragma once
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace fathom {

/// A file in the making: nobody sees it until commit() puts it, whole and on the disk, in the place of `target`.
///
/// Without commit() nothing remains and an earlier file stands. Links on the way to it are followed, but for those that
/// another user put into a folder that others may write to, which are refused; what lies at the name of a temporary
/// file or of the earlier one is never written through. Every function throws Error naming `target`.
class OutputFile {
public:
    explicit OutputFile(const std::filesystem::path& target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(const void* bytes, std::size_t size);
    void write(const std::vector<unsigned char>& bytes) { write(bytes.data(), bytes.size()); }
    /// Instead of write(): all that the file is to hold. Where the system lets it, the bytes go past its cache, which
    /// has better uses and costs time. bytes  begin at a multiple of 4096
    void write_whole(const void* bytes, std::size_t size);
    std::uint64_t report();
    void seek(std::uint64_t position);
    /// previous  where an earlier file is kept, if there is one, beside the target. At every moment there is a whole
    ///           one; for a moment `previous` may be the newer of both
    void commit(const std::filesystem::path& previous = {});

private:
    void rename_keeping_earlier(const std::filesystem::path& previous) const;
    void sync_folder() const;
    void keep_rights() const;
    [[noreturn]] void fail(const std::string& what, int error) const;

    std::string name_;              ///< as the user gave it
    std::filesystem::path target_;  ///< symbolic links followed
    std::filesystem::path folder_;
    std::filesystem::path temporary_;
    bool nameless_ = false;  ///< has no name yet: vanishes by itself if the program is killed
    std::FILE* file_ = nullptr;
};

}  // namespace fathom
