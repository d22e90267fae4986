// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "fathom/film_file.h"

namespace fathom::python {

/// A film with what its file contains beside the sums.
struct FilmBox {
    Film film;
    std::map<std::string, std::string> attributes;
    WriteOptions write;
    bool is_busy = false;  ///< a thread adds samples; read and written with the interpreter lock

    static FilmBox load(const std::filesystem::path& file);
    /// The layers of the film.
    Image image() const;
    void save(const std::filesystem::path& file) const;
    /// Throws std::runtime_error while a thread adds samples.
    void check_idle() const;
};

}  // namespace fathom::python
