// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "fathom/render.h"

namespace fathom::cli {

/// Whether the file is an EXR, by its first bytes.
bool is_film_file(const std::filesystem::path& file);

/// Standard error of a film's image, root mean square over pixels and channels, and the image's mean.
struct FilmNoise {
    double standard_error = 0, mean = 0;
};
FilmNoise film_noise(const Film& film);

/// Contents and settings of a film file. The whole file is read, so that damage is detected. Throws Error.
nlohmann::ordered_json describe_film(const std::filesystem::path& file);
void print_film_text(const nlohmann::ordered_json& info);

}  // namespace fathom::cli
