#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "fathom/api.h"
#include "fathom/image.h"
#include "fathom/render.h"

namespace fathom {

/// A file of a film's exact sums, from which a render goes on and parts are merged: an EXR that shows the picture too.
/// docs/film-files.md says what stands where.
class FATHOM_API FilmFile {
public:
    /// Reads what stands before pictures and sums. Throws Error naming the file if that is no film's, or the file is
    /// cut short.
    explicit FilmFile(const std::filesystem::path& file);
    FilmFile(FilmFile&&) noexcept;
    FilmFile& operator=(FilmFile&&) noexcept;
    ~FilmFile();

    const FilmKey& key() const;
    /// Sorted, disjoint, merged where they touch.
    const std::vector<SampleRange>& samples() const;
    std::uint64_t dropped_samples() const;
    /// Of the file's pictures, as EXR has them: "R", "albedo.G".
    const std::vector<std::string>& channels() const;
    /// What else it says, but for what only reading its sums needs.
    const std::map<std::string, std::string>& attributes() const;
    std::uint64_t size_bytes() const;

    /// Adds its samples to those of a film, line by line. Throws Error if some of them are there already, or what the
    /// two are of differs: the film is as it was. Throws Error too if the file is damaged, which shows at its end: then
    /// the film is to be thrown away.
    void add_to(Film& film) const;
    /// Throws Error if the file is damaged, or there is not the memory for its film.
    Film read() const;

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

/// A film file in memory, to be written by and by: the film may go on meanwhile. Keeps its memory.
class FATHOM_API FilmSnapshot {
public:
    FilmSnapshot();
    FilmSnapshot(FilmSnapshot&&) noexcept;
    FilmSnapshot& operator=(FilmSnapshot&&) noexcept;
    ~FilmSnapshot();

    /// picture  any of the film's size; its attributes become the file's. Throws Error if it is of another size
    void take(const Film& film, const Image& picture, const WriteOptions& options);
    std::size_t size_bytes() const;
    /// Writes beside the place, syncs, and renames into it. Throws Error; an earlier file then still stands.
    ///
    /// previous  a name beside `file` under which the earlier file is kept; empty: it goes
    void write(const std::filesystem::path& file, const std::filesystem::path& previous = {}) const;

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

/// Both at once.
FATHOM_API void write_film(const std::filesystem::path& file, const Film& film, const Image& picture,
                           const WriteOptions& options);

}  // namespace fathom
