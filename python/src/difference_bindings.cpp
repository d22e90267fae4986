// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <nlohmann/json.hpp>

#include "arrays.h"
#include "bindings.h"
#include "film.h"
#include "layers.h"
#include "render/comparison.h"
#include "report/difference_image.h"
#include "report/difference_report.h"

namespace fathom::python {

namespace nb = nanobind;

namespace {

using Pixels = nb::ndarray<const float, nb::ndim<3>, nb::c_contig, nb::device::cpu>;

cli::NamedImage read(const std::filesystem::path& file)
{
    const nb::gil_scoped_release release;
    return cli::read_comparable(file);
}

cli::NamedImage from_array(const Pixels& pixels, const std::vector<std::string>& channels, bool is_linear,
                           const std::string& name)
{
    cli::NamedImage result{{}, name};
    result.image.height = int(pixels.shape(0)), result.image.width = int(pixels.shape(1));
    result.image.is_linear = is_linear;
    result.image.layers.push_back({"", channels, std::vector<float>(pixels.data(), pixels.data() + pixels.size())});
    return result;
}

cli::NamedImage from_layers(const Layers& layers, const std::string& name)
{
    cli::NamedImage result{*layers.image, name};
    result.image.is_linear = true;
    return result;
}

/// Adds the variance of a film of the same image.
void add_film(cli::NamedImage& image, const FilmBox& box)
{
    box.check_idle();
    cli::add_variance(image.image, box.film);
}

std::shared_ptr<cli::Comparison> compare(const cli::NamedImage& a, const cli::NamedImage& b, double tolerance,
                                         const std::string& layer)
{
    const nb::gil_scoped_release release;
    return std::make_shared<cli::Comparison>(cli::compare(a, b, {layer, tolerance}));
}

std::string json(const cli::Comparison& comparison)
{
    return cli::difference_json(comparison).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// The FLIP map, or the largest differences of pixels where there is none.
nb::object map(const std::shared_ptr<cli::Comparison>& comparison, bool is_flip)
{
    const ImageDifference& d = comparison->difference;
    if (is_flip && !d.color) return nb::none();
    const std::vector<float>& values = is_flip ? d.color->flip.map : d.differences;
    return to_view(values.data(), {std::size_t(d.height), std::size_t(d.width)}, comparison);
}

}  // namespace

void bind_difference(nb::module_& module)
{
    nb::class_<cli::NamedImage>(module, "Comparable", "An image to be compared.").def("add_film", &add_film);
    nb::class_<cli::Comparison>(module, "Comparison", "A comparison; fathom.Difference wraps it.")
        .def("json", &json)
        .def("text", &cli::difference_text)
        .def("save", [](const cli::Comparison& c, const std::filesystem::path& file) { write_difference(file, c); });
    module.def("comparable_file", &read);
    module.def("comparable_array", &from_array);
    module.def("comparable_layers", &from_layers);
    module.def("compare", &compare);
    module.def("difference_map", &map);
}

}  // namespace fathom::python
