// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace fathom::cli {

/// An archive of arrays for numpy.load(): a ZIP file of .npy files, deflated. Functions throw Error naming the file.
class NpzFile {
public:
    explicit NpzFile(const std::filesystem::path& file);

    /// Adds an array whose element type is `description`, such as "<f4".
    ///
    /// bytes  the elements, the last index fastest
    void add(const std::string& name, const std::string& description, const std::vector<std::size_t>& shape,
             const void* bytes, std::size_t size);
    template <class T>
    void add(const std::string& name, const std::string& description, const std::vector<std::size_t>& shape,
             const std::vector<T>& values)
    {
        add(name, description, shape, values.data(), values.size() * sizeof(T));
    }
    /// Writes the directory of the archive.
    void finish();

private:
    struct Entry {
        std::string name;
        std::uint32_t checksum, stored, size, offset;
    };

    void write(const std::string& bytes);

    std::string name_;
    std::ofstream stream_;
    std::uint64_t position_ = 0;
    std::vector<Entry> entries_;
};

}  // namespace fathom::cli
