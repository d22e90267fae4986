#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "fathom/render.h"

namespace fathom::cli {

/// Whether the file begins as EXR, which scenes never do.
bool is_film_file(const std::filesystem::path& file);

/// Of a film's picture: its standard error, as the root of the mean square over pixels and channels, and its mean.
struct FilmNoise {
    double standard_error = 0, mean = 0;
};
FilmNoise noise_of(const Film& film);

/// What a film file holds and what it was made of; all of it is read, so that damage shows. Throws Error.
nlohmann::ordered_json describe_film(const std::filesystem::path& file);
void print_film_text(const nlohmann::ordered_json& info);

}  // namespace fathom::cli
