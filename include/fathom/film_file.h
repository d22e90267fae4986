// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "fathom/api.h"
#include "fathom/film.h"
#include "fathom/image.h"

namespace fathom {

/// An open film file: an EXR image that also contains the exact sums of a film, so that rendering can be continued and
/// films can be merged. docs/film-files.md describes the format.
class FATHOM_API FilmFile {
public:
    /// Opens a file and reads its headers. Throws Error naming the file if it is not a film file, was written by an
    /// incompatible version, or is truncated.
    explicit FilmFile(const std::filesystem::path& file);
    /// Moves the open file; the source may only be assigned to or destroyed afterwards.
    FilmFile(FilmFile&&) noexcept;
    /// Moves the open file; the source may only be assigned to or destroyed afterwards.
    FilmFile& operator=(FilmFile&&) noexcept;
    ~FilmFile();

    /// Returns what the film contains samples of.
    const FilmKey& key() const;
    /// Returns the ranges of sample indices in the film: sorted, disjoint, and joined where they touch.
    const std::vector<SampleRange>& samples() const;
    /// Returns the number of samples whose value was NaN or infinite.
    std::uint64_t invalid_samples() const;
    /// Returns the names of the image's channels, as in EXR: "R", "albedo.G". The channels of the sums are not
    /// included.
    const std::vector<std::string>& channels() const;
    /// Returns the text attributes of the file by name, except those that describe the sums.
    const std::map<std::string, std::string>& attributes() const;
    /// Returns the size of the file in bytes.
    std::uint64_t size_bytes() const;

    /// Adds the samples of the file to a film. It reads the file by scan lines and needs little memory of its own.
    ///
    /// Throws Error, without changing the film, if the keys differ or a sample is in both. Throws Error too if the file
    /// is damaged, which its checksum reveals only at the end; the film must then be discarded.
    void add_to(Film& film) const;
    /// Returns the film. Throws Error if the file is damaged or the film doesn't fit into memory.
    Film read() const;

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

/// A film file in memory, for checkpoints: take() copies the film quickly, and write() can run on another thread while
/// rendering goes on. Its memory is reused by the next take().
class FATHOM_API FilmSnapshot {
public:
    /// Creates an empty snapshot.
    FilmSnapshot();
    /// Moves the snapshot; the source may only be assigned to or destroyed afterwards.
    FilmSnapshot(FilmSnapshot&&) noexcept;
    /// Moves the snapshot; the source may only be assigned to or destroyed afterwards.
    FilmSnapshot& operator=(FilmSnapshot&&) noexcept;
    ~FilmSnapshot();

    /// Encodes a film file in memory.
    ///
    /// film     Its sums are stored.
    /// image    Image of the same size that viewers of the file show. Its attributes are stored too.
    /// options  Only the settings for EXR are used.
    ///
    /// Throws Error if the image has another size than the film.
    void take(const Film& film, const Image& image, const WriteOptions& options);
    /// Returns the size of the encoded file in bytes.
    std::size_t size_bytes() const;
    /// Writes the file atomically: to a temporary file, which is synced and then renamed.
    ///
    /// file      Name of the file.
    /// previous  Name in the same folder to which an earlier file is renamed; empty: the earlier file is replaced.
    ///
    /// Throws Error if that fails; an earlier file then remains.
    void write(const std::filesystem::path& file, const std::filesystem::path& previous = {}) const;

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

/// Writes a film file at once: FilmSnapshot::take() and FilmSnapshot::write(). Throws Error naming the file if that
/// fails, also for lack of memory.
FATHOM_API void write_film(const std::filesystem::path& file, const Film& film, const Image& image,
                           const WriteOptions& options);

}  // namespace fathom
