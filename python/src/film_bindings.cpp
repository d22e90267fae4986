// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <fmt/format.h>

#include "bindings.h"
#include "fathom/image_error.h"
#include "film.h"
#include "layers.h"

namespace fathom::python {

namespace nb = nanobind;

namespace {

std::shared_ptr<FilmBox> load(const std::filesystem::path& file)
{
    const nb::gil_scoped_release release;
    return std::make_shared<FilmBox>(FilmBox::load(file));
}

void save(const FilmBox& box, const std::filesystem::path& file)
{
    box.check_idle();
    const nb::gil_scoped_release release;
    box.save(file);
}

void merge(FilmBox& box, const FilmBox& other)
{
    box.check_idle(), other.check_idle();
    box.film.merge(other.film);
}

Layers image(const FilmBox& box)
{
    box.check_idle();
    return {std::make_shared<const Image>(box.image()), {}};
}

std::optional<ImageError> error(const FilmBox& box, const std::string& metric)
{
    box.check_idle();
    const nb::gil_scoped_release release;
    if (metric == "absolute") return estimate_error(box.film, ErrorMetric::absolute);
    if (metric == "worst-block") return estimate_error(box.film, ErrorMetric::worst_block);
    return estimate_error(box.film);
}

}  // namespace

void bind_film(nb::module_& module)
{
    nb::class_<ImageError>(module, "ImageError", "Estimated error of an image: what remains of the noise.")
        .def_ro("error", &ImageError::error, "The estimate.")
        .def_ro("low", &ImageError::low, "Lower end of the interval that contains the error with 95 % confidence.")
        .def_ro("high", &ImageError::high, "Upper end of that interval.")
        .def_ro("rest", &ImageError::rest, "Error without the noisiest 0.1 % of the pixels.")
        .def_prop_ro("is_reliable", &ImageError::is_reliable, "Whether the error and its interval can be trusted.")
        .def("__repr__", [](const ImageError& e) {
            return fmt::format("ImageError({:.4g}, low={:.4g}, high={:.4g}{})", e.error, e.low, e.high,
                               e.is_reliable() ? "" : ", unreliable");
        });
    nb::class_<FilmBox>(module, "Film", "Film of the C++ library; fathom.Film wraps it.")
        .def_prop_ro("width", [](const FilmBox& f) { return f.film.width(); })
        .def_prop_ro("height", [](const FilmBox& f) { return f.film.height(); })
        .def_prop_ro("attributes", [](const FilmBox& f) { return f.attributes; })
        .def_prop_ro("key", [](const FilmBox& f) { return f.film.key().text(); })
        .def_prop_ro("samples",
                     [](const FilmBox& f) {
                         f.check_idle();
                         return f.film.samples();
                     })
        .def_prop_ro("samples_per_pixel",
                     [](const FilmBox& f) {
                         f.check_idle();
                         return f.film.samples_per_pixel();
                     })
        .def("image", &image)
        .def("error", &error)
        .def("merge", &merge)
        .def("save", &save);
    module.def("load_film", &load);
}

}  // namespace fathom::python
