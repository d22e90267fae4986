// SPDX-License-Identifier: Apache-2.0
#include "film.h"

#include <stdexcept>

namespace fathom::python {

FilmBox FilmBox::load(const std::filesystem::path& file)
{
    const FilmFile opened(file);
    return {opened.read(), opened.attributes(), {}};
}

Image FilmBox::image() const
{
    Image image = film.image(film.key().settings.alpha, false);
    image.attributes = attributes;
    return image;
}

void FilmBox::save(const std::filesystem::path& file) const
{
    write_film(file, film, image(), write);
}

void FilmBox::check_idle() const
{
    if (is_busy) throw std::runtime_error("the film is being rendered; wait until that is done");
}

}  // namespace fathom::python
